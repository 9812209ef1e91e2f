"""The board: printed at true size, found again in its print, whole and in part."""

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from ashe_live.tracking.boards.calibration_board import CalibrationBoard
from ashe_live.tracking.families.printing import write_board_sheet
from tests.printed_page import assert_advice_holds

BOARD = CalibrationBoard()


def printed(folder: Path, square_mm: float) -> tuple[Image, float]:
    """The sheet's grey picture and its pixels a millimetre."""
    path = folder / "board.png"
    write_board_sheet(path, BOARD, square_mm / 1000)
    with PIL.Image.open(path) as sheet:
        return np.asarray(sheet.convert("L")), sheet.info["dpi"][0] / 25.4


@pytest.mark.parametrize("square_mm", [12, 25, 60])
def test_its_squares_are_as_large_as_asked(tmp_path: Path, square_mm: float) -> None:
    grey, px_per_mm = printed(tmp_path, square_mm)
    view = BOARD.find(grey)
    assert view is not None
    assert len(view.corners_px) == (BOARD.squares[0] - 1) * (BOARD.squares[1] - 1)
    corners_mm = view.corners_px / px_per_mm
    expected_mm = view.points[:, :2] * square_mm
    np.testing.assert_allclose(corners_mm - corners_mm[0], expected_mm - expected_mm[0], atol=0.1)


@pytest.mark.parametrize("size_px", [(280, 320), (2811, 3213), (2921, 3339), (3621, 4139)])
def test_it_is_drawn_in_every_size(size_px: tuple[int, int]) -> None:
    """Also where a square has no whole number of pixels: on A3 those of 25 mm have 417.3 of them."""
    grey = BOARD.bitmap(size_px)
    assert grey.shape == size_px[::-1]
    # Of each pixel: in which square its middle lies, and where in that, squares.
    (column, x), (row, y) = (
        np.divmod((np.arange(side) + 0.5) / side * count, 1) for side, count in zip(size_px, BOARD.squares, strict=True)
    )
    is_black = (row[:, None] + column) % 2 == 0
    to_edge = np.minimum(np.minimum(x, 1 - x), np.minimum(y, 1 - y)[:, None])
    assert grey[is_black & (to_edge > 0.005)].max() == 0
    assert grey[~is_black & (to_edge > 0.005) & (to_edge < 0.13)].min() == 255
    assert 0.4 < (grey[~is_black & (to_edge > 0.15)] == 0).mean() < 0.9, "a marker"


def test_a_part_of_it_names_its_own_corners(tmp_path: Path) -> None:
    grey, _ = printed(tmp_path, 25)
    whole = BOARD.find(grey)
    assert whole is not None
    left = int(np.median(whole.corners_px[:, 0]))
    part = BOARD.find(np.ascontiguousarray(grey[:, left:]))
    assert part is not None
    assert 0 < len(part.corners_px) < len(whole.corners_px)
    known = {tuple(point): corner for point, corner in zip(whole.points, whole.corners_px, strict=True)}
    expected = np.array([known[tuple(point)] for point in part.points])
    np.testing.assert_allclose(part.corners_px + np.array((left, 0)), expected, atol=0.2)


def test_nothing_is_found_where_there_is_no_board() -> None:
    noise = np.random.default_rng(3).integers(0, 256, (480, 640), dtype=np.uint8)
    assert BOARD.find(noise) is None
    assert BOARD.find(np.full((480, 640), 255, np.uint8)) is None


@pytest.mark.parametrize("square_m", [0.0, 0.001, 0.5, float("nan")])
def test_a_size_that_no_page_fits_is_refused(tmp_path: Path, square_m: float) -> None:
    with pytest.raises(UserError, match="no page fits"):
        write_board_sheet(tmp_path / "board.png", BOARD, square_m)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_the_largest_squares_that_it_advises_are_the_largest_that_fit_any_page(tmp_path: Path, paper: str) -> None:
    path = tmp_path / "board.pdf"
    assert_advice_holds(lambda square_m: write_board_sheet(path, BOARD, square_m, True, paper), "squares")
