"""Reads the pictures of pattern markers: ARToolKit pattern files, and pictures of the print itself."""

import io
import warnings
from pathlib import Path

import cv2
import numpy as np
import PIL.Image

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.pixels import upright, with_8_bits
from ashe_live.files.reading import read_bytes
from ashe_live.files.slow_pictures import opened_picture, refuse_slow_decoder

# An ARToolKit pattern file: for each of 4 rotations the blue, green and red channel, as many rows as numbers in each.
# There are 16 as a rule; ARToolKit 5 has a choice up to 64 (AR_PATT_SIZE1_MAX).
ROTATIONS, CHANNELS, ROWS = 4, 3, (16, 24, 32, 48, 64)
MAX_PATTERN_BYTES = 512 * 1024
# The side of the whole print at which a pattern file's cells are drawn into its middle half.
PATTERN_PRINT_PX = 512

MAX_PICTURE_BYTES = 32 * 1024 * 1024
MAX_PICTURE_SIDE_PX = 4096
PICTURE_FORMATS = ("PNG", "JPEG", "BMP", "WEBP")
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".webp")


def read_pattern_file(path: Path) -> Image:
    """The whole print (n, n) grey of an ARToolKit pattern file, black border of a quarter on each side included.

    Raises UserError when it is not such a file.
    """
    return _with_border(read_pattern_content(path))


def read_pattern_content(path: Path) -> Image:
    """The (n, n) grey values of the upright rotation, n one of ROWS; raises UserError when it is not such a file."""
    if path.suffix.lower() in PICTURE_SUFFIXES and path.is_file():
        raise UserError(f"{path} is a picture, and no ARToolKit pattern file", f"name it by image:{path}")
    sides = {ROTATIONS * CHANNELS * side**2: side for side in ROWS}
    remedy = f"an ARToolKit pattern file holds {next(iter(sides))} numbers from 0 to 255"
    content = read_bytes(path, MAX_PATTERN_BYTES, may_be_empty=False)
    try:
        numbers = np.array([int(word) for word in content.decode("utf-8-sig").split()])
    except (ValueError, OverflowError) as error:
        raise UserError(f"the pattern file {path} holds something else than whole numbers", remedy) from error
    side = sides.get(len(numbers))
    if side is None:
        raise UserError(f"the pattern file {path} holds {len(numbers)} numbers", remedy)
    if numbers.min() < 0 or numbers.max() > 255:
        raise UserError(f"the pattern file {path} holds numbers beyond a byte", remedy)
    upright_bgr = numbers.reshape(ROTATIONS, CHANNELS, side, side)[0].astype(np.uint8)
    return np.asarray(cv2.cvtColor(np.moveaxis(upright_bgr, 0, 2), cv2.COLOR_BGR2GRAY), dtype=np.uint8)


def read_marker_picture(path: Path) -> Image:
    """The whole print (n, n) grey of a picture that ends where the black square ends.

    Raises UserError when it cannot be read or is not a square.
    """
    file = io.BytesIO(read_bytes(path, MAX_PICTURE_BYTES, may_be_empty=False))
    by_pattern = f", or one of ARToolKit's by pattern:{path}" if path.suffix.lower() == ".patt" else ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", PIL.Image.DecompressionBombWarning)
            # Opening reads the header only, so the size is known before memory is spent on it.
            with opened_picture(path, file, PICTURE_FORMATS) as picture:
                _check_picture_size(path, picture.size)
                refuse_slow_decoder(path, picture, file)
                rgba = with_8_bits(upright(picture)).convert("RGBA")
    except (PIL.Image.DecompressionBombError, PIL.Image.DecompressionBombWarning) as error:
        raise UserError(
            f"the picture {path} is too large", f"scale it to at most {MAX_PICTURE_SIDE_PX} pixels a side"
        ) from error
    except (OSError, ValueError, SyntaxError) as error:
        raise UserError(
            f"cannot read the picture {path}", f"it must be a {', '.join(PICTURE_FORMATS)} file{by_pattern}"
        ) from error
    paper = PIL.Image.new("RGBA", rgba.size, "white")
    grey = np.asarray(PIL.Image.alpha_composite(paper, rgba).convert("L"))
    side = min(grey.shape)
    return np.asarray(cv2.resize(grey, (side, side), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _with_border(content: Image) -> Image:
    """Draws `content` (n, n), stretched from black to white, into the middle half of a black square."""
    dark, light = int(content.min()), int(content.max())
    stretched = (content.astype(np.float64) - dark) * (255 / max(light - dark, 1))
    half = PATTERN_PRINT_PX // 2
    whole = np.zeros((PATTERN_PRINT_PX, PATTERN_PRINT_PX), dtype=np.uint8)
    middle = slice(half // 2, half // 2 + half)
    whole[middle, middle] = cv2.resize(np.round(stretched).astype(np.uint8), (half, half))
    return whole


def _check_picture_size(path: Path, size: tuple[int, int]) -> None:
    width, height = size
    if max(size) > MAX_PICTURE_SIDE_PX:
        raise UserError(f"the picture {path} is too large", f"scale it to at most {MAX_PICTURE_SIDE_PX} pixels a side")
    if abs(width - height) > 0.02 * max(size):
        raise UserError(f"the picture {path} is not square ({width}x{height})", "crop it to the black square")
    if min(size) < 32:
        raise UserError(f"the picture {path} is too small", "give it at least 32 pixels a side")
