"""Letters for text in pictures: Pillow's own font, and one of the system's for what that lacks, as in "Küche.mp4".

Pillow's font has the letters of ASCII and a few signs. Files and cameras have names in every script.
"""

import os
import sys
import unicodedata
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from PIL import ImageFont

from ashe_live.errors import UserError
from ashe_live.files.reading import opened

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont

# Plain fonts that systems come with, those of many scripts later: DejaVu, Liberation, Noto and Droid are Linux's, Segoe
# to Leelawadee Windows', the rest macOS's.
NAMES = (
    *("DejaVuSans.ttf", "NotoSans-Regular.ttf", "LiberationSans-Regular.ttf", "Ubuntu-R.ttf"),
    *("NotoSansCJK-Regular.ttc", "NotoSansCJKjp-Regular.otf", "DroidSansFallbackFull.ttf", "wqy-microhei.ttc"),
    *("segoeui.ttf", "arial.ttf", "YuGothM.ttc", "msyh.ttc", "malgun.ttf", "Nirmala.ttf", "LeelawUI.ttf"),
    *("Helvetica.ttc", "Arial Unicode.ttf", "Hiragino Sans GB.ttc", "AppleSDGothicNeo.ttc"),
)
# No character: what is drawn in its place is what a font draws for letters that it lacks.
NO_LETTER = "\uffff"
PROBED_PX = 16
UNKNOWN = "?"


class Lettering(NamedTuple):
    """Text, and a font that has all its letters."""

    text: str
    font: Font


def lettering(text: str, font_px: float) -> Lettering:
    """The text as it can be drawn: in Pillow's font where that has its letters, else in the best of the system's.

    Letters that no font has become those that they are an accented form of, or question marks.
    """
    text = unicodedata.normalize("NFC", text)  # macOS writes the accents of files' names as letters of their own
    path = _path_for(frozenset(letter for letter in text if not letter.isascii()))
    return Lettering(_plain(text, path), _font(path, font_px))


@lru_cache(maxsize=8)
def _font(path: str | None, font_px: float) -> Font:
    return ImageFont.load_default(font_px) if path is None else ImageFont.truetype(path, font_px)


@lru_cache(maxsize=256)
def _path_for(letters: frozenset[str]) -> str | None:
    """The font that lacks the fewest of the letters, the first of several; None is Pillow's own."""
    best, least = None, _count_lacking(letters, None)
    for path in system_fonts() if least else ():
        if (lacking := _count_lacking(letters, path)) < least:
            best, least = path, lacking
        if not least:
            break
    return best


@lru_cache(maxsize=1)
def system_fonts() -> tuple[str, ...]:
    """The files of NAMES that this system has, in their order; never one of the current folder."""
    found: dict[str, str] = {}
    for folder in _folders():
        for where, _, names in os.walk(folder):
            found = {name: os.path.join(where, name) for name in names if name in NAMES} | found  # noqa: PTH118
    return tuple(path for name in NAMES if (path := found.get(name)) is not None and _is_font(path))


def _folders() -> Iterator[Path]:
    if sys.platform == "win32":
        folders: Iterable[str] = (f"{os.environ.get('WINDIR', '')}/Fonts",)
    elif sys.platform == "darwin":
        folders = ("/System/Library/Fonts", "/Library/Fonts")
    else:
        shared = os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share"
        folders = (f"{folder}/fonts" for folder in shared.split(":"))
    return (path for path in map(Path, folders) if path.is_absolute())


def _is_font(path: str) -> bool:
    try:
        opened(Path(path)).close()
        ImageFont.truetype(path, PROBED_PX)
    except (UserError, OSError):
        return False
    return True


def _count_lacking(letters: Iterable[str], path: str | None) -> int:
    return sum(not _has(path, letter) for letter in letters)


@lru_cache(maxsize=4096)
def _has(path: str | None, letter: str) -> bool:
    # Spaces look like a letter that is missing in fonts that draw nothing for one.
    return letter.isascii() or letter.isspace() or _shape(path, letter) != _shape(path, NO_LETTER)


def _shape(path: str | None, letter: str) -> tuple[tuple[int, int], bytes]:
    shape = _font(path, PROBED_PX).getmask(letter)
    return shape.size, bytes(shape)


def _plain(text: str, path: str | None) -> str:
    return "".join(letter if _has(path, letter) else _without_accents(letter) for letter in text)


def _without_accents(letter: str) -> str:
    base = unicodedata.normalize("NFKD", letter)[0]
    if unicodedata.combining(letter):
        return ""
    return base if base.isascii() and base.isprintable() else UNKNOWN
