"""A sheet with the marker at true size: what a webcam session starts with."""

from dataclasses import dataclass
from pathlib import Path

import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

from ashe_live.core.output_files import check_output, written_whole
from ashe_live.errors import UserError
from ashe_live.tracking.markers import Marker

SUFFIXES = (".pdf", ".png")
# ISO 216 portrait pages, and the resolution that gives each of them about as many pixels as the first.
PAGES_MM_DPI = (
    ("A4", (210, 297), 600),
    ("A3", (297, 420), 424),
    ("A2", (420, 594), 300),
    ("A1", (594, 841), 212),
    ("A0", (841, 1189), 150),
)
MIN_SIDE_MM = 10
# White around the black square: without it no detector finds the square's edge on a dark table.
QUIET_ZONE = 1 / 8
PRINTER_EDGE_MM = 8
FOOT_MM = 45
INK = 0
PAPER = 255


@dataclass(frozen=True, slots=True)
class _Page:
    """A white page to draw on, measured in millimetres from its top-left corner."""

    image: PIL.Image.Image
    dpi: int

    def px(self, mm: float) -> int:
        return round(mm / 25.4 * self.dpi)

    def line(self, start_mm: tuple[float, float], end_mm: tuple[float, float], width_mm: float = 0.25) -> None:
        ends = [(self.px(x), self.px(y)) for x, y in (start_mm, end_mm)]
        PIL.ImageDraw.Draw(self.image).line(ends, fill=INK, width=max(1, self.px(width_mm)))

    def text(self, centre_mm: tuple[float, float], words: str, height_mm: float = 4.0) -> None:
        """Words centred on a point, made smaller where the page is too narrow for them."""
        draw = PIL.ImageDraw.Draw(self.image)
        room = self.image.width - 2 * self.px(PRINTER_EDGE_MM)
        size = float(self.px(height_mm))
        size *= min(1.0, room / max(1.0, draw.textlength(words, PIL.ImageFont.load_default(size))))
        font = PIL.ImageFont.load_default(size)
        draw.text((self.px(centre_mm[0]), self.px(centre_mm[1])), words, fill=INK, font=font, anchor="mm")


def write_marker_sheet(path: Path, marker: Marker, side_m: float, overwrite: bool = False) -> None:
    """Writes a PDF or PNG page, by `path`'s suffix, with the marker's black square `side_m` wide when printed at 100 %.

    Raises UserError for another suffix, an existing file (without `overwrite`), a size that fits no page, or a place
    that cannot be written.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(f"cannot write a marker as {path.name!r}", "name a .pdf or a .png file")
    check_output(path, overwrite)
    page = _sheet(marker, side_m * 1000)
    with written_whole(path) as partial:
        if path.suffix.lower() == ".pdf":
            page.image.save(partial, "PDF", resolution=page.dpi, quality=95)
        else:
            page.image.save(partial, "PNG", dpi=(page.dpi, page.dpi))


def _sheet(marker: Marker, side_mm: float) -> _Page:
    (width, height), dpi = _page_for(side_mm)
    page = _Page(PIL.Image.new("L", (round(width / 25.4 * dpi), round(height / 25.4 * dpi)), PAPER), dpi)
    middle_x, middle_y = width / 2, (height - FOOT_MM) / 2
    square = PIL.Image.fromarray(marker.bitmap(page.px(side_mm)))
    page.image.paste(square, (page.px(middle_x - side_mm / 2), page.px(middle_y - side_mm / 2)))
    page.text((middle_x, middle_y - side_mm * (0.5 + QUIET_ZONE) - 4), "up")
    page.text((middle_x, height - FOOT_MM + 8), f"{_short(marker.spec)}   {side_mm:g} mm")
    page.text((middle_x, height - FOOT_MM + 15), "print at 100 %, do not scale, then check with this line:", 3.5)
    _draw_ruler(page, middle_x, height - FOOT_MM + 24)
    return page


def _page_for(side_mm: float) -> tuple[tuple[int, int], int]:
    """Size in millimetres and resolution of the smallest page that holds the square with its quiet zone."""
    if side_mm >= MIN_SIDE_MM:
        for _, (width, height), dpi in PAGES_MM_DPI:
            room = min(width - 2 * PRINTER_EDGE_MM, height - FOOT_MM - 2 * PRINTER_EDGE_MM - 12)
            if side_mm * (1 + 2 * QUIET_ZONE) <= room:
                return (width, height), dpi
    largest = int((PAGES_MM_DPI[-1][1][0] - 2 * PRINTER_EDGE_MM) / (1 + 2 * QUIET_ZONE))
    raise UserError(f"no page fits a marker of {side_mm:g} mm", f"choose a size from {MIN_SIDE_MM} to {largest} mm")


def _draw_ruler(page: _Page, middle_x: float, y: float) -> None:
    """A line of 100 mm with a tick every 10 mm and labels at 0, 50 and 100."""
    left = middle_x - 50
    page.line((left, y), (left + 100, y))
    for mm in range(0, 101, 10):
        page.line((left + mm, y - (3.0 if mm % 50 == 0 else 1.5)), (left + mm, y))
    for mm, label in ((0, "0"), (50, "50"), (100, "100 mm")):
        page.text((left + mm, y + 4), label, 3.5)


def _short(spec: str) -> str:
    """A spec without the folders of its file."""
    kind, _, rest = spec.partition(":")
    return f"{kind}:{Path(rest).name}" if kind in ("pattern", "image") else spec
