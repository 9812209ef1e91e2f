"""Irradiances from the shadows' ratios: on level ground they make what is there, and nothing gets less than nothing."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.render.lights.lighting import (
    ASSUMED_SHADOW_RATIO,
    GROUND_ALBEDO,
    LAMP_RADIUS_M,
    LEAST_REST,
    MAX_ALBEDO,
    MAX_LIGHTS,
    MIN_BALANCED_SINE,
    SUN_ANGULAR_SIZE_RAD,
    Lighting,
    angular_size,
    ground_ratio,
    lighting_of,
)

RATIO = np.array([0.7, 0.8, 0.9])


def light(azimuth: float, elevation: float = 0.8, ratio: Float | None = RATIO, **more: object) -> Light:
    return Light(direction_from_angles(azimuth, elevation), shadow_rgb_ratio=ratio, **more)


def on_level_ground(lighting: Lighting) -> Float:
    """(3,) by the cosine of each light, and the sky's."""
    sines = np.array([each.to_light[2] for each in lighting.lights])
    return np.array(lighting.sky) + sines @ lighting.irradiances


LAMP = light(1.0, ratio=None, inverse_distance=2.0, intensity_rgb_ratio=np.array([0.5, 1.0, 2.0]))
SEVERAL = {
    "one": (light(0.0),),
    "two": (light(0.0), light(2.0, 0.3)),
    "nobody measured": (light(0.0, ratio=None),) * 3,
    "contradict each other": (light(0.0, ratio=0.1 * RATIO),) * 2,
    "lamp": (LAMP,),
}


@pytest.mark.parametrize("ambient", [None, np.array([0.2, 0.5, 1.4])])
@pytest.mark.parametrize("name", SEVERAL)
def test_sky_and_lights_make_the_light_of_level_ground(name: str, ambient: Float | None) -> None:
    lighting = lighting_of(SEVERAL[name], ambient)
    np.testing.assert_allclose(np.array(lighting.sky) + lighting.ground_shares.sum(axis=0), 1)
    np.testing.assert_allclose(on_level_ground(lighting), 1)
    assert (lighting.ground_shares >= 0).all()
    assert min(lighting.sky) > 0


def test_shadows_that_each_claim_most_of_the_light_leave_some_where_both_fall() -> None:
    np.testing.assert_allclose(lighting_of(SEVERAL["contradict each other"]).sky, LEAST_REST * (0.1 * RATIO) ** 2)


def test_a_ratio_is_what_the_shadow_leaves_and_an_ambient_light_that_was_measured_precedes_it() -> None:
    first, second = light(0.0), light(2.0, ratio=1 - (1 - RATIO) / 2)
    by_ratios, by_ambient = lighting_of((first, second)), lighting_of((first, second), np.full(3, 0.1))
    np.testing.assert_allclose(by_ratios.ground_shares, [1 - RATIO, (1 - RATIO) / 2])
    np.testing.assert_allclose(by_ambient.sky, 0.1)
    np.testing.assert_allclose(by_ambient.ground_shares, [np.full(3, 0.6), np.full(3, 0.3)])


def test_a_shadow_that_is_brighter_than_the_ground_around_it_is_of_no_light() -> None:
    lighting = lighting_of((light(0.0, ratio=np.array([1.2, -0.1, 0.5])),))  # and what is below black is black
    np.testing.assert_allclose(lighting.ground_shares, [(0.0, 1.0, 0.5)])


def test_a_share_that_was_measured_at_the_marker_precedes_what_was_measured_in_the_shadow() -> None:
    lighting = lighting_of((LAMP,), np.full(3, 0.1))
    np.testing.assert_allclose(lighting.ground_shares[0] / lighting.sky, (0.5, 1.0, 2.0))


def test_a_light_without_a_share_in_a_colour_leaves_it_to_the_sky() -> None:
    lighting = lighting_of((light(0.0, ratio=np.array([1.0, 0.5, 0.5])),), np.full(3, 0.4))
    np.testing.assert_allclose(lighting.sky, (1.0, 0.4, 0.4))
    np.testing.assert_allclose(lighting.ground_shares, [(0.0, 0.6, 0.6)])


def test_what_is_below_the_horizon_gives_nothing_and_no_light_is_invented() -> None:
    below = light(1.0, -0.4)
    (above,) = lighting_of((below, light(0.0))).lights
    assert above.ground_share == pytest.approx(1 - RATIO)
    for none in ((), (below,), (light(1.0, 0.0),)):
        assert lighting_of(none, np.full(3, 0.3)).lights == ()
        assert lighting_of(none, np.full(3, 0.3)).sky == (1.0, 1.0, 1.0)
    many = tuple(light(0.1 * number) for number in range(MAX_LIGHTS + 2))
    shown = lighting_of(many).lights
    assert len(shown) == MAX_LIGHTS
    assert all((one.to_light == of.to_light_marker).all() for one, of in zip(shown, many, strict=False))


def test_a_light_near_the_horizon_is_not_raised_beyond_bounds_to_make_its_share() -> None:
    low = lighting_of((light(0.0, math.asin(MIN_BALANCED_SINE) / 4),))
    np.testing.assert_allclose(low.irradiances, low.ground_shares / MIN_BALANCED_SINE)
    assert (on_level_ground(low) < 1).all()


@pytest.mark.parametrize(
    ("albedo", "expected"),
    [
        (np.array([0.2, 0.5, 0.7]), (0.2, 0.5, 0.7)),
        (np.array([0.2, 0.5, 3.0]), (0.2, 0.5, MAX_ALBEDO)),
        (None, (GROUND_ALBEDO,) * 3),
    ],
)
def test_from_below_comes_the_grounds_light_in_its_own_colour(albedo: Float | None, expected: tuple) -> None:
    for lights in ((), (light(0.0),)):
        np.testing.assert_allclose(lighting_of(lights, ground_albedo=albedo).bounce, expected)


@pytest.mark.parametrize("steepness", [0.1, 1.0, 20.0])
def test_no_wall_gets_less_than_nothing_of_a_sky_that_leans(steepness: float) -> None:
    assert not lighting_of(()).sky_slope.any()
    slope = steepness * np.array([[0.2, 0.1, 0.0], [-0.2, 0.3, 0.1]])
    for lighting in (lighting_of((), sky_slope_rgb=slope), lighting_of((light(0.0),), sky_slope_rgb=slope)):
        turns = np.linspace(0, 2 * np.pi, 90)
        walls = 0.5 * np.array(lighting.sky) + np.column_stack([np.cos(turns), np.sin(turns)]) @ lighting.sky_slope
        assert walls.min() > -1e-12
        # It leans where it leaned, as far as it may.
        leans, lent = np.linalg.norm(lighting.sky_slope, axis=0), np.linalg.norm(slope, axis=0)
        np.testing.assert_allclose(leans, np.minimum(lent, 0.5 * np.array(lighting.sky)))
        np.testing.assert_allclose(lighting.sky_slope / leans, slope / lent)


@pytest.mark.parametrize("height_m", [0.0, 0.1])
def test_a_lamps_light_falls_by_the_square_of_the_distance_and_the_cosine(height_m: float) -> None:
    lighting = lighting_of((LAMP, light(2.0)))
    lamp, sun = lighting.lights
    ground = np.array([(0.0, 0.0), (0.2, -0.1), (-0.3, 0.4)])
    away = lamp.to_light / lamp.inverse_distance - np.column_stack([ground, np.full(3, height_m)])
    irradiance = away[:, 2] / np.linalg.norm(away, axis=1) ** 3
    expected = irradiance / (lamp.to_light[2] * lamp.inverse_distance**2)
    np.testing.assert_allclose(lamp.ground_falloff(ground, height_m), expected)
    np.testing.assert_allclose(sun.ground_falloff(ground, height_m), 1)
    level = 1 + np.outer(expected - 1, lamp.ground_share)
    np.testing.assert_allclose(lighting.level_at(ground, height_m), level)
    assert lighting.constants == {"lights": 2, "lamps": 1}
    assert lighting_of((light(2.0),)).constants == {"lights": 1, "lamps": 0}


def test_ground_above_a_lamp_gets_none_of_its_light() -> None:
    (lamp,) = lighting_of((LAMP,)).lights
    np.testing.assert_array_equal(lamp.ground_falloff(np.zeros((1, 2)), 1.0), 0)
    assert np.isfinite(lamp.ground_falloff(0.5 * lamp.to_light[None, :2], 0.5 * lamp.to_light[2])).all()


def test_a_size_is_as_it_was_measured_and_else_a_plausible_one() -> None:
    assert angular_size(light(0.0)) == SUN_ANGULAR_SIZE_RAD
    assert angular_size(light(0.0, angular_size_rad=0.1)) == 0.1
    (sun,) = lighting_of((light(0.0, angular_size_rad=0.1),)).lights
    assert sun.tan_half_size == pytest.approx(math.tan(0.05))
    for distance_m in (0.3, 2.0):
        near = {"inverse_distance": 1 / distance_m}
        assert angular_size(light(0.0, angular_size_rad=0.1, **near)) == 0.1
        assert math.tan(angular_size(light(0.0, **near)) / 2) * distance_m == pytest.approx(LAMP_RADIUS_M)
        assert math.tan(angular_size(light(0.0, radius_m=0.1, **near)) / 2) * distance_m == pytest.approx(0.1)


def test_lights_that_nobody_measured_take_together_what_one_would() -> None:
    for count in (1, 2, 3):
        assert count * (1 - ground_ratio(light(0.0, ratio=None), count)) == pytest.approx(1 - ASSUMED_SHADOW_RATIO)
    np.testing.assert_allclose(ground_ratio(LAMP), 1 / np.array([1.5, 2.0, 3.0]))
