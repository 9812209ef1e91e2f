"""Estimates from several views of one scene."""

import dataclasses
import math
from functools import cache

import numpy as np
import pytest

from ashe_live.bench.light.takes import FALL
from ashe_live.core.light import Illumination, Light, LightEstimate, StageClock
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators import proxy
from ashe_live.light.estimators.looking import Look, looked, looked_alone
from ashe_live.light.estimators.preset import BALANCED, FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.together import without_alike
from ashe_live.light.estimators.view_search import Trace, ViewSearch
from ashe_live.light.explanation.judgement.judge import SETTLED, fitted_judge
from ashe_live.light.lamps.sources import SeenObject
from ashe_live.light.pixels.view import View
from ashe_live.light.views.agreeing_views import without_confirming
from ashe_live.light.views.joint.aligned import in_each_view
from tests.light.painted_scenes import BOX, CYLINDER, Caster, paint
from tests.light.painted_views import painted_from
from tests.light.synthetic_masks import direction

STICKER = Caster("cylinder", (0.12, -0.07), 0.07, 1e-4, (0.03, 0.03, 0.035))


@cache
def seen_from(heading_deg: float, *casters: Caster, ground: str = "plain", index: int = 0, **rest) -> TrackedFrame:
    tracked = painted_from(heading_deg, *casters, ground=ground, seed=index, **rest).tracked
    return dataclasses.replace(tracked, frame=Frame(tracked.frame.image_bgr, index, 0.0))


def views_of(
    *casters: Caster, ground: str = "plain", headings: tuple[float, ...] = (90, 75, 105)
) -> list[TrackedFrame]:
    return [seen_from(heading, *casters, ground=ground, index=i) for i, heading in enumerate(headings)]


@pytest.fixture(scope="module")
def on_bricks() -> LightEstimate:
    """Of the box on bricks, from three sides."""
    first, *others = views_of(BOX, ground="bricks")
    return ProxyEstimator(FAST).estimate(first, others)


def test_several_views_give_the_light(on_bricks: LightEstimate) -> None:
    estimate = on_bricks
    assert estimate.light is not None, estimate.reason
    assert math.degrees(angle_between(estimate.light.to_light_marker, direction(200, 40))) < 1.0
    assert estimate.views[0] == 0
    assert set(estimate.views) == {0, 1, 2}
    # 45 degrees above the ground, 30 apart around it.
    assert estimate.span_rad == pytest.approx(math.acos(0.5 + 0.5 * math.cos(math.radians(30))), abs=0.02)


@pytest.mark.parametrize(("casters", "ground"), [((BOX,), "plain"), ((CYLINDER,), "bricks"), ((BOX, STICKER), "plain")])
def test_more_views_never_lower_the_confidence_of_a_right_answer(casters: tuple[Caster, ...], ground: str) -> None:
    first, *others = views_of(*casters, ground=ground, headings=(90, 75, 105, 82, 98))
    sure = 0.0
    for count in (0, 1, 4):
        light = ProxyEstimator(FAST).estimate(first, others[:count]).light
        confidence = 0.0 if light is None else light.confidence
        assert confidence > sure - FALL
        if light is not None and math.degrees(angle_between(light.to_light_marker, direction(200, 40))) < 10:
            sure = max(sure, confidence)
    assert sure > 0.5
    # The sticker, as dark as the shadow that it touches, is then neither object nor shadow.
    assert math.degrees(angle_between(light.to_light_marker, direction(200, 40))) < 2


def test_where_the_first_view_leaves_no_doubt_no_other_is_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    searched, rough = [], ViewSearch.rough

    def counted(search: ViewSearch):
        searched.append(search.view.index)
        return rough(search)

    monkeypatch.setattr(ViewSearch, "rough", counted)
    first, *others = views_of(BOX)
    estimate = ProxyEstimator(BALANCED).estimate(first, others)
    assert estimate.light is not None
    assert estimate.light.confidence > SETTLED
    assert len(estimate.views) == 3
    assert searched == [0]


@pytest.mark.parametrize("change", ["light", "object"])
def test_views_of_another_scene_are_left_out(change: str) -> None:
    first, other, _ = views_of(BOX)
    moved = dataclasses.replace(BOX, at=(0.15, 0.01))
    turned, elsewhere = seen_from(105, BOX, index=2, azimuth_deg=235.0), seen_from(105, moved, index=2)
    odd = turned if change == "light" else elsewhere
    estimate = ProxyEstimator(FAST).estimate(first, [other, odd])
    assert estimate.views == (0, 1)
    assert estimate.light is not None
    assert math.degrees(angle_between(estimate.light.to_light_marker, direction(200, 40))) < 1.0


def test_views_that_take_the_place_of_those_left_out_are_looked_at_as_well() -> None:
    """More views than are used at once, of which most show another light: FAST uses three beside the first."""
    first, *same = views_of(BOX)
    of_other_light = [
        seen_from(heading, BOX, index=10 + number, azimuth_deg=235.0)
        for number, heading in enumerate((105, 120, 60, 45, 110, 65))
    ]
    estimate = ProxyEstimator(FAST).estimate(first, [*same, *of_other_light])
    assert estimate.views == (0, 1, 2)
    assert estimate.light is not None
    assert math.degrees(angle_between(estimate.light.to_light_marker, direction(200, 40))) < 1.0


def test_a_plain_grey_box_under_a_high_sun_is_found_by_what_each_view_shows_alone() -> None:
    # Its sides are as dark as its short shadow, and shear at their edges alone.
    grey = dataclasses.replace(BOX, width_m=0.03, height_m=0.05, rgb=(0.08, 0.08, 0.09))
    first, *others = (seen_from(heading, grey, elevation_deg=70) for heading in (90, 85, 95, 87.5, 92.5))
    light = ProxyEstimator(BALANCED).estimate(first, others).light
    assert light is not None
    assert math.degrees(angle_between(light.to_light_marker, direction(200, 70))) < 3.0


def test_a_view_that_was_searched_alone_is_not_searched_again_where_it_is_the_only_one() -> None:
    """Which is looked at where all together give no answer."""
    grey = dataclasses.replace(BOX, width_m=0.03, height_m=0.05, rgb=(0.08, 0.08, 0.09))
    first, *others = (seen_from(heading, grey, elevation_deg=70) for heading in (90, 85, 95))
    found = looked(first, others, BALANCED, fitted_judge(), StageClock()).alone
    assert found is not None, "these views leave doubt together"
    again, anew = looked_alone(found), looked(first, (), BALANCED, fitted_judge(), StageClock())
    assert again.trace.probabilities == anew.trace.probabilities
    assert len(again.views) == 1
    np.testing.assert_array_equal(again.unlit, anew.unlit)


def test_of_two_searches_each_explanation_counts_once() -> None:
    moved = dataclasses.replace(BOX, at=(0.15, 0.01))
    one, other = (
        in_each_view(looked(seen_from(90, caster), (), FAST, fitted_judge(), StageClock()).trace.judged[0])
        for caster in (BOX, moved)
    )
    again = in_each_view(one.joint)
    assert without_alike([(one, 0.5), (other, 1.0), (again, 2.0)]) == [(again, 2.0), (other, 1.0)]


def test_a_nearness_by_the_borders_of_several_views_is_as_overdispersed_as_a_direction() -> None:
    first, *others = views_of(BOX)
    explanation = looked(first, others, FAST, fitted_judge(), StageClock()).trace.judged[0]
    sigmas = [SeenObject(explanation, 0.9, 1e-4 * np.eye(2), factor).place.nearness_sigma for factor in (1.0, 4.0)]
    assert sigmas[1] == pytest.approx(2 * sigmas[0])


def test_views_without_a_marker_count_for_nothing() -> None:
    first, other, _ = views_of(BOX)
    blind = dataclasses.replace(other, marker=None)
    alone, with_blind = ProxyEstimator(FAST).estimate(first), ProxyEstimator(FAST).estimate(first, [blind])
    assert alone.light is not None
    assert with_blind.light is not None
    np.testing.assert_array_equal(alone.light.to_light_marker, with_blind.light.to_light_marker)
    assert with_blind.views == (0,)
    assert with_blind.span_rad is None


def test_nothing_stands_on_an_empty_ground_in_any_view() -> None:
    first, *others = views_of(ground="bricks")
    estimate = ProxyEstimator(FAST).estimate(first, others)
    assert estimate.light is None
    assert estimate.reason


def test_the_same_views_give_the_same_bits(on_bricks: LightEstimate) -> None:
    first, *others = views_of(BOX, ground="bricks")
    one, again = on_bricks.light, ProxyEstimator(FAST).estimate(first, others).light
    assert one is not None
    assert again is not None
    np.testing.assert_array_equal(one.to_light_marker, again.to_light_marker)
    np.testing.assert_array_equal(one.covariance_rad2, again.covariance_rad2)


def test_the_hull_stands_for_what_is_like_no_family() -> None:
    odd = Caster(at=(0.1, -0.03), width_m=0.03), Caster(at=(0.14, 0.02), width_m=0.03)
    block = Caster("cylinder", (0.12, -0.005), 0.06, 0.035, BOX.rgb)
    first, *others = views_of(*odd, block, headings=(90, 65, 115, 78))
    estimate = ProxyEstimator(FAST).estimate(first, others)
    assert estimate.light is not None, estimate.reason
    assert math.degrees(angle_between(estimate.light.to_light_marker, direction(200, 40))) < 2.0
    body = estimate.illumination.real_object
    assert body is not None
    assert body.family == "silhouettes"
    assert body.mesh is not None
    # A hull is no smaller than the object, and not much larger.
    low, high = body.mesh.points_marker.min(axis=0), body.mesh.points_marker.max(axis=0)
    assert BOX.height_m - 0.004 < high[2] < 1.35 * BOX.height_m
    assert (low[:2] < (0.094, -0.036)).all()
    assert (high[:2] > (0.146, 0.026)).all()
    assert (high - low)[:2].max() < 0.12


def test_views_confirm_an_explanation_that_they_show_as_well() -> None:
    first, other, _ = views_of(BOX)
    odd = seen_from(105, BOX, index=2, azimuth_deg=235.0)
    judge = fitted_judge()
    trace = looked(first, [other, odd], FAST, judge, StageClock()).trace
    likeliest = trace.judged[int(np.argmax(trace.probabilities))]
    assert without_confirming([other, odd], likeliest, judge) == [odd]


def test_all_views_that_were_used_outvote_the_first_one_whatever_was_not_used(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of three others one shows too little ground to be used: the two that were used contradict the first one."""
    seen = paint(BOX).tracked
    first, *others = (dataclasses.replace(seen, frame=Frame(seen.frame.image_bgr, index, 0.0)) for index in range(4))
    together = LightEstimate("proxy", 0, Illumination(), "no shadow found", views=(0, 1, 2))
    alone = LightEstimate("proxy", 0, Illumination((Light((0.0, 0.0, 1.0)),)))
    view = View.of(seen, 320)
    estimator, look = ProxyEstimator(BALANCED), Look(Trace(view), [])
    monkeypatch.setattr(estimator, "_looked", lambda _, used, *__: (together if len(used) else alone, look))
    monkeypatch.setattr(proxy, "contradicting", lambda _, __, used, ___: list(used))
    assert estimator.traced(first, others)[0] is together
