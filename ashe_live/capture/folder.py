"""The pictures that are directly in a folder, and a word on what else is."""

import errno
import os
from collections.abc import Iterator
from pathlib import Path

from ashe_live.capture.photo import SUFFIXES, looks_like_photo
from ashe_live.errors import UserError
from ashe_live.process.messages import listed

NAMED = 3  # of the files that are passed over
# What container.py reads. Not by the system's list of types, which may be missing, and has 3GP as sound.
VIDEO_SUFFIXES = frozenset(
    f".{suffix}"
    for suffix in (
        *("mp4", "m4v", "mov", "qt", "3gp", "3g2", "mj2", "mkv", "webm", "avi", "wmv", "asf", "flv", "ogv", "mxf"),
        *("mts", "m2ts", "m2t", "ts", "mpg", "mpeg", "mpe", "m1v", "m2v", "vob", "dv", "wtv", "rm", "swf"),
        *("mjpeg", "mjpg", "h264", "264", "hevc", "h265", "265", "obu", "ivf", "y4m"),
    )
)


def pictures_in(folder: Path, with_clips: bool) -> tuple[list[Path], str | None]:
    """The photos, and clips if they are wanted, by their names in order, and which other files are passed over.

    A file without a suffix is a photo if it begins as one. What is hidden is neither. Raises UserError when the folder
    must not be read.
    """
    pictures: list[Path] = []
    others: list[Path] = []
    try:
        files = sorted(_files_in(folder))
    except OSError as error:
        remedy = "choose another one, or check its permissions"
        raise UserError(f"cannot read the folder {folder} ({error.strerror})", remedy) from None
    for path in files:
        (pictures if _is_photo(path) or (with_clips and _may_be_clip(path)) else others).append(path)
    wanted = "photos or clips" if with_clips else "photos"
    if not others:
        return pictures, None
    return pictures, f"{folder}: passed over, as not named as {wanted}: {listed((each.name for each in others), NAMED)}"


def refuse_folder(path: Path) -> None:
    """Raises UserError for a folder: that it must not be read, or else that there is nothing in it."""
    if os.path.isdir(path):  # noqa: PTH112 - Path.is_dir raises an error in a folder that must not be entered
        pictures_in(path, with_clips=True)
        raise UserError("there is no photo or clip in it", "name another folder, or files")


def _files_in(folder: Path) -> Iterator[Path]:
    entries = list(folder.iterdir())
    if entries and not os.access(folder, os.X_OK):  # the names of its files can be read, and nothing else
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    for path in entries:
        try:
            if path.is_file() and not path.name.startswith("."):
                yield path
        except OSError:  # a link into a folder that must not be entered
            continue


def _is_photo(path: Path) -> bool:
    if path.suffix:
        return path.suffix.lower() in SUFFIXES
    try:
        return looks_like_photo(path)
    except UserError:
        return False


def _may_be_clip(path: Path) -> bool:
    # A GIF is read as a clip, which it may be.
    return path.suffix.lower() == ".gif" or is_named_as_video(path)


def is_named_as_video(path: Path) -> bool:
    """Whether the suffix is one of videos."""
    return path.suffix.lower() in VIDEO_SUFFIXES


def is_named_as_picture(path: Path) -> bool:
    """Whether the suffix is one of photos or videos."""
    return path.suffix.lower() in SUFFIXES or _may_be_clip(path)
