"""Pictures that Pillow reads number by number, or part by part, in Python: seconds for ten million, minutes for some.

The former are of old formats: PPM, PGM and PBM as text, or with another greatest value than their bytes can have, and
BMP in run lengths. The latter are PNG in chunks and JPEG 2000 in boxes.
"""

import os
import re
from pathlib import Path
from typing import BinaryIO

import PIL.Image

from ashe_live.errors import UserError
from ashe_live.files.jpeg import refuse_endless
from ashe_live.files.png import readable

# Pillow's names of these decoders.
IN_PYTHON = ("ppm_plain", "ppm", "bmp_rle")
# Numbers that one of them gets, and bytes that it reads: as many as ten million have as text. They take up to 7 s.
MOST_NUMBERS, MOST_BYTES = 10_000_000, 40_000_000
REMEDY = "save it as PNG or JPEG"
NETPBM = re.compile(rb"P([1-6f]|0CMYK|yP|yRGBA|yCMYK)\s")  # also kinds that only Pillow knows
AS_TEXT, WITHOUT_GREATEST = (b"P1", b"P2", b"P3"), (b"P1", b"P4")
COMMENT = re.compile(rb"#[^\r\n]*[\r\n]?")  # a word goes on after it
# Pillow reads a header byte by byte, and takes out each comment of a text by copying what is left of it.
LONGEST_HEADER, MOST_COMMENTS = 65_536, 1000
# PNG specification, 5.2 and 5.3; ISO/IEC 15444-1, I.4 and I.5.1, and the boxes that consist of boxes.
PNG, JPEG_2000, OF_BOXES = b"\x89PNG\r\n\x1a\n", b"\x00\x00\x00\x0cjP  ", (b"jp2h", b"res ")
BEFORE_REST = (b"IEND", b"jp2c")  # the last that are read: an end, and what is decoded in C
MOST_PARTS = 200_000  # they take a second; the largest photos have fifty thousand, of 8 KB each


def opened_picture(path: Path, file: BinaryIO, formats: tuple[str, ...]) -> PIL.Image.Image:
    """Reads a picture's header only, as PIL.Image.open, which raises whatever it does for one that is damaged.

    Raises UserError as `refuse_slow`. The texts and profiles of a PNG are those of `readable`.
    """
    refuse_slow(path, file)
    content, profile = readable(file)
    picture = PIL.Image.open(content, formats=formats)
    if profile is not None:
        picture.info["icc_profile"] = profile
    return picture


def refuse_slow(path: Path, file: BinaryIO) -> None:
    """Raises UserError for a picture that would take very long, before it is opened; `file` is at its start afterwards.

    As `refuse_endless`, for the comments of PPM, PGM and PBM, and for the parts of PNG and JPEG 2000.
    """
    refuse_endless(path, file)
    if _is_in_parts_without_end(file):
        what = f"{path} is in more than {MOST_PARTS:,} parts, and photos have a few hundred"
        raise UserError(what, "save it as JPEG")
    file.seek(0)
    begin = file.read(LONGEST_HEADER)
    if NETPBM.match(begin):
        # With what follows the header, which tells that its last word has ended.
        words = (COMMENT.sub(b"", begin) + b"*").split(maxsplit=4)
        is_long = len(begin) == LONGEST_HEADER and len(words) < (4 if begin[:2] in WITHOUT_GREATEST else 5)
        if not is_long and begin[:2] in AS_TEXT:
            is_long = (begin + file.read(MOST_BYTES)).count(b"#") > MOST_COMMENTS
        if is_long:
            raise UserError(f"{path} has comments without end", REMEDY)
    file.seek(0)


def _is_in_parts_without_end(file: BinaryIO) -> bool:
    """Whether a PNG has too many chunks before its end, or a JPEG 2000 too many boxes."""
    file.seek(0)
    begin = file.read(len(PNG))
    if begin not in (PNG, JPEG_2000):
        return False
    at = len(PNG) if begin == PNG else 0
    for _ in range(MOST_PARTS):
        file.seek(at)
        head = file.read(8)
        size, kind = int.from_bytes(head[:4], "big"), head[4:]
        if begin == PNG:
            size += 12  # it is that of the data alone
        elif kind in OF_BOXES:
            size = 8
        elif size == 1:
            size = int.from_bytes(file.read(8), "big")
        if len(head) < 8 or kind in BEFORE_REST or not 8 <= size < 1 << 62:
            return False
        at += size
    return True


def refuse_slow_decoder(path: Path, picture: PIL.Image.Image, file: BinaryIO) -> None:
    """Raises UserError for the picture opened from `file` where decoding it would take long."""
    decoders = {tile.codec_name for tile in getattr(picture, "tile", ())}
    if decoders.isdisjoint(IN_PYTHON):
        return
    at = file.tell()
    file_bytes = file.seek(0, os.SEEK_END)
    file.seek(at)
    if picture.width * picture.height * len(picture.getbands()) > MOST_NUMBERS or file_bytes > MOST_BYTES:
        kind = "BMP in run lengths" if "bmp_rle" in decoders else "PPM as text, or of other than 8 or 16 bits"
        raise UserError(f"{path} is too large for its kind, a {kind}, which takes long to read", REMEDY)
