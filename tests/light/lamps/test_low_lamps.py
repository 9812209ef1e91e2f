"""Lamps lower than an object, told by the spot that they make on painted ground."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.ground.gloss import Gloss
from ashe_live.light.lamps.fall.low_lamps import low_lamp_elsewhere
from tests.light.lamps.test_fall_off import fall_off, parameters

TOP_M = 0.08
ELSEWHERE = np.array([[0.0, 0.0, 0.0], [0.9, -0.4, 0.0], [-1.0, -0.5, 2.5], [0.8, 0.6, 5.5]])
LOW = {"beside the marker": (-0.06, -0.03, 0.06), "at its border": (0.15, -0.1, 0.05)}


def lights_of(*lamps_m: tuple[float, ...]) -> Float:
    return np.vstack([ELSEWHERE, *(parameters(each) for each in lamps_m)])


@pytest.mark.parametrize("ground", ["plain", "bricks"])
@pytest.mark.parametrize("lamp_m", LOW.values(), ids=LOW)
def test_a_low_lamp_is_seen_where_no_light_is_stated(ground: str, lamp_m: tuple[float, ...]) -> None:
    of = fall_off(ground, lamp_m)
    assert low_lamp_elsewhere(of, TOP_M, ELSEWHERE)
    assert not low_lamp_elsewhere(of, TOP_M, lights_of(lamp_m))


@pytest.mark.parametrize("gloss", [None, Gloss(0.3, 0.08), Gloss(0.8, 0.3)])
def test_it_is_seen_whether_the_ground_may_be_glossy_or_not(gloss: Gloss | None) -> None:
    of = fall_off("checkered", (0.15, -0.1, 0.05))
    assert low_lamp_elsewhere(replace(of, gloss=gloss), TOP_M, ELSEWHERE)


@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
@pytest.mark.parametrize("lamp_m", [(0.3, -0.2, 0.4), (0.0, 0.0, 0.3), (-0.3, 0.2, 0.2)])
def test_a_right_explanation_stays(ground: str, lamp_m: tuple[float, ...]) -> None:
    assert not low_lamp_elsewhere(fall_off(ground, lamp_m), TOP_M, lights_of(lamp_m))


@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
def test_a_sun_makes_no_spot(ground: str) -> None:
    """Whatever the explanation: it may be wrong, but not for this reason."""
    assert not low_lamp_elsewhere(fall_off(ground), TOP_M, ELSEWHERE)


def test_a_lamp_above_the_top_whose_light_any_lamp_explains_as_well_is_none() -> None:
    assert not low_lamp_elsewhere(fall_off("checkered", (0.1, -0.05, 0.1)), TOP_M, ELSEWHERE)


def test_a_lamp_above_a_flat_object_is_none() -> None:
    assert not low_lamp_elsewhere(fall_off("plain", LOW["beside the marker"]), 0.01, ELSEWHERE)


@pytest.mark.parametrize("lamp_m", LOW.values(), ids=LOW)
def test_an_explanation_that_is_surer_than_the_ground_stays(lamp_m: tuple[float, ...]) -> None:
    of = fall_off("plain", lamp_m)
    assert low_lamp_elsewhere(of, TOP_M, ELSEWHERE, log_odds=-5.0)
    assert not low_lamp_elsewhere(of, TOP_M, ELSEWHERE, log_odds=1e3)


def test_a_pale_blot_of_paint_is_no_lamp() -> None:
    """By 6 %: among so many places there is always one where such a spot may be by chance."""
    of = fall_off("plain")
    away = np.linalg.norm(of.samples.places - (0.0035, 0.135), axis=1)
    blot = replace(of.samples, brightness=of.samples.brightness + 0.06 * np.exp(-0.5 * (away / 0.06) ** 2))
    assert not low_lamp_elsewhere(replace(of, samples=blot), TOP_M, ELSEWHERE)
