"""Bodies moved onto the steps of light in painted pictures."""

import math
from functools import cache

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between, radius_of_68_percent
from ashe_live.light.edges.step_alignment import EdgeFit, aligned_with_steps, step_costs
from ashe_live.light.edges.step_costs import MISSED
from ashe_live.light.edges.steps import LightPicture
from ashe_live.light.explanation.judgement.uncertainty import covariance_of_outlines
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import Body, LitBody
from ashe_live.light.shape.directions import fitted_lights
from ashe_live.light.shape.families import FAMILIES
from tests.light.painted_bodies import body_of
from tests.light.painted_regions import PaintedRegion, painted_region
from tests.light.painted_scenes import BOX, CYLINDER, SHADOW_RATIO, Caster

SHIFTS = np.array([[math.log(SHADOW_RATIO.mean())]])
# Displacement, place and shape, spoilt by about two pixels.
SPOILT = {"shadow longer": (0, 0.04), "shadow aside": (1, -0.04), "moved": (2, 0.03), "moved away": (3, -0.03)}


@cache
def picture_of(here: PaintedRegion) -> LightPicture:
    return LightPicture.of(View.of(here.scene.tracked, 640))


def moved(lit: LitBody, number: int, by: float) -> LitBody:
    step = np.zeros(lit.layout.split + len(lit.body.shape))
    step[number] = by
    return lit.moved(step)


def aligned(here: PaintedRegion, lit: LitBody, views: int = 1) -> EdgeFit:
    (found,) = aligned_with_steps([lit], [picture_of(here)] * views, SHIFTS)
    assert found is not None
    return found


def error_deg(found: EdgeFit, here: PaintedRegion) -> float:
    return math.degrees(angle_between(found.lit.to_lights_marker[0], here.scene.to_light))


@pytest.mark.parametrize("spoilt", SPOILT.values(), ids=SPOILT)
@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", ["plain", "striped", "checkered"])
def test_a_body_that_is_displaced_comes_back(ground: str, caster: Caster, spoilt: tuple[int, float]) -> None:
    here = painted_region(caster, ground=ground)
    found = aligned(here, moved(body_of(here, caster), *spoilt))
    assert error_deg(found, here) < 0.5
    assert found.mean_cost < 3


def test_the_direction_is_known_as_well_as_is_said() -> None:
    for azimuth_deg in (160.0, 200.0, 250.0):
        here = painted_region(BOX, azimuth_deg=azimuth_deg)
        found = aligned(here, body_of(here, BOX))
        (light,) = fitted_lights(found.lit.lights, np.linalg.inv(found.information))
        # With the floor of systematic errors, which all answers get.
        sigma_deg = math.degrees(radius_of_68_percent(covariance_of_outlines(light.covariance_rad2)))
        assert error_deg(found, here) < 2 * sigma_deg
        assert sigma_deg < 1


def test_the_true_family_is_the_likeliest() -> None:
    here = painted_region(BOX)
    truth = body_of(here, BOX)
    tall = Body(truth.body.frame, FAMILIES["frustum"], np.array([0.0, 0, 0, 0.35, 0.35]))
    box, round_one = aligned_with_steps([truth, LitBody(tall, truth.lights)], [picture_of(here)], SHIFTS.repeat(2, 0))
    assert box is not None
    assert round_one is not None
    assert box.criterion < round_one.criterion
    assert box.mean_cost < 0.5 * round_one.mean_cost


def test_a_body_where_nothing_is_misses_its_steps() -> None:
    here = painted_region(BOX)
    nowhere = moved(body_of(here, BOX), 2, 1.5)
    (costs,) = step_costs([nowhere], [picture_of(here)], SHIFTS)
    assert min(costs.body, costs.shadow) > 0.6 * MISSED


def test_only_the_outline_that_is_wrong_misses_its_steps() -> None:
    here = painted_region(BOX)
    truth = body_of(here, BOX)
    right, turned = step_costs([truth, moved(truth, 1, 0.6)], [picture_of(here)], SHIFTS.repeat(2, 0))
    assert turned.body < right.body + 0.1
    assert turned.shadow > right.shadow + 2


def test_a_step_of_another_depth_is_not_the_shadows() -> None:
    here = painted_region(BOX)
    pale, true = (
        step_costs([body_of(here, BOX)], [picture_of(here)], np.array([[depth]]))[0] for depth in (-0.3, SHIFTS[0, 0])
    )
    assert pale.body == true.body
    assert pale.shadow > true.shadow + 1


def test_a_shadow_that_its_body_hides_constrains_nothing() -> None:
    here = painted_region(BOX)
    overhead = LitBody(body_of(here, BOX).body, np.array([(0.0, 0.0, 1.0, 0.0)]))
    (costs,) = step_costs([overhead], [picture_of(here)], SHIFTS)
    assert costs.shadow == MISSED
    assert costs.body < 3


def test_a_picture_seen_twice_has_twice_the_information_and_gives_the_same_place() -> None:
    here = painted_region(CYLINDER)
    start = moved(body_of(here, CYLINDER), 0, 0.05)
    once, twice = (aligned(here, start, views) for views in (1, 2))
    assert twice.count == 2 * once.count
    assert angle_between(once.lit.to_lights_marker[0], twice.lit.to_lights_marker[0]) < math.radians(0.1)
    np.testing.assert_allclose(np.diag(twice.normal)[:2], 2 * np.diag(once.normal)[:2], rtol=0.05)


def test_what_is_out_of_view_is_none_and_spoils_no_other() -> None:
    here = painted_region(BOX)
    truth = body_of(here, BOX)
    behind = LitBody(Body(truth.body.frame, truth.body.family, truth.body.shape + np.eye(6)[0] * 1e4), truth.lights)
    alone, (lost, beside) = (
        aligned(here, truth),
        aligned_with_steps([behind, truth], [picture_of(here)], SHIFTS.repeat(2, 0)),
    )
    assert lost is None
    assert beside is not None
    assert angle_between(beside.lit.to_lights_marker[0], alone.lit.to_lights_marker[0]) < 1e-3


@pytest.mark.parametrize("light", [(1e-6, 0, 1.0, 0), (5.0, 0, 1.0, 0), (0, 0, 1.0, 0), (0.5, 0.2, 1.0, 3.0)])
def test_no_light_makes_numbers_that_are_none(light: tuple[float, ...]) -> None:
    here = painted_region(BOX)
    lit = LitBody(body_of(here, BOX).body, np.array([light], dtype=np.float64))
    for found in aligned_with_steps([lit], [picture_of(here)], SHIFTS):
        if found is not None:
            values: list[Float] = [found.normal, found.lit.lights, np.array([found.cost, found.criterion])]
            assert all(np.isfinite(each).all() for each in values)
