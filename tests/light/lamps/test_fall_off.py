"""The fall of light over painted ground: right slopes, right lamps, and suns that are none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.gloss import Gloss, mirrored_and_slopes
from ashe_live.light.ground.lit_ground import fit_lit_ground
from ashe_live.light.ground.slow_shading import log_irradiance
from ashe_live.light.lamps.fall.fall_directions import PRIOR_NEARNESSES, UNEVEN_DEVIANCE, FallDirections
from ashe_live.light.lamps.fall.fall_off import FallOff
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import SHADOW_RATIO, paint

FOOT = np.array([0.1, 0.02])
SHARE = float(1 - SHADOW_RATIO.mean())
PLACES = np.random.default_rng(3).uniform(-0.3, 0.3, (40, 2))
LAMPS = {
    "beside": (0.3, -0.2, 0.4),
    "overhead": (0.0, 0.0, 0.45),
    "low": (0.5, 0.3, 0.12),
    "behind the camera": (0.08, -1.0, 0.8),
}


@cache
def fall_off(ground: str = "plain", lamp_m: tuple[float, ...] | None = None) -> FallOff:
    scene = paint(ground=ground, lamp_m=None if lamp_m is None else np.array(lamp_m))
    view = View.of(scene.tracked, BALANCED.coarse_width_px)
    lit = fit_lit_ground(view.image_bgr, view.is_ground, BALANCED.ground)
    assert lit is not None
    found = FallOff.of(view, lit, np.ones(view.is_ground.shape, np.bool_))
    assert found is not None
    return found


def parameters(lamp_m: tuple[float, ...]) -> Float:
    return np.array([[lamp_m[0] / lamp_m[2], lamp_m[1] / lamp_m[2], 1 / lamp_m[2]]])


def test_irradiance_is_that_of_a_lamp() -> None:
    """By the inverse square and the cosine, with what is no lamp's the same everywhere."""
    lamp = np.array([0.3, -0.2, 0.4])
    there = np.column_stack([np.vstack([PLACES, FOOT]), np.zeros(41)])
    away = lamp - there
    irradiance = away[:, 2] / np.linalg.norm(away, axis=1) ** 3
    expected = np.log(0.3 + 0.7 * irradiance[:40] / irradiance[40])
    found, _ = log_irradiance(PLACES, parameters((0.3, -0.2, 0.4)), [0.7], FOOT)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_sun_lights_all_places_alike() -> None:
    found, _ = log_irradiance(PLACES, np.array([[1.2, -0.4, 0.0]]), [0.7], FOOT)
    np.testing.assert_allclose(found, 0, atol=1e-12)


def test_slopes_are_exact() -> None:
    lights, shares = np.array([[0.5, -0.3, 1.8], [-0.9, 0.2, 0.7]]), [0.5, 0.2]
    _, slopes = log_irradiance(PLACES, lights, shares, FOOT)
    for i in range(3):
        step = np.zeros((2, 3))
        step[0, i] = 1e-6
        ahead, behind = (log_irradiance(PLACES, lights + sign * step, shares, FOOT)[0] for sign in (1, -1))
        np.testing.assert_allclose(slopes[:, i], (ahead - behind) / 2e-6, atol=1e-7)


def test_slopes_with_gloss_are_exact() -> None:
    eye, light, gloss = np.array([0.1, -0.5, 0.4]), np.array([[0.5, -0.3, 1.8]]), Gloss(0.3, 0.1)
    _, slopes = log_irradiance(PLACES, light, [0.7], FOOT, mirrored_and_slopes(PLACES, eye, light, gloss))

    def lit_by(light: Float) -> Float:
        return log_irradiance(PLACES, light, [0.7], FOOT, mirrored_and_slopes(PLACES, eye, light, gloss))[0]

    for i in range(3):
        step = 1e-5 * np.eye(3)[i]
        expected = (lit_by(light + step) - lit_by(light - step)) / 2e-5
        np.testing.assert_allclose(slopes[:, i], expected, atol=1e-3)


@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
@pytest.mark.parametrize("lamp_m", LAMPS.values(), ids=LAMPS)
def test_of_suns_and_lamps_the_true_one_costs_least(ground: str, lamp_m: tuple[float, ...]) -> None:
    """Along the nearnesses of lights in the true direction at the object."""
    of = fall_off(ground, lamp_m)
    at_foot = (np.array(lamp_m[:2]) - FOOT) / lamp_m[2]
    nearness = np.array([0.0, 0.3, 0.6, 1, 1.5]) / lamp_m[2]
    costs = [of.pull(np.array([[*(at_foot + k * FOOT), k]]), [SHARE], FOOT).cost for k in nearness]
    assert min(costs) < costs[0] - 9
    assert int(np.argmin(costs)) in (2, 3, 4)


@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
def test_a_sun_pulls_to_no_lamp(ground: str) -> None:
    pull = fall_off(ground).pull(np.array([[0.9, -0.3, 0.0]]), [SHARE], FOOT)
    sigma = 1 / np.sqrt(pull.information[2, 2])
    # The painted ground itself darkens slowly towards one side, by a quarter over the picture.
    assert abs(pull.gradient[2]) * sigma < 3


@pytest.mark.parametrize("light", [(0, 0, 12), (0, 0, -0.01), (60, -20, 0.5), (0.3, 0.1, 12), (1.0, 0.5, 0.05)])
@pytest.mark.parametrize("lamp_m", [None, *LAMPS.values()])
def test_pulls_are_finite_everywhere(light: tuple[float, ...], lamp_m: tuple[float, ...] | None) -> None:
    pull = fall_off("plain", lamp_m).pull(np.array([light], dtype=np.float64), [0.98], FOOT)
    assert np.isfinite(pull.cost)
    assert np.isfinite(pull.gradient).all()
    assert (np.linalg.eigvalsh(pull.information) > -1e-6 * np.trace(pull.information)).all()


def with_a_strip(lamp_m: tuple[float, ...] | None = None, floor: float = 1.0) -> FallOff:
    """Of plain ground that a strip divides, unlit as a table's end; beyond it lies ground of another albedo."""
    scene = paint(lamp_m=None if lamp_m is None else np.array(lamp_m))
    view = View.of(scene.tracked, BALANCED.coarse_width_px)
    end = view.size[1] // 3
    image = view.image_bgr.copy()
    image[:end] = np.rint(image[:end] * floor ** (1 / 2.2))
    lit = fit_lit_ground(image, view.is_ground, BALANCED.ground)
    assert lit is not None
    free = np.ones(view.is_ground.shape, np.bool_)
    free[end - 5 : end + 5] = False
    found = FallOff.of(replace(view, image_bgr=image), lit, free)
    assert found is not None
    return found


@pytest.mark.parametrize("floor", [0.4, 0.7, 1.5])
def test_a_darker_or_paler_floor_behind_a_table_is_no_fall_of_light(floor: float) -> None:
    _, deviance = FallDirections(with_a_strip(floor=floor)).likeliest
    assert deviance < UNEVEN_DEVIANCE


@pytest.mark.parametrize("floor", [0.4, 1.0, 1.5])
def test_a_lamp_is_located_on_either_side_of_a_strip(floor: float) -> None:
    lamp_m = LAMPS["beside"]
    at_foot = (np.array(lamp_m[:2]) - FOOT) / lamp_m[2]
    nearness = np.array([0.0, 0.5, 1, 2]) / lamp_m[2]
    lamps = np.array([[*(at_foot + k * FOOT), k] for k in nearness])
    costs = with_a_strip(lamp_m, floor).worst_costs(lamps, SHARE, FOOT)
    assert int(np.argmin(costs)) == 2
    assert costs[2] < costs[0] - UNEVEN_DEVIANCE


def test_too_little_lit_ground_constrains_nothing() -> None:
    scene = paint()
    view = View.of(scene.tracked, BALANCED.coarse_width_px)
    lit = fit_lit_ground(view.image_bgr, view.is_ground, BALANCED.ground)
    assert lit is not None
    assert FallOff.of(view, lit, np.zeros(view.is_ground.shape, np.bool_)) is None


def test_many_lights_cost_together_what_each_costs_alone() -> None:
    of, lights = fall_off("bricks", LAMPS["beside"]), np.random.default_rng(5).normal(size=(20, 3))
    each = [of.pull(one[None], [SHARE], FOOT).worst_cost for one in lights]
    np.testing.assert_allclose(of.worst_costs(lights, SHARE, FOOT), each, rtol=1e-6)


def displacements(towards_m: tuple[float, ...]) -> Float:
    """Of a sun and lamps in the direction that the object sees."""
    at_foot = (np.array(towards_m[:2]) - FOOT) / towards_m[2]
    return np.array([at_foot + k * FOOT for k in (0.0, *PRIOR_NEARNESSES)])


@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_the_fall_of_light_excludes_where_a_lamp_is_not(ground: str) -> None:
    x, y, z = LAMPS["beside"]
    directions = FallDirections(fall_off(ground, (x, y, z)))
    there, opposite = (directions.log_ratio(displacements(at)) for at in ((x, y, z), (-x, -y, z)))
    assert there > 0.5
    assert opposite < -2


def test_under_a_sun_the_fall_of_light_constrains_no_direction() -> None:
    assert FallDirections(fall_off("bricks")).log_ratio(displacements(LAMPS["beside"])) == 0
