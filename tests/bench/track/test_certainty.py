"""The bench of certainty: squared errors over covariances, and the fit that makes them one."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.track.certainty import SeenMarker, certainty_figures, fitted, look_at
from ashe_live.bench.track.measures import turn_deg
from ashe_live.bench.track.takes import SIDE_M, SMALL, pose_at
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.corner_errors import FITTED
from ashe_live.tracking.edges.squares import FittedSquare
from tests.shipped_scenes import CASES, LIT


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


def test_markers_are_seen_where_they_are_in_pictures_that_name_them() -> None:
    cases = [CASES[name] for name in LIT[:2]]
    unnamed = replace(cases[0], marker_spec=None)
    absent = replace(cases[0], marker_spec="aruco:4x4_50:49")
    seen = look_at([cases[0], unnamed, absent, cases[1]], BALANCED.tracking)
    assert [one is None for one in seen] == [False, True, False]
    for one, case in zip((seen[0], seen[2]), cases, strict=True):
        assert one is not None
        np.testing.assert_array_equal(one.truth, case.marker.T_cam_marker)
        pose = one.pose(FITTED)
        assert pose is not None
        assert turn_deg(pose.T_cam_marker, one.truth) < 1
        assert pose.T_cam_marker[:3, 3] == pytest.approx(one.truth[:3, 3], rel=0.02, abs=0.005)


def test_what_is_not_found_is_counted() -> None:
    found, *_ = certainty_figures("half", [*seen_with(0.1, 0.1, 3), None, None, None])
    assert found.ours == 50


def test_where_no_marker_is_found_nothing_is_fitted_and_the_share_is_0() -> None:
    assert fitted([None]) is None
    (found,) = certainty_figures("none", [None, None])
    assert found.ours == 0
    assert fitted([]) is None
    assert not list(certainty_figures("photos", []))
