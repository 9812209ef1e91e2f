"""What a TIFF has that is not the picture: the preview of a raw photo, and bytes that are taken for others."""

from pathlib import Path

import PIL.Image
from PIL.TiffImagePlugin import TiffImageFile

from ashe_live.errors import UserError

NEW_SUBFILE_TYPE, BITS_PER_SAMPLE, PLANAR_CONFIGURATION = 254, 258, 284  # of TIFF 6.0


def refuse_misread(path: Path, picture: PIL.Image.Image) -> None:
    """Raises UserError for a TIFF, opened from `path`, of which another picture would be read."""
    if not isinstance(picture, TiffImageFile):
        return
    tags = picture.tag_v2
    if int(tags.get(NEW_SUBFILE_TYPE, 0)) & 1:  # a preview, as is what raw files (DNG, NEF, ARW) begin with
        raise UserError(
            f"{path} is a raw photo, of which only a small preview can be read",
            "develop it to JPEG, or let the camera save JPEG as well",
        )
    # One colour after the other, and not compressed: Pillow takes both bytes of 16 bits for a pixel each.
    is_planar = tags.get(PLANAR_CONFIGURATION) == 2 and len(picture.getbands()) > 1
    if is_planar and picture.info.get("compression") == "raw" and 16 in tags.get(BITS_PER_SAMPLE, ()):
        raise UserError(f"{path} has one colour of 16 bits after the other, which is not read", "save it as PNG")
