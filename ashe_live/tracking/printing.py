"""Sheets at true size: the marker that a webcam session starts with, and the board that calibrates its camera."""

from dataclasses import dataclass
from pathlib import Path

import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.files.new_file import check_output
from ashe_live.files.writing import written_whole
from ashe_live.tracking.calibration_board import CalibrationBoard
from ashe_live.tracking.layout import Layout, members_of
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
MIN_SQUARE_MM = 5
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

    @property
    def height_mm(self) -> float:
        return self.image.height / self.dpi * 25.4

    @property
    def middle_mm(self) -> tuple[float, float]:
        """Of the part above the foot."""
        return self.image.width / self.dpi * 25.4 / 2, (self.height_mm - FOOT_MM) / 2

    def px(self, mm: float) -> int:
        return round(mm / 25.4 * self.dpi)

    def picture(self, grey: Image, top_left_mm: tuple[float, float]) -> None:
        self.image.paste(PIL.Image.fromarray(grey), (self.px(top_left_mm[0]), self.px(top_left_mm[1])))

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


def write_marker_sheet(path: Path, marker: Marker | Layout, side_m: float, overwrite: bool = False) -> None:
    """Writes a PDF or PNG page, by `path`'s suffix, whose black squares are `side_m` wide when printed at 100 %.

    Raises UserError for another suffix, an existing file (without `overwrite`), a size that fits no page, or a place
    that cannot be written.
    """
    side_mm = side_m * 1000
    _check(path, overwrite)
    members = members_of(marker)
    width, height = marker.extent if isinstance(marker, Layout) else (1.0, 1.0)
    page = _blank_page((width * side_mm, height * side_mm), QUIET_ZONE * side_mm)
    if side_mm < MIN_SIDE_MM or page is None:
        largest = int((PAGES_MM_DPI[-1][1][0] - 2 * PRINTER_EDGE_MM) / (max(width, height) + 2 * QUIET_ZONE))
        raise UserError(f"no page fits a marker of {side_mm:g} mm", f"choose a size from {MIN_SIDE_MM} to {largest} mm")
    middle_x, middle_y = page.middle_mm
    for member in members:
        left, top, _ = member.corners[0] * side_mm
        page.picture(member.marker.bitmap(page.px(side_mm)), (middle_x + left, middle_y - top))
    page.text((middle_x, middle_y - side_mm * (height / 2 + QUIET_ZONE) - 4), "up")
    _write(path, overwrite, page, f"{_short(marker.spec)}   {side_mm:g} mm")


def write_board_sheet(path: Path, board: CalibrationBoard, square_m: float, overwrite: bool = False) -> None:
    """As write_marker_sheet, with the calibration board, whose squares are `square_m` wide."""
    square_mm = square_m * 1000
    _check(path, overwrite)
    columns, rows = board.squares
    width_mm, height_mm = columns * square_mm, rows * square_mm
    page = _blank_page((width_mm, height_mm), QUIET_ZONE * square_mm)
    if square_mm < MIN_SQUARE_MM or page is None:
        widest = (PAGES_MM_DPI[-1][1][0] - 2 * PRINTER_EDGE_MM) / (columns + 2 * QUIET_ZONE)
        remedy = f"choose squares from {MIN_SQUARE_MM} to {int(widest)} mm"
        raise UserError(f"no page fits a board of squares of {square_mm:g} mm", remedy)
    middle_x, middle_y = page.middle_mm
    picture = board.bitmap((page.px(width_mm), page.px(height_mm)))
    page.picture(picture, (middle_x - width_mm / 2, middle_y - height_mm / 2))
    _write(path, overwrite, page, f"calibration board   {columns} x {rows} squares of {square_mm:g} mm   must lie flat")


def _check(path: Path, overwrite: bool) -> None:
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(f"cannot print to {path.name!r}", "name a .pdf or a .png file")
    check_output(path, overwrite)


def _blank_page(size_mm: tuple[float, float], quiet_mm: float) -> _Page | None:
    """The smallest page that holds a picture of `size_mm` with white around it, or None."""
    for _, (width, height), dpi in PAGES_MM_DPI:
        room = width - 2 * PRINTER_EDGE_MM, height - FOOT_MM - 2 * PRINTER_EDGE_MM - 12
        if all(0 < side + 2 * quiet_mm <= most for side, most in zip(size_mm, room, strict=True)):
            return _Page(PIL.Image.new("L", (round(width / 25.4 * dpi), round(height / 25.4 * dpi)), PAPER), dpi)
    return None


def _write(path: Path, overwrite: bool, page: _Page, caption: str) -> None:
    """Saves the page with its foot: what it shows, and a line to check its scale with."""
    (middle_x, _), height = page.middle_mm, page.height_mm
    page.text((middle_x, height - FOOT_MM + 8), caption)
    page.text((middle_x, height - FOOT_MM + 15), "print at 100 %, do not scale, then check with this line:", 3.5)
    _draw_ruler(page, middle_x, height - FOOT_MM + 24)
    with written_whole(path, overwrite) as file:
        if path.suffix.lower() == ".pdf":
            page.image.save(file.stream, "PDF", resolution=page.dpi, quality=95, title=caption)
        else:
            page.image.save(file.stream, "PNG", dpi=(page.dpi, page.dpi))


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
