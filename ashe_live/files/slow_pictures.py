"""Pictures of old formats that Pillow decodes number by number in Python: seconds for ten million, minutes for some.

These are PPM, PGM and PBM as text, or with another greatest value than their bytes can have, and BMP in run lengths.
"""

import os
import re
from pathlib import Path
from typing import BinaryIO

import PIL.Image

from ashe_live.errors import UserError
from ashe_live.files.jpeg import refuse_endless

# Pillow's names of these decoders.
IN_PYTHON = ("ppm_plain", "ppm", "bmp_rle")
# Numbers that one of them gets, and bytes that it reads: as many as ten million have as text. They take up to 7 s.
MOST_NUMBERS, MOST_BYTES = 10_000_000, 40_000_000
REMEDY = "save it as PNG or JPEG"
NETPBM = re.compile(rb"P[1-6]\s")
AS_TEXT, WITHOUT_GREATEST = (b"P1", b"P2", b"P3"), (b"P1", b"P4")
COMMENT = re.compile(rb"#[^\r\n]*")
# Pillow reads a header byte by byte, and takes out each comment of a text by copying what is left of it.
LONGEST_HEADER, MOST_COMMENTS = 65_536, 1000


def refuse_slow(path: Path, file: BinaryIO) -> None:
    """Raises UserError for a picture that would take very long, before it is opened; `file` is at its start afterwards.

    As `refuse_endless`, and for the comments of PPM, PGM and PBM.
    """
    refuse_endless(path, file)
    begin = file.read(LONGEST_HEADER)
    if NETPBM.match(begin):
        words = COMMENT.sub(b" ", begin).split(maxsplit=4)
        is_long = len(begin) == LONGEST_HEADER and len(words) < (3 if begin[:2] in WITHOUT_GREATEST else 4)
        if not is_long and begin[:2] in AS_TEXT:
            is_long = (begin + file.read(MOST_BYTES)).count(b"#") > MOST_COMMENTS
        if is_long:
            raise UserError(f"{path} has comments without end", REMEDY)
    file.seek(0)


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
