"""The direction at the marker between a sun's and a lamp's, by how likely each is."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Light
from ashe_live.light.lamps.doubt import with_doubt
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
