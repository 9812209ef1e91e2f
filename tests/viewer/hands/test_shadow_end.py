"""The end of a model's shadow, and the light that casts it there, are inverse of each other."""

import math

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.viewer.hands.shadow_end import LEAST_ABOVE_MODEL, LOWEST_RAD, light_through, shadow_of

FOOT, HEIGHT = np.array([0.02, -0.03]), 0.1
TOP = np.array([*FOOT, HEIGHT])


@pytest.mark.parametrize("inverse_distance", [0.0, 0.5, 3.0])
@pytest.mark.parametrize("end", [(0.02, -0.03), (0.1, 0.05), (-0.2, -0.1), (0.0, 0.3)])
def test_light_top_and_shadow_are_on_one_line(end: tuple[float, float], inverse_distance: float) -> None:
    towards = light_through(np.array(end), FOOT, HEIGHT, inverse_distance)
    assert towards is not None
    assert np.linalg.norm(towards) == pytest.approx(1)
    ground = np.array([*end, 0.0])
    to_light = towards - inverse_distance * ground  # times the distance: the lamp seen from the shadow's end
    np.testing.assert_allclose(np.cross(to_light, TOP - ground), 0, atol=1e-12)
    light = Light(towards, inverse_distance=inverse_distance)
    np.testing.assert_allclose(shadow_of(light, FOOT, HEIGHT), end, atol=1e-12)


def test_a_sun_stops_at_its_lowest_in_the_direction_that_is_asked_for() -> None:
    for length in (2.0, 50.0):
        towards = light_through(FOOT + np.array([0.6, -0.8]) * length, FOOT, HEIGHT, 0.0)
        assert towards is not None
        assert math.asin(towards[2]) == pytest.approx(LOWEST_RAD)
        np.testing.assert_allclose(towards[:2] / np.linalg.norm(towards[:2]), (-0.6, 0.8))


def test_a_lamp_is_nowhere_where_it_would_be_too_low_or_too_near() -> None:
    near = 4.0
    assert light_through(FOOT + np.array([20.0, 0.0]), FOOT, HEIGHT, near) is None
    reached = [light_through(FOOT + np.array([length, 0.0]), FOOT, HEIGHT, near) for length in np.linspace(0, 20, 400)]
    found = [towards for towards in reached if towards is not None]
    # As far as it goes it is above the model's top, by a little more than nothing.
    heights = [float(towards[2]) / near for towards in found]
    assert 0 < len(found) < len(reached)
    assert min(heights) >= LEAST_ABOVE_MODEL * HEIGHT
    assert min(heights) < 1.1 * LEAST_ABOVE_MODEL * HEIGHT


def test_a_light_that_is_not_above_the_top_casts_no_shadow_of_it() -> None:
    for height, has_shadow in ((0.09, False), (0.11, True)):
        lamp = np.array([0.3, 0.1, height])
        distance = float(np.linalg.norm(lamp))
        assert (shadow_of(Light(lamp, inverse_distance=1 / distance), FOOT, HEIGHT) is not None) is has_shadow
    assert shadow_of(Light((1.0, 0.0, -0.1)), FOOT, HEIGHT) is None
