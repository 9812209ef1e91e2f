"""Sheets at true size: the marker that a webcam session starts with, and the board that calibrates its camera."""

from pathlib import Path

from ashe_live.core.square import PAGE_FOOT_MM
from ashe_live.errors import UserError
from ashe_live.tracking.boards.calibration_board import CalibrationBoard
from ashe_live.tracking.families.layout import Layout, members_of
from ashe_live.tracking.families.markers import Marker
from ashe_live.tracking.families.page import PAPERS_MM, PRINTER_EDGE_MM, Millimetres, PrintedPage, check_page_file

MIN_SIDE_MM = 10
MIN_SQUARE_MM = 5
# White around the black square: without it no detector finds the square's edge on a dark table.
QUIET_ZONE = 1 / 8


def write_marker_sheet(
    path: Path, marker: Marker | Layout, side_m: float, overwrite: bool = False, paper: str = "a4"
) -> Millimetres:
    """Writes a PDF or PNG page, by `path`'s suffix, whose black squares are `side_m` wide when printed at 100 %.

    Returns the page's width and height.

    paper: one of PAPERS_MM; the page is this one, or the next larger one of its series that has room for the marker.
    Raises UserError for another suffix, an existing file (without `overwrite`), a size that fits no page, or a place
    that cannot be written.
    """
    side_mm = side_m * 1000
    check_page_file(path, overwrite)
    members = members_of(marker)
    width, height = marker.extent if isinstance(marker, Layout) else (1.0, 1.0)
    page = _blank_page((width * side_mm, height * side_mm), QUIET_ZONE * side_mm, paper)
    if side_mm < MIN_SIDE_MM or page is None:
        remedy = f"choose a size from {MIN_SIDE_MM} to {_largest_mm((width, height), paper)} mm"
        raise UserError(f"no page fits a marker of {side_mm:g} mm", remedy)
    middle_x, middle_y = _middle_mm(page)
    for member in members:
        left, top, _ = member.corners[0] * side_mm
        page.picture(member.marker.bitmap(page.px(side_mm)), (middle_x + left, middle_y - top))
    page.text((middle_x, middle_y - side_mm * (height / 2 + QUIET_ZONE) - 4), "up")
    _write(path, overwrite, page, f"{_short(marker.spec)}   {side_mm:g} mm")
    return page.width_mm, page.height_mm


def write_board_sheet(
    path: Path, board: CalibrationBoard, square_m: float, overwrite: bool = False, paper: str = "a4"
) -> Millimetres:
    """As write_marker_sheet, with the calibration board, whose squares are `square_m` wide."""
    square_mm = square_m * 1000
    check_page_file(path, overwrite)
    columns, rows = board.squares
    width_mm, height_mm = columns * square_mm, rows * square_mm
    page = _blank_page((width_mm, height_mm), QUIET_ZONE * square_mm, paper)
    if square_mm < MIN_SQUARE_MM or page is None:
        remedy = f"choose squares from {MIN_SQUARE_MM} to {_largest_mm((columns, rows), paper)} mm"
        raise UserError(f"no page fits a board of squares of {square_mm:g} mm", remedy)
    middle_x, middle_y = _middle_mm(page)
    picture = board.bitmap((page.px(width_mm), page.px(height_mm)))
    page.picture(picture, (middle_x - width_mm / 2, middle_y - height_mm / 2))
    _write(path, overwrite, page, f"calibration board   {columns} x {rows} squares of {square_mm:g} mm   must lie flat")
    return page.width_mm, page.height_mm


def _blank_page(size_mm: Millimetres, quiet_mm: float, paper: str) -> PrintedPage | None:
    """The smallest page that holds a picture of `size_mm` with white around it, or None."""
    for page_mm in PAPERS_MM[paper]:
        if all(0 < side + 2 * quiet_mm <= most for side, most in zip(size_mm, _room_mm(page_mm), strict=True)):
            return PrintedPage.blank(page_mm)
    return None


def _largest_mm(squares: tuple[float, float], paper: str) -> int:
    """The largest side in whole millimetres of squares of which so many, across and down, fit on the largest page."""
    room = zip(squares, _room_mm(PAPERS_MM[paper][-1]), strict=True)
    return int(min(most / (count + 2 * QUIET_ZONE) for count, most in room))


def _room_mm(page_mm: Millimetres) -> Millimetres:
    """Of a page, for a picture with white around it: above the foot, and below the word that says where up is."""
    width, height = page_mm
    return width - 2 * PRINTER_EDGE_MM, height - PAGE_FOOT_MM - 2 * PRINTER_EDGE_MM - 12


def _middle_mm(page: PrintedPage) -> Millimetres:
    """The middle of the page above the foot."""
    return page.width_mm / 2, (page.height_mm - PAGE_FOOT_MM) / 2


def _write(path: Path, overwrite: bool, page: PrintedPage, caption: str) -> None:
    """Saves the page with its foot: what it shows, and a line to check its scale with."""
    (middle_x, _), height = _middle_mm(page), page.height_mm
    page.text((middle_x, height - PAGE_FOOT_MM + 8), caption)
    page.text((middle_x, height - PAGE_FOOT_MM + 15), "print at 100 %, do not scale, then check with this line:", 3.5)
    page.ruler((middle_x - 50, height - PAGE_FOOT_MM + 24))
    page.write(path, overwrite, caption)


def _short(spec: str) -> str:
    """A spec without the folders of its file."""
    kind, _, rest = spec.partition(":")
    return f"{kind}:{Path(rest).name}" if kind in ("pattern", "image") else spec
