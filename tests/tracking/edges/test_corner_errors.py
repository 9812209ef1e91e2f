"""What a square's corners may be off by beside noise: tones, white that is cut off, curled paper."""

import numpy as np
import pytest

from ashe_live.bench.track.frames import Flaws, PrintedMarker
from ashe_live.bench.track.takes import CELLS, SIDE_M, SMALL, SPEC, pose_at
from ashe_live.core.arrays import Float
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.corner_errors import FITTED, corrected, systematic, uncorrected_px
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker

TRUTH = pose_at(SMALL.K[0, 0] * SIDE_M / 100, 30, 20)
SQUARE = np.array([(100.0, 100.0), (200.0, 90.0), (210.0, 180.0), (90.0, 190.0)])


def corners_off_px(flaws: Flaws) -> Float:
    """(4,) distances of the corners from the truth."""
    image = PrintedMarker(parse_marker(SPEC).bitmap(CELLS), SIDE_M, SMALL, flaws).painted(
        [TRUTH], np.random.default_rng(3)
    )
    found = MarkerTracker(parse_marker(SPEC), SMALL, SIDE_M, BALANCED.tracking).track(Frame(image, 0, 0.0)).marker
    assert found is not None
    return np.linalg.norm(found.corners_px - project(SMALL, TRUTH, square_corners(SIDE_M)), axis=1)


@pytest.mark.parametrize("gamma", [1 / 2.2, 1 / 1.5, 1.5, 2.2])
def test_another_tone_curve_moves_corners_by_less_than_a_fifth_of_a_pixel(gamma: float) -> None:
    """In linear light by sRGB's curve, all edges of such a picture lie 0.3 to 0.8 px off."""
    assert corners_off_px(Flaws(gamma=gamma)).max() < 0.2


@pytest.mark.parametrize("gain", [1.5, 2.5])
def test_white_that_is_cut_off_moves_corners_by_less_than_a_fifth_of_a_pixel(gain: float) -> None:
    assert corners_off_px(Flaws(gain=gain)).max() < 0.2


def test_sides_are_moved_back_from_where_the_inside_says_that_they_lie() -> None:
    square = FittedSquare(SQUARE, np.tile(np.eye(8), (4, 1, 1)), bows=np.zeros(4))
    smaller = corrected(square, 1.0)
    assert (np.abs(smaller.corners_px - SQUARE.mean(axis=0)) < np.abs(SQUARE - SQUARE.mean(axis=0))).all()
    np.testing.assert_allclose(uncorrected_px(smaller), SQUARE, atol=0.02)
    # What is hardly more than noise moves nothing.
    np.testing.assert_array_equal(corrected(square, 0.02).corners_px, SQUARE)


def test_the_more_is_amiss_the_less_certain_are_the_corners() -> None:
    flat = FittedSquare(SQUARE, np.tile(np.eye(8), (4, 1, 1)), bows=np.zeros(4), bleed_px=0.0)
    curled = FittedSquare(SQUARE, flat.by_side, bows=np.array([0.01, 0.0, 0.01, 0.0]), bleed_px=0.0)
    washed_out = FittedSquare(SQUARE, flat.by_side, bows=np.zeros(4), bleed_px=-0.5)
    unknown = FittedSquare(SQUARE, flat.by_side, bows=np.zeros(4))
    least = systematic(flat)
    # Two sides of unit normals hold a corner twice as surely as one holds it across itself, at best.
    assert np.linalg.eigvalsh(least).min() >= 0.5 * FITTED.end_px**2
    assert (np.linalg.eigvalsh(systematic(curled) - least) > 0).all()
    for one, other in ((least, systematic(washed_out)), (systematic(washed_out), systematic(unknown))):
        assert np.trace(other) > np.trace(one)
        assert np.linalg.eigvalsh(other - one).min() > -1e-12


def test_corners_of_stated_uncertainty_are_believed() -> None:
    assert not systematic(FittedSquare.guessed(SQUARE, 0.5)).any()
