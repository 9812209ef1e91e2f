"""`ashe-live board`: the board as it comes out of the printer."""

from pathlib import Path

import numpy as np
import pytest

from ashe_live.tracking.boards.calibration_board import CalibrationBoard
from tests.printed_page import as_printed

BOARD = CalibrationBoard()


@pytest.mark.parametrize(
    ("arguments", "suffix", "square_mm", "page_mm", "needs"),
    [
        ((), ".pdf", 25, (210, 297), ""),
        (("--square-mm", "12.5"), ".png", 12.5, (210, 297), ""),
        (("--square-mm", "35"), ".pdf", 35, (297, 420), " on A3 paper (297 x 420 mm), as A4 is too small"),
        (("--square-mm", "20", "--paper", "letter"), ".png", 20, (215.9, 279.4), ""),
        (("--square-mm", "35", "--paper", "a3"), ".png", 35, (297, 420), ""),
    ],
)
def test_its_squares_are_printed_as_large_as_asked_on_the_paper_that_it_names(
    run,
    tmp_path: Path,
    arguments: tuple[str, ...],
    suffix: str,
    square_mm: float,
    page_mm: tuple[float, float],
    needs: str,
) -> None:
    path = tmp_path / f"board{suffix}"
    outcome = run("board", "--out", path, *arguments)
    assert outcome.status == 0
    assert outcome.out[0].startswith(f"{path}: print it{needs}, ")
    assert "ashe-live calibrate" in outcome.out[0]
    grey, mm_per_px = as_printed(path)
    assert np.array(grey.shape[::-1]) * mm_per_px == pytest.approx(page_mm, abs=0.1)
    view = BOARD.find(grey)
    assert view is not None
    assert len(view.corners_px) == (BOARD.squares[0] - 1) * (BOARD.squares[1] - 1)
    corners_mm, expected_mm = view.corners_px * mm_per_px, view.points[:, :2] * square_mm
    np.testing.assert_allclose(corners_mm - corners_mm[0], expected_mm - expected_mm[0], atol=0.1)


def test_an_existing_board_is_left_alone_and_one_that_no_page_holds_is_one_line(run, tmp_path: Path) -> None:
    path = tmp_path / "board.pdf"
    path.write_bytes(b"precious")
    assert "--overwrite" in run("board", "--out", path).refusal
    assert path.read_bytes() == b"precious"
    assert "no page fits" in run("board", "--out", path, "--square-mm", "200", "--overwrite").refusal
    assert path.read_bytes() == b"precious"
    assert run("board", "--out", path, "--overwrite").status == 0
    assert path.read_bytes().startswith(b"%PDF")
