"""What else a picture shows speaks for an explanation only where it is of another body, and of the same light."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import normalised
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import AGREEING_RAD, NO_CONTEXT, Context, are_apart, context_features
from ashe_live.light.ground.glint import Glint
from ashe_live.light.ground.sheet_shadow import SheetShadow
from ashe_live.light.shape.body import LitBody
from tests.light.explanation.judgement.test_judge import explanation
from tests.light.synthetic_masks import direction

NEAR, FAR = direction(204.0, 43.0), direction(240.0, 40.0)


def elsewhere(one: Explanation, by_m: float) -> Explanation:
    """The same explanation of a body that stands so far aside."""
    placed = one.alignment.placed
    frame = replace(placed.lit.body.frame, origin_marker=placed.lit.body.frame.origin_marker + np.array([by_m, 0.0]))
    moved = LitBody(replace(placed.lit.body, frame=frame), placed.lit.lights)
    return replace(one, alignment=replace(one.alignment, placed=replace(placed, lit=moved)))


def glint_towards(to_light: Float, place_m: tuple[float, float] = (0.0, 0.0)) -> Glint:
    return Glint(np.zeros((2, 2), np.bool_), to_light, np.array(place_m))


def agreeing(one: Explanation, context: Context) -> float:
    return context_features(one, context)["agreeing"]


def test_another_body_in_the_same_light_agrees() -> None:
    one, other = explanation(), elsewhere(explanation(to_light=NEAR), 0.5)
    least = min(other.alignment.clear_body, other.alignment.clear_shadow)
    assert agreeing(one, Context([one, other])) == least > 0


def test_of_several_that_agree_the_clearest_counts() -> None:
    one, clear = explanation(), elsewhere(explanation(to_light=NEAR), 0.5)
    faint = replace(clear, alignment=replace(clear.alignment, clear_shadow=0.1))
    counts = agreeing(one, Context([one, clear]))
    assert agreeing(one, Context([one, faint])) == 0.1 < counts
    assert agreeing(one, Context([one, faint, clear])) == counts == agreeing(one, Context([one, clear, faint]))


def ball_at(x: float, radius: float) -> tuple[float, ...]:
    return x, 0.02, radius, radius, radius


@pytest.mark.parametrize("gap_m", [-0.005, 0.005])
def test_bodies_are_apart_where_no_part_of_one_reaches_to_the_other(gap_m: float) -> None:
    ball, middle = Proxy("ball", np.array([ball_at(0.0, 0.03)])), 0.06 + gap_m
    bar = [ball_at(middle - 0.02, 0.01), ball_at(middle, 0.02), ball_at(middle + 0.02, 0.01)]
    three = Proxy("balls", np.array(bar))
    assert are_apart(ball, three) is are_apart(three, ball) is (gap_m > 0)


def test_the_same_body_does_not_nor_one_in_another_light() -> None:
    one = explanation()
    assert agreeing(one, Context([one, explanation(to_light=NEAR)])) == 0
    assert agreeing(one, Context([one, elsewhere(explanation(to_light=FAR), 0.5)])) == 0
    assert agreeing(one, NO_CONTEXT) == 0


def test_a_glint_agrees_as_far_as_an_answer_is_good() -> None:
    one = explanation()
    assert agreeing(one, Context([one], glint_towards(NEAR))) == 1
    assert agreeing(one, Context([one], glint_towards(FAR))) == 0
    assert math.degrees(AGREEING_RAD) == pytest.approx(10)


def test_a_glint_of_a_lamp_agrees_as_the_lamp_is_seen_from_there() -> None:
    (sun,) = (one := explanation()).lights
    lamp_m, place_m = 0.5 * sun.to_light_marker, (0.3, -0.2)
    lamp = replace(one, lights=(replace(sun, light=np.append(sun.to_light_marker, 2.0)),))
    there = normalised(lamp_m - (*place_m, 0.0))
    assert agreeing(lamp, Context([lamp], glint_towards(there, place_m))) == 1
    assert agreeing(one, Context([one], glint_towards(there, place_m))) == 0


def test_the_sheets_shadow_agrees_where_it_points_away_from_the_light() -> None:
    one = explanation(to_light=NEAR)
    away = -0.05 * normalised(NEAR[:2])

    def of_sheet(away: Float) -> float:
        return context_features(one, Context([one], sheet=SheetShadow(away, 0.8)))["sheet"]

    assert of_sheet(away) > 0.5
    assert of_sheet(-away) < -1
    assert context_features(one, NO_CONTEXT)["sheet"] == 0
