"""Lights as homogeneous points: suns and lamps throw shadows by one law."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.shape.layout import ParameterLayout, light_parameters, nearness_of
from ashe_live.light.shape.light_points import (
    at_infinity,
    cast_on_ground,
    relative_distances,
    relative_irradiance,
    shadow_projection,
    towards,
)
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


def test_a_sun_is_as_far_from_everywhere_and_a_lamp_as_far_as_it_is() -> None:
    np.testing.assert_array_equal(relative_distances(SUN, POINTS, np.zeros(3)), 1)
    distances = np.linalg.norm(LAMP[:3] - POINTS, axis=1) / np.linalg.norm(LAMP[:3])
    np.testing.assert_allclose(relative_distances(3 * LAMP, POINTS, np.zeros(3)), distances)


@pytest.mark.parametrize("light", [LAMP, SUN], ids=["lamp", "sun"])
def test_what_faces_the_light_where_it_is_measured_receives_one_and_what_faces_away_nothing(light: Float) -> None:
    here = POINTS[1]
    normals = np.array([towards(light, here), -towards(light, here)])
    np.testing.assert_allclose(relative_irradiance(light, here[None].repeat(2, axis=0), normals, here), [1, 0])


def test_a_lamps_light_falls_with_the_square_of_the_distance_and_the_cosine() -> None:
    to_lamp = towards(LAMP, np.zeros(3))
    halfway = LAMP[:3] / 2
    aside = np.cross(to_lamp, (0, 0, 1.0))
    oblique = np.cos(1.0) * to_lamp + np.sin(1.0) * aside / np.linalg.norm(aside)
    found = relative_irradiance(LAMP, np.array([halfway, halfway]), np.array([to_lamp, oblique]), np.zeros(3))
    np.testing.assert_allclose(found, [4, 4 * np.cos(1.0)])


def test_a_lamp_far_away_gives_light_like_a_sun() -> None:
    normals = np.array([(0, 0, 1.0), (1.0, 0, 0), (0.6, 0.8, 0)])
    far = np.append(1e6 * SUN[:3], 1.0)
    of_lamp, of_sun = (relative_irradiance(light, POINTS, normals, np.zeros(3)) for light in (far, SUN))
    np.testing.assert_allclose(of_lamp, of_sun, atol=1e-5)


@pytest.mark.parametrize("light", [(1, 0, 0, 0), (0, 0.6, -0.8, 0), (0.1, 0.1, 0.2, 1)], ids=["along", "below", "low"])
def test_a_shadow_without_an_end_is_none(light: tuple[float, ...]) -> None:
    assert cast_on_ground(POINTS, np.array(light, float)) is None


def test_theta_holds_the_lights_first_and_gives_them_back() -> None:
    lights = at_infinity(np.array([direction(20.0, 50.0), direction(200.0, 10.0)]))
    layout, shape = ParameterLayout(2), np.array([1.0, 2.0, 3.0])
    theta = layout.theta(lights, shape)
    assert len(theta) == layout.split + len(shape)
    np.testing.assert_array_equal(layout.shape_of(theta), shape)
    np.testing.assert_allclose(layout.lights_of(theta), lights / lights[:, 2:3])
    lamps = np.array([LAMP, 2 * LAMP])
    there = layout.lights_of(layout.theta(lamps, shape), nearness_of(lamps))
    np.testing.assert_allclose(there, lamps / lamps[:, 2:3])
    for i in range(2):
        np.testing.assert_array_equal(theta[layout.light(i)], light_parameters(lights)[i])
    near = ParameterLayout(2, with_nearness=True)
    theta = near.theta(lamps, shape)
    np.testing.assert_array_equal(near.shape_of(theta), shape)
    np.testing.assert_allclose(near.lights_of(theta), lamps / lamps[:, 2:3])
    assert theta[near.light(1)][2] == nearness_of(lamps)[1]
