"""What the calibration's window shows, without the window."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.tracking.boards.calibration_board import BoardView
from ashe_live.tracking.boards.calibration_guide import CalibrationGuide
from ashe_live.viewer.windows.calibration_window import KEPT_BGR, UNSEEN, guidance_picture, progress_lines

SIZE = (320, 240)
GREY = 200
IMAGE = np.full((SIZE[1], SIZE[0], 3), GREY, np.uint8)


def board_at(left: float, top: float) -> BoardView:
    """Five by four corners, 10 px apart."""
    points: Float = np.array([(x, y, 0.0) for y in range(1, 5) for x in range(1, 6)])
    return BoardView(points[:, :2] * 10 + (left, top), points)


@pytest.fixture
def guide() -> CalibrationGuide:
    guide = CalibrationGuide(SIZE)
    guide.add(board_at(0, 0), 0)
    return guide


def test_what_the_board_has_not_seen_is_dark(guide: CalibrationGuide) -> None:
    picture = guidance_picture(IMAGE, None, guide)
    assert picture[3, 3].tolist() == [GREY] * 3
    for y, x in ((3, 310), (230, 3), (120, 160), (230, 310)):
        assert picture[y, x].tolist() == [int(UNSEEN * GREY)] * 3
    assert (IMAGE == GREY).all(), "the frame itself is left alone"


def test_the_corners_that_are_found_are_marked(guide: CalibrationGuide) -> None:
    now = board_at(200, 100)
    changed = guidance_picture(IMAGE, now, guide).astype(int) - guidance_picture(IMAGE, None, guide)
    for x, y in now.corners_px.astype(int):
        assert changed[y - 4 : y + 5, x - 4 : x + 5].any()


def test_the_views_that_are_kept_are_outlined(guide: CalibrationGuide) -> None:
    picture = guidance_picture(IMAGE, None, guide)
    for x, y in ((10, 25), (50, 25), (30, 10), (30, 40)):  # the middles of the board's four sides
        assert np.abs(picture[y, x].astype(int) - KEPT_BGR).sum() < 100
    assert (picture[20:30, 20:40] == GREY).all(), "within it the picture is seen"


def test_it_says_how_far_it_is_and_what_is_wanted(guide: CalibrationGuide, monkeypatch: pytest.MonkeyPatch) -> None:
    state, wanted = progress_lines(board_at(0, 0), guide)
    assert "views: 1" in state
    assert wanted == guide.wanted()
    assert progress_lines(None, guide)[1] == "no board in view"
    monkeypatch.setattr(CalibrationGuide, "wanted", lambda _self: None)
    assert progress_lines(board_at(0, 0), guide)[1] == "enough"
