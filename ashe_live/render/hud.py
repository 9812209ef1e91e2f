"""Text on the video: lines on dark translucent plates, drawn by Pillow and kept until they change."""

from dataclasses import dataclass

import numpy as np
from PIL import Image as PillowImage
from PIL import ImageDraw, ImageFont

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.scene import Overlay

Rows = tuple[tuple[str, ...], ...]  # of one or more columns

FONT_PT = 15
MIN_FONT_PX = 6.0
PLATE_SRGBA = (12, 14, 18, 175)
TEXT_SRGBA = (246, 246, 242, 255)


@dataclass(frozen=True, slots=True)
class HudText:
    """What the display says. Empty parts are not drawn."""

    status: tuple[str, ...] = ()  # lines, top left
    hint: tuple[str, ...] = ()  # lines, bottom left
    help: Rows = ()  # centre; a row's cells stand in columns


class Hud:
    """Turns text into overlays; what has not changed comes back as the same objects, so it is not uploaded again."""

    def __init__(self) -> None:
        self._drawn: dict[tuple[str, Rows, Size, float], Overlay] = {}

    def overlays(self, text: HudText, size: Size, content_scale: float = 1.0) -> tuple[Overlay, ...]:
        """Plates for a framebuffer of `size` pixels whose display shows `content_scale` pixels a point."""
        corners = {
            "top left": tuple((line,) for line in text.status),
            "bottom left": tuple((line,) for line in text.hint),
            "centre": text.help,
        }
        keys = [(place, rows, size, content_scale) for place, rows in corners.items() if rows]
        self._drawn = {key: self._drawn.get(key) or _overlay(*key) for key in keys}
        return tuple(self._drawn.values())


def _overlay(place: str, rows: Rows, size: Size, content_scale: float) -> Overlay:
    font_px = FONT_PT * content_scale
    plate = _plate(rows, font_px)
    gap = round(8 * content_scale)
    # A long line in a small window: smaller letters rather than cut ones. Hinting makes their widths uneven steps.
    while font_px > MIN_FONT_PX and (plate.shape[1] > size[0] - 2 * gap or plate.shape[0] > size[1] - 2 * gap):
        font_px = max(MIN_FONT_PX, 0.9 * font_px)
        plate = _plate(rows, font_px)
    height, width = plate.shape[:2]
    left, top = {
        "top left": (gap, gap),
        "bottom left": (gap, size[1] - height - gap),
        "centre": ((size[0] - width) // 2, (size[1] - height) // 2),
    }[place]
    return Overlay(plate, left, top)


def _plate(rows: Rows, font_px: float) -> Image:
    """(h, w, 4) uint8 sRGB, straight alpha: rows of text in aligned columns on a rounded rectangle."""
    font = ImageFont.load_default(size=font_px)
    line_px = round(1.35 * font_px)
    padding, column_gap = round(0.6 * font_px), round(1.4 * font_px)
    columns = max(len(row) for row in rows)
    widths = [max(round(font.getlength(row[at])) for row in rows if at < len(row)) for at in range(columns)]
    width = sum(widths) + column_gap * (columns - 1) + 2 * padding
    height = line_px * len(rows) + 2 * padding
    picture = PillowImage.new("RGBA", (width, height))
    draw = ImageDraw.Draw(picture)
    draw.rounded_rectangle((0, 0, width - 1, height - 1), radius=round(0.5 * font_px), fill=PLATE_SRGBA)
    for number, row in enumerate(rows):
        left = padding
        for cell, column in zip(row, widths, strict=False):
            middle = padding + (number + 0.5) * line_px
            draw.text((left, middle), cell, fill=TEXT_SRGBA, font=font, anchor="lm")
            left += column + column_gap
    return np.array(picture, dtype=np.uint8)
