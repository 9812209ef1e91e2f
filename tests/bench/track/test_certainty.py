"""The bench of certainty: squared errors over covariances, and the fit that makes them one."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.track.certainty import SeenMarker, certainty_figures, fitted
from ashe_live.bench.track.takes import SIDE_M, SMALL, pose_at
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.tracking.edges.corner_errors import FITTED
from ashe_live.tracking.edges.squares import FittedSquare


def seen_with(sigma_px: float, stated_px: float, count: int = 60) -> list[SeenMarker]:
    """Squares whose corners are off by `sigma_px`, and that state `stated_px` for their edges' noise."""
    rng, seen = np.random.default_rng(5), []
    for _ in range(count):
        truth = pose_at(rng.uniform(0.4, 0.9), rng.uniform(20, 55), rng.uniform(0, 360))
        corners = project(SMALL, truth, square_corners(SIDE_M)) + rng.normal(0, sigma_px, (4, 2))
        square = replace(FittedSquare.guessed(corners, stated_px), bows=np.zeros(4), bleed_px=0.0)
        seen.append(SeenMarker(square, SMALL, SIDE_M, truth))
    return seen


def test_a_ratio_of_one_is_reached_where_the_stated_errors_are_the_true_ones() -> None:
    honest = [replace(one, square=replace(one.square, bows=None)) for one in seen_with(0.1, 0.1, 200)]
    _, ratio, within = certainty_figures("honest", honest)
    assert ratio.ours == pytest.approx(1, abs=0.3)
    assert within.ours == pytest.approx(95, abs=5)
    _, ratio, within = certainty_figures("sure", seen_with(0.3, 0.01, 200))
    assert ratio.ours is not None
    assert within.ours is not None
    assert ratio.ours > 2
    assert within.ours < 90


def test_the_fit_finds_the_errors_that_were_put_in() -> None:
    """Corners off by 0.1 px in each coordinate: each end of a side is off by as much across it."""
    # Squares without curl and bleeding ink tell nothing of these.
    stated = ("curl", "bleed_share", "bleed_px", "bleed_half_px")
    found = fitted(seen_with(0.1, 0.005, 12), replace(FITTED, end_px=0.05, weight=50.0), stated)
    assert found.end_px == pytest.approx(0.1, rel=0.4)


def test_what_is_not_found_is_counted() -> None:
    found, *_ = certainty_figures("half", [*seen_with(0.1, 0.1, 3), None, None, None])
    assert found.ours == 50


def test_where_no_marker_is_found_nothing_is_fitted_and_the_share_is_0() -> None:
    assert fitted([None]) is None
    (found,) = certainty_figures("none", [None, None])
    assert found.ours == 0
    assert fitted([]) is None
    assert not list(certainty_figures("photos", []))
