"""Lights as homogeneous points: suns and lamps throw shadows by one law."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.shape.layout import Layout, light_parameters
from ashe_live.light.shape.light_points import at_infinity, cast_on_ground, shadow_projection, towards
from tests.light.synthetic_masks import direction

POINTS = np.array([(0.1, -0.2, 0.0), (0.3, 0.1, 0.05), (-0.2, 0.0, 0.3)])
LAMP = np.array([0.5, -0.4, 0.9, 1.0])
SUN = at_infinity(direction(70.0, 35.0))


@pytest.mark.parametrize("light", [LAMP, 3 * LAMP, SUN], ids=["lamp", "the same lamp", "sun"])
def test_a_shadow_lies_on_the_ground_in_line_with_its_point_and_the_light(light: Float) -> None:
    shadows = cast_on_ground(POINTS, light)
    assert shadows is not None
    np.testing.assert_allclose(shadows[:, 2], 0, atol=1e-15)
    for point, shadow in zip(POINTS, shadows, strict=True):
        np.testing.assert_allclose(np.cross(towards(light, point), point - shadow), 0, atol=1e-12)


@pytest.mark.parametrize("light", [LAMP, SUN], ids=["lamp", "sun"])
def test_casting_is_the_projection(light: Float) -> None:
    images = np.column_stack([POINTS, np.ones(3)]) @ shadow_projection(light).T
    np.testing.assert_allclose(images[:, :3] / images[:, 3:], cast_on_ground(POINTS, light), atol=1e-12)


def test_a_lamp_far_away_is_a_sun() -> None:
    far = np.append(1e9 * SUN[:3], 1.0)
    np.testing.assert_allclose(cast_on_ground(POINTS, far), cast_on_ground(POINTS, SUN), atol=1e-8)


@pytest.mark.parametrize("light", [(1, 0, 0, 0), (0, 0.6, -0.8, 0), (0.1, 0.1, 0.2, 1)], ids=["along", "below", "low"])
def test_a_shadow_without_an_end_is_none(light: tuple[float, ...]) -> None:
    assert cast_on_ground(POINTS, np.array(light, float)) is None


def test_theta_holds_the_lights_first_and_gives_them_back() -> None:
    lights = at_infinity(np.array([direction(20.0, 50.0), direction(200.0, 10.0)]))
    layout, shape = Layout(2), np.array([1.0, 2.0, 3.0])
    theta = layout.theta(lights, shape)
    assert len(theta) == layout.split + len(shape)
    np.testing.assert_array_equal(layout.shape_of(theta), shape)
    np.testing.assert_allclose(layout.lights_of(theta), lights / lights[:, 2:3])
    for i in range(2):
        np.testing.assert_array_equal(theta[layout.light(i)], light_parameters(lights)[i])
