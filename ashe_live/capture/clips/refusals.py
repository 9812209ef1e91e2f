"""What is said of a file that is no clip, or of one without a picture in it."""

from pathlib import Path
from typing import BinaryIO

from ashe_live.capture.sources import MAX_PIXELS
from ashe_live.errors import UserError


def no_clip(path: Path) -> UserError:
    if path.suffix.lower() == ".patt":
        return UserError(f"{path} is a marker, and no clip or photo", f"start with --marker pattern:{path}")
    return UserError(f"{path} is not a clip or photo that can be read", "convert it to MP4 (H.264), JPEG or PNG")


def without_picture(path: Path, has_stated_size: bool) -> UserError:
    limit = f"{MAX_PIXELS // 10**6} million pixels"
    if has_stated_size:
        return UserError(f"{path} has no readable picture in it", f"copy or record it again, or scale it to {limit}")
    what = f"{path} has no readable picture in it: each is damaged, or has more than {limit}"
    return UserError(what, "scale it down, or copy or record it again")


def begins_as_mp4(file: BinaryIO) -> bool:
    """Whether it is an MP4 or MOV by its first bytes: ISO/IEC 14496-12, 4.3."""
    file.seek(0)
    return file.read(8)[4:] in (b"ftyp", b"moov", b"mdat", b"wide")


def cut_short(path: Path) -> UserError:
    return UserError(
        f"{path} begins as a clip and has no list of its pictures: it is cut short, or still being recorded",
        "copy it again, whole, or record it again",
    )


def sound_alone(path: Path) -> UserError:
    return UserError(f"{path} has sound and no picture", "name the clip that the camera has recorded")


def unknown_colours(path: Path) -> UserError:
    return UserError(f"{path} stores its colours in a way that is not read (as ICtCp)", "convert it to MP4 (H.264)")
