"""The mean of the directions that several explanations have."""

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between, tangent_basis
from ashe_live.light.explanation.light_covariance import averaged
from ashe_live.light.shape.directions import FittedLight
from tests.light.synthetic_masks import direction

LOW, HIGH = direction(120.0, 40.0), direction(120.0, 46.0)
SUN = FittedLight(np.append(LOW, 0.0), np.diag([1e-4, 4e-4]))


def test_the_mean_lies_between_directions_by_their_weights() -> None:
    half_way = averaged(SUN, np.array([LOW, HIGH]), np.array([2.0, 2.0])).to_light_marker
    assert np.degrees(angle_between(half_way, direction(120.0, 43.0))) < 0.01
    third = averaged(SUN, np.array([LOW, HIGH]), np.array([0.4, 0.2])).to_light_marker
    assert np.degrees(angle_between(third, direction(120.0, 42.0))) < 0.02
    assert averaged(SUN, LOW[None], np.ones(1)).light == pytest.approx(SUN.light)


def test_directions_that_were_measured_elsewhere_move_the_light_by_as_much() -> None:
    elsewhere = np.array([direction(120.0, 42.0), direction(120.0, 48.0)])  # as seen from a body in a lamp's light
    moved = averaged(SUN, elsewhere, np.ones(2)).to_light_marker
    assert np.degrees(angle_between(moved, direction(120.0, 43.0))) < 0.01


def test_the_mean_of_directions_far_apart_is_half_way() -> None:
    wide = np.array([LOW, direction(120.0, 60.0)])
    moved = averaged(SUN, wide, np.ones(2)).to_light_marker
    assert np.degrees(angle_between(moved, direction(120.0, 50.0))) < 0.01


def test_near_the_zenith_directions_that_were_measured_elsewhere_move_the_light_the_same_way() -> None:
    """Both by one degree along x, though elsewhere lies at an azimuth that differs by 90 degrees."""
    here, there = np.array([0.04, 0.0, 1.0]), np.array([0.0, 0.04, 1.0])
    along_x = np.array([np.radians(2.0), 0.0, 0.0])
    sun = FittedLight(np.append(here / np.linalg.norm(here), 0.0), np.diag([1e-4, 1e-4]))
    elsewhere = np.array([each / np.linalg.norm(each) for each in (there, there + along_x)])
    moved = averaged(sun, elsewhere, np.ones(2), 1.0)
    assert np.degrees(angle_between(moved.to_light_marker, here + along_x / 2)) < 0.01
    basis = tangent_basis(moved.to_light_marker)
    added = basis.T @ moved.covariance_rad2 @ basis
    assert added[0, 0] == pytest.approx(1e-4 + np.radians(1.0) ** 2, rel=0.01)
    assert added[1, 1] == pytest.approx(1e-4, rel=0.01)


def test_what_directions_differ_by_is_added_to_the_covariance_as_far_as_asked() -> None:
    several, weights = np.array([LOW, HIGH]), np.ones(2)
    assert averaged(SUN, several, weights).covariance_rad2 == pytest.approx(SUN.covariance_rad2)
    added = averaged(SUN, several, weights, 0.5).covariance_rad2 - SUN.covariance_rad2
    between = np.radians(3.0) ** 2  # the variance of two directions 6 degrees apart in elevation
    assert added == pytest.approx(np.diag([0.0, 0.5 * between]), rel=0.01, abs=1e-9)


def test_near_the_zenith_a_covariance_keeps_its_axes_in_space() -> None:
    """Half way between azimuths that are 90 degrees apart, what was east lies between east and up."""
    one, other = direction(0.0, 88.0), direction(90.0, 88.0)
    sun = FittedLight(np.append(one, 0.0), np.diag([1e-4, 9e-4]))
    moved = averaged(sun, np.array([one, other]), np.ones(2))
    assert np.degrees(angle_between(moved.to_light_marker, direction(45.0, 88.6))) < 0.05
    before, after = (
        tangent_basis(each.to_light_marker).T @ each.covariance_rad2 @ tangent_basis(each.to_light_marker)
        for each in (sun, moved)
    )
    assert after[:2, :2] == pytest.approx(before[:2, :2], rel=0.01, abs=1e-6)
