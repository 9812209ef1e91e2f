"""Photos that are decoded in a process of their own: in HEIF (ISO/IEC 23008-12), as iPhones take them, and large files.

Whatever a damaged one does to its decoder, the viewer goes on: that of HEIF has crashed on such files, and the others
believe what a header says as far as the file reaches.
"""

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, TypeVar

import PIL.Image

from ashe_live.capture.sources import too_many_pixels
from ashe_live.errors import UserError
from ashe_live.files.reading import opened
from ashe_live.files.slow_pictures import opened_picture, refuse_slow_decoder
from ashe_live.process.children import Limits
from ashe_live.process.isolated import NoAnswerError, isolated_call

Result = TypeVar("Result")

HEIF = ("HEIF",)
BRANDS = {b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"}
# A photo of 109 million pixels, nearly the most that sources.py lets pass, takes 1.7 GB and 6 s.
LIMITS = Limits(niceness=0, memory_bytes=4_000_000_000, processor_s=60, silent=True)
LONGEST_S = 120.0  # by the clock, where others use the processor
ADVICE = "copy it again, or save it as JPEG"


def is_heif(file: BinaryIO) -> bool:
    """Whether a file begins as such a photo does; it is at its start afterwards."""
    file.seek(0)
    begin = file.read(12)
    file.seek(0)
    return begin[4:8] == b"ftyp" and begin[8:] in BRANDS


def read_isolated(path: Path, formats: tuple[str, ...], read: Callable[[Path, PIL.Image.Image], Result]) -> Result:
    """The result of `read(path, picture)` for the photo, `read` as for `isolated_call`; arrays in it are read-only.

    `formats` are Pillow's names of those that it may have. Raises the UserError that `read` raises, and one for a
    damaged file.
    """
    try:
        result: Result = isolated_call(_read, (path, formats, read), "ashe-live photo", LIMITS, LONGEST_S)
    except NoAnswerError as failure:
        raise UserError(f"{path} is damaged ({failure})", ADVICE) from None
    return result


def _read(path: Path, formats: tuple[str, ...], read: Callable[[Path, PIL.Image.Image], Result]) -> Result:
    if formats == HEIF:
        from pi_heif import register_heif_opener  # not in the parent, which needs no decoder

        register_heif_opener()
    try:
        with opened(path) as file, opened_picture(path, file, formats) as picture:
            refuse_slow_decoder(path, picture, file)
            return read(path, picture)
    except PIL.Image.DecompressionBombError:
        raise too_many_pixels(path) from None
    except PIL.UnidentifiedImageError:
        raise UserError(f"{path} is damaged (no picture is found in it)", ADVICE) from None
