"""Overexposed prints: clipped white grows over ink, so that cells are narrow and the outline lies within the square."""

import numpy as np
import pytest

from ashe_live.bench.track.frames import Flaws, PrintedMarker, ground
from ashe_live.bench.track.takes import SMALL, pose_at
from ashe_live.core.arrays import Float
from ashe_live.core.square import mean_side_px, square_corners
from ashe_live.core.transforms import project
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.corners import refined_corners
from ashe_live.tracking.edges.print_likeness import with_white_grown
from ashe_live.tracking.edges.quads import on_lighter
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import SIDE_M, frame

POSE = pose_at(1.3, 25, 20)
CORNERS = project(SMALL, POSE, square_corners(SIDE_M))


def picture(spec: str, flaws: Flaws, seed: int) -> np.ndarray:
    painter = PrintedMarker(parse_marker(spec).bitmap(240), SIDE_M, SMALL, flaws, 4)
    return painter.painted([POSE], np.random.default_rng(seed), ground(SMALL))


def off_px(spec: str, image_bgr: np.ndarray) -> float:
    """By how much a corner found in a single picture is off at most; infinite where none is found."""
    found = MarkerTracker(parse_marker(spec), SMALL, SIDE_M, BALANCED.tracking).track(frame(image_bgr)).marker
    return np.inf if found is None else float(np.abs(found.corners_px - CORNERS).max())


@pytest.mark.parametrize("spec", ["aruco:4x4_50:3", "aruco:5x5_100:40"])
def test_an_overexposed_print_is_found_where_it_is(spec: str) -> None:
    """Not where its edges are seen: those lie within it by more than a pixel."""
    flaws = Flaws(blur_px=1.2, gain=10)
    for seed in range(6):
        image = picture(spec, flaws, seed)
        seen: Float = refined_corners(np.ascontiguousarray(image[:, :, 0]), CORNERS, 24)
        assert mean_side_px(seen) < mean_side_px(CORNERS) - 2.5
        assert off_px(spec, image) < 0.6


def test_ink_little_darker_than_clipped_paper_is_read() -> None:
    flaws = Flaws(blur_px=0.7, gain=24, noise=1.0)
    grey = np.ascontiguousarray(picture("aruco:4x4_50:3", flaws, 1)[:, :, 0])
    assert not on_lighter(grey, [CORNERS])
    assert on_lighter(grey, [CORNERS], is_clipped=True)
    assert all(off_px("aruco:4x4_50:3", picture("aruco:4x4_50:3", flaws, seed)) < 1.0 for seed in range(4))


def test_another_overexposed_marker_is_not_the_one_that_is_looked_for() -> None:
    flaws = Flaws(blur_px=1.2, gain=10)
    for number in (3, 17, 28, 31, 44):
        image = picture(f"aruco:4x4_50:{number}", flaws, number)
        for other in range(0, 50, 3):
            assert other == number or off_px(f"aruco:4x4_50:{other}", image) == np.inf


def test_white_grows_into_ink_from_all_sides_alike() -> None:
    ink = np.zeros((40, 40), np.uint8)
    ink[10:20, 10:20] = 255
    grown = with_white_grown(ink, 0.05)
    expected = np.full((40, 40), 255, np.uint8)
    expected[2:38, 2:38] = 0
    expected[8:22, 8:22] = 255
    np.testing.assert_array_equal(grown, expected)
