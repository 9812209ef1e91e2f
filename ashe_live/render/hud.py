"""Text on the video: lines on dark translucent plates, drawn by Pillow and kept until they change.

Lines that are wider than their place are broken; where they then are too many, the letters become smaller.
"""

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from PIL import Image as PillowImage
from PIL import ImageDraw

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.files.fonts import lettering
from ashe_live.process.messages import printable
from ashe_live.render.scene import Overlay
from ashe_live.render.screen import Screen

Rows = tuple[tuple[str, ...], ...]  # of one or more columns

FONT_PT = 15
GAP_PT = 8  # around plates
# In windows smaller than this, letters at the picture's corners shrink with it, down to a size that is read as well: of
# usual size they would cover half of it. They depend on nothing else, as they would change with every line that comes.
ROOMY_PT, SMALL_FONT_PT = (640, 480), 11
MIN_FONT_PX = 6.0
SMALLER = 0.95
FINER = 4  # letters are drawn so many times as large and reduced: small ones would stand at whole pixels, unevenly
PLATE_SRGBA = (12, 14, 18, 175)
TEXT_SRGBA = (246, 246, 242, 255)
# Spaces at which no line is broken: within "42° ± 1.0°", "98 %", "H: keys" and "G goes on".
UNBROKEN = re.compile(r"(?<=±) | (?=[±%])|(?<=\bH:) |(?<=\b[A-Z]) (?=goes on)")
NO_BREAK = "\u00a0"


@dataclass(frozen=True, slots=True)
class HudText:
    """The text of the heads-up display. Empty parts are not drawn."""

    status: tuple[str, ...] = ()  # lines, top left
    hint: tuple[str, ...] = ()  # lines, bottom left
    help: Rows = ()  # centre; a row's cells stand in columns


class _Block(NamedTuple):
    place: str
    rows: Rows
    font_px: float


class Hud:
    """Turns text into overlays; what has not changed comes back as the same objects, so it is not uploaded again."""

    def __init__(self) -> None:
        self._asked: tuple[HudText, Screen, int | None, int | None] | None = None
        self._plates: dict[tuple[_Block, Screen], Overlay] = {}

    def overlays(
        self, text: HudText, screen: Screen, free_width: int | None = None, free_height: int | None = None
    ) -> tuple[Overlay, ...]:
        """The plates of the text.

        `free_width`: pixels from the left that status and hint may have, where something else is at the right;
        `free_height`: how many of the height both and their gaps may have together, where something else is between.
        """
        asked = text, screen, free_width, free_height
        if asked != self._asked:
            width, height = free_width or screen.size[0], free_height or screen.size[1]
            keys = [(block, screen) for block in _blocks(text, screen, (width, height))]
            self._plates = {key: self._plates.get(key) or _overlay(*key) for key in keys}
            self._asked = asked
        return tuple(self._plates.values())


def _blocks(text: HudText, screen: Screen, free: Size) -> list[_Block]:
    """The text, in letters of the usual size, or in smaller ones where these do not fit."""
    # Names of files, and what these hold, are in it.
    status, hint = (tuple(map(printable, lines)) for lines in (text.status, text.hint))
    gap, font_px = screen.px(GAP_PT), (FONT_PT if text.help else _corner_font_pt(screen)) * screen.content_scale
    width = free[0] - 2 * gap
    while True:
        corners = [
            _Block(place, tuple((part,) for line in lines for part in _wrapped(line, font_px, width)), font_px)
            for place, lines in (("top left", status), ("bottom left", hint))
            if lines
        ]
        extents = [_extent(block.rows, font_px) for block in corners]
        all_fit = sum(height for _, height in extents) + (len(extents) + 1) * gap <= free[1]
        all_fit &= all(block_width <= width for block_width, _ in extents)
        centred = []
        if text.help:
            one_or_two = [rows for rows in (text.help, in_two(text.help)) if fits(rows, font_px, screen.size, gap)]
            centred = [_Block("centre", (one_or_two or [text.help])[0], font_px)]
            all_fit &= bool(one_or_two)
        if all_fit or font_px <= MIN_FONT_PX:
            return corners + centred
        font_px = max(MIN_FONT_PX, SMALLER * font_px)


def _corner_font_pt(screen: Screen) -> float:
    shares = (side / screen.content_scale / roomy for side, roomy in zip(screen.size, ROOMY_PT, strict=True))
    return max(SMALL_FONT_PT, FONT_PT * min(1.0, *shares))


def in_two(rows: Rows) -> Rows:
    """The second half of the rows beside the first."""
    half = (len(rows) + 1) // 2
    columns = max(len(row) for row in rows)
    filled = [row + ("",) * (columns - len(row)) for row in rows]
    return tuple(left + right for left, right in zip(filled, [*filled[half:], ("",) * columns], strict=False))[:half]


def fits(rows: Rows, font_px: float, size: Size, gap: int) -> bool:
    """Whether a plate of these rows stands in a framebuffer of `size` pixels with `gap` pixels around it."""
    width, height = _extent(rows, font_px)
    return width <= size[0] - 2 * gap and height <= size[1] - 2 * gap


def _wrapped(line: str, font_px: float, width: int) -> list[str]:
    """Parts of a line, broken between words where it is wider than a plate of `width` holds, and within wider words."""
    if _extent(((line,),), font_px)[0] <= width:
        return [line]
    parts: list[str] = []
    # Word by word, so that the time it takes grows with the line and not with its square.
    for word in UNBROKEN.sub(NO_BREAK, line).split(" "):
        begin, *others = _pieces(word, font_px, width)
        longer = f"{parts[-1]} {begin}" if parts else begin
        if parts and parts[-1].strip() and _extent(((longer,),), font_px)[0] > width:
            parts.append(begin)
        else:
            parts[-1:] = [longer]
        parts += others
    # What separated two readings is no indent where the line is broken between them.
    return [part.replace(NO_BREAK, " ") for part in (parts[0], *(part.lstrip(" ") for part in parts[1:]))]


def _pieces(word: str, font_px: float, width: int) -> list[str]:
    """A word in pieces, each no wider than fits on a plate of `width`, or a single letter."""
    pieces, count = [], max(len(word), 1)
    while word:
        while count > 1 and _extent(((word[:count],),), font_px)[0] > width:
            count = count * 3 // 4
        pieces.append(word[:count])
        word = word[count:]
    return pieces or [""]


def _overlay(block: _Block, screen: Screen) -> Overlay:
    plate = rows_plate(block.rows, block.font_px)
    size, gap = screen.size, screen.px(GAP_PT)
    height, width = plate.shape[:2]
    left, top = {
        "top left": (gap, gap),
        "bottom left": (gap, size[1] - height - gap),
        "centre": ((size[0] - width) // 2, (size[1] - height) // 2),
    }[block.place]
    return Overlay(plate, left, top)


@lru_cache(maxsize=512)
def text_width(text: str, font_px: float) -> int:
    """The text's width in pixels. Kept, as most lines stay when a number in one of them changes."""
    text, font = lettering(text, FINER * font_px)
    return round(font.getlength(text) / FINER)


@lru_cache(maxsize=128)
def text_ink(text: str, font_px: float, line: int) -> PillowImage.Image:
    """(line, width) coverage of the text's pixels, 0 to 255, with `bleed_px` columns more at its left and right."""
    bleed = bleed_px(font_px)
    fine = PillowImage.new("L", (FINER * (text_width(text, font_px) + 2 * bleed), FINER * line))
    at = FINER * bleed, 0.5 * FINER * line
    text, font = lettering(text, FINER * font_px)
    ImageDraw.Draw(fine).text(at, text, fill=255, font=font, anchor="lm")
    return fine.reduce(FINER)


def bleed_px(font_px: float) -> int:
    """Pixels by which letters may reach out of the text's width."""
    return math.ceil(0.5 * font_px)


@dataclass(frozen=True, slots=True)
class RowLayout:
    """Where rows of text stand on their plate, in pixels."""

    size: Size  # of the plate
    padding: int  # around the rows
    line: int  # height of a row
    column_widths: tuple[int, ...]
    column_gap: int


def row_layout(rows: Rows, font_px: float) -> RowLayout:
    widths = _column_widths(rows, font_px)
    padding, column_gap, line = round(0.6 * font_px), round(1.4 * font_px), round(1.35 * font_px)
    width = sum(widths) + column_gap * (len(widths) - 1) + 2 * padding
    return RowLayout((width, line * len(rows) + 2 * padding), padding, line, tuple(widths), column_gap)


def _column_widths(rows: Rows, font_px: float) -> list[int]:
    columns = max(len(row) for row in rows)
    return [max(text_width(row[at], font_px) for row in rows if at < len(row)) for at in range(columns)]


def _extent(rows: Rows, font_px: float) -> Size:
    """Width and height of a plate, in pixels."""
    return row_layout(rows, font_px).size


def rows_plate(rows: Rows, font_px: float) -> Image:
    """(h, w, 4) uint8 sRGB, straight alpha: rows of text in aligned columns on a rounded rectangle."""
    layout = row_layout(rows, font_px)
    width, height = layout.size
    picture = PillowImage.new("RGBA", (width, height))
    draw = ImageDraw.Draw(picture)
    draw.rounded_rectangle((0, 0, width - 1, height - 1), radius=round(0.5 * font_px), fill=PLATE_SRGBA)
    for number, row in enumerate(rows):
        left = layout.padding
        for cell, column in zip(row, layout.column_widths, strict=False):
            at = left - bleed_px(font_px), layout.padding + number * layout.line
            draw.bitmap(at, text_ink(cell, font_px, layout.line), fill=TEXT_SRGBA)
            left += column + layout.column_gap
    return np.array(picture, dtype=np.uint8)
