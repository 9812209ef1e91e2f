"""The direction at the marker between a sun's and a lamp's, by how likely each is."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Light
from ashe_live.light.lamps.doubt import COMMON_NEARNESS, LOG_NEARNESS_SIGMA, as_lamps_are, with_doubt
from ashe_live.light.lamps.place import Place
from ashe_live.light.shape.directions import displacement_of

FOOT = np.array([0.2, -0.1])  # of the object whose shadow tells the direction there
SUN = Light(np.array([0.5, 0.2, 0.8]), 0.02**2 * np.eye(2), 0.03, 0.9)


def place(nearness: float, sigma: float) -> Place:
    """Of a lamp that the object sees in the sun's direction."""
    seen = np.column_stack([np.eye(2), -FOOT])
    information = seen.T @ seen / 0.02**2
    information[2, 2] += 1 / sigma**2
    at_foot = displacement_of(SUN.to_light_marker)
    return Place(np.array([*(at_foot + nearness * FOOT), nearness]), information)


def off_deg(light: Light, to_light: Float) -> float:
    return math.degrees(angle_between(light.to_light_marker, to_light))


def test_a_sure_sun_stays() -> None:
    found = with_doubt(SUN, place(0.9, 0.3), place(-0.3, 0.2), -20.0)
    assert off_deg(found, SUN.to_light_marker) < 0.05
    assert found.confidence == pytest.approx(SUN.confidence, rel=0.01)


def test_what_is_surely_a_lamp_is_where_the_lamp_is() -> None:
    lamp = place(1.0, 0.1)
    found = with_doubt(SUN, lamp, place(0.9, 0.1), 200.0)
    assert off_deg(SUN, lamp.light[:3]) > 8
    assert off_deg(found, lamp.light[:3]) < 0.3


def test_between_the_two_it_is_as_unsure_as_they_are_apart() -> None:
    lamp = place(1.0, 0.1)
    found = with_doubt(SUN, lamp, place(1.0, 0.1), 9.0)
    apart = angle_between(SUN.to_light_marker, lamp.light[:3])
    for each in (SUN.to_light_marker, lamp.light[:3]):
        assert off_deg(found, each) == pytest.approx(math.degrees(apart) / 2, rel=0.1)
    assert found.covariance_rad2 is not None
    assert np.linalg.eigvalsh(found.covariance_rad2)[1] == pytest.approx((apart / 2) ** 2, rel=0.35)
    assert found.confidence is not None
    assert SUN.confidence is not None
    assert found.confidence < SUN.confidence


@pytest.mark.parametrize("nearness", [-5.0, -0.01, 0.0, 0.05, 12.0])
@pytest.mark.parametrize("sigma", [1e-3, 0.5, 50.0])
@pytest.mark.parametrize("deviance", [-1e6, 0.0, 1e6])
def test_extreme_places_are_finite(nearness: float, sigma: float, deviance: float) -> None:
    found = with_doubt(SUN, place(nearness, sigma), place(nearness, sigma), deviance)
    assert np.isfinite(found.to_light_marker).all()
    assert found.covariance_rad2 is not None
    assert (np.linalg.eigvalsh(found.covariance_rad2) > 0).all()


def test_a_sure_lamp_stays_where_it_is() -> None:
    sure = place(6.0, 0.01)
    found = as_lamps_are(sure)
    np.testing.assert_allclose(found.mean, sure.mean, rtol=1e-3)
    np.testing.assert_allclose(found.covariance, sure.covariance, rtol=1e-2)


def test_of_a_lamp_that_may_be_anywhere_its_object_still_tells_the_ray() -> None:
    """Its nearness is that of lamps in general, and the object sees it where it did."""
    open_one = place(3.0, 1e3)
    found = as_lamps_are(open_one)
    assert found.mean[2] == pytest.approx(COMMON_NEARNESS, rel=1e-3)
    assert found.nearness_sigma == pytest.approx(COMMON_NEARNESS * LOG_NEARNESS_SIGMA, rel=1e-3)
    np.testing.assert_allclose(found.mean[:2] - found.mean[2] * FOOT, open_one.mean[:2] - open_one.mean[2] * FOOT)


@pytest.mark.parametrize("nearness", [1e-3, 0.05, 1.2, 12.0, 20.0])
@pytest.mark.parametrize("sigma", [1e-3, 0.5, 50.0])
def test_what_is_known_of_lamps_lies_between_and_makes_surer(nearness: float, sigma: float) -> None:
    found = as_lamps_are(place(nearness, sigma))
    low, high = sorted((nearness, COMMON_NEARNESS))
    assert low * (1 - 1e-6) <= found.mean[2] <= high * (1 + 1e-6)
    # In logarithms, whose errors are alike on both sides.
    assert found.nearness_sigma / found.mean[2] <= sigma / nearness * (1 + 1e-6)
    assert np.linalg.eigvalsh(found.lamp_covariance).min() > 0
