"""Pictures as a person sees them: upright, and with eight bits a channel."""

import numpy as np
import PIL.ExifTags
import PIL.Image

# How the stored picture is to be changed for EXIF's orientations (tag 0x112); 1 is upright.
UPRIGHT = {
    2: PIL.Image.Transpose.FLIP_LEFT_RIGHT,
    3: PIL.Image.Transpose.ROTATE_180,
    4: PIL.Image.Transpose.FLIP_TOP_BOTTOM,
    5: PIL.Image.Transpose.TRANSPOSE,
    6: PIL.Image.Transpose.ROTATE_270,
    7: PIL.Image.Transpose.TRANSVERSE,
    8: PIL.Image.Transpose.ROTATE_90,
}
# Quarter turns of a sensor's picture until it is upright, anticlockwise as rot90 counts them; those of cameras.
QUARTER_TURNS = {3: 2, 6: 3, 8: 1}


def upright(picture: PIL.Image.Image) -> PIL.Image.Image:
    """As its EXIF data say. Pillow's own function also writes these anew, which fails where any of them is damaged."""
    picture.load()  # where a TIFF is turned already, and no longer says how
    turn = UPRIGHT.get(_orientation(picture))
    return picture if turn is None else picture.transpose(turn)


def quarter_turns(picture: PIL.Image.Image) -> int:
    """By how many the camera turned what its sensor saw, as QUARTER_TURNS; 0 where it does not say so."""
    # HEIC is turned as it is read, and the tag is kept under this name.
    return QUARTER_TURNS.get(picture.info.get("original_orientation") or _orientation(picture), 0)


def _orientation(picture: PIL.Image.Image) -> int:
    try:
        return int(picture.getexif().get(PIL.ExifTags.Base.Orientation, 1))
    except Exception:  # Damaged EXIF data can fail anywhere in Pillow, and say nothing against the picture.
        return 1


def with_8_bits(picture: PIL.Image.Image) -> PIL.Image.Image:
    """Grey of 16 bits reduced to 8, which Pillow clips at 255; any other picture as it is."""
    if not picture.mode.startswith("I"):
        return picture
    grey = np.asarray(picture.convert("I")).clip(0, 65535) >> 8
    return PIL.Image.fromarray(grey.astype(np.uint8))
