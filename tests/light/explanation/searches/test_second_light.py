"""The second light on painted scenes: found where there is one, however pale its shadow, and nowhere else."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.light import LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.second_light import with_lights_counted
from ashe_live.light.explanation.searches.shadow_search import DIRECTIONS, _MatchedFilter, shadow_candidates
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground
from ashe_live.light.ground.shadow_shift import shift_of_ratio
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.labels.two_lights import likeliest_pairs, materials_of_two
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import outlines, predicted
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, SHADOW_RATIO, Caster, OtherLight, Painted, paint
from tests.light.synthetic_masks import direction

PALE = OtherLight(300.0, 50.0, (0.22, 0.22, 0.21))
STRONG = OtherLight(80.0, 45.0, (0.12, 0.2, 0.3))
BODY = Proxy(
    "frustum", [(*CYLINDER.at, 0, CYLINDER.width_m / 2, 0), (*CYLINDER.at, CYLINDER.height_m, CYLINDER.width_m / 2, 0)]
)


def seen(painted: Painted) -> tuple[View, LitGround]:
    coarse = View.of(painted.tracked, BALANCED.coarse_width_px)
    ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, BALANCED.ground)
    assert ground is not None
    return coarse, ground


def estimated(painted: Painted) -> LightEstimate:
    return ProxyEstimator().estimate(painted.tracked)


def errors_deg(estimate: LightEstimate, *truths: Float) -> list[float]:
    """Of each answer, from the true light that it is nearest to."""
    answers = [light.to_light_marker for light in estimate.lights]
    return [min(math.degrees(angle_between(answer, truth)) for truth in truths) for answer in answers]


@pytest.mark.parametrize(
    ("ground", "other"),
    [("plain", PALE), ("plain", STRONG), ("checkered", STRONG), ("bricks", STRONG)],
    ids=["pale", "strong", "strong on checks", "strong on bricks"],
)
def test_a_shadow_candidate_gives_direction_and_strength_of_the_second_light(ground: str, other: OtherLight) -> None:
    painted = paint(CYLINDER, ground=ground, other=other)
    found = shadow_candidates(BODY, at_infinity(painted.to_light)[None], *seen(painted), 1)
    assert len(found) == 1
    assert math.degrees(angle_between(found[0].light[:3], other.to_light)) < 8
    darker = math.log(1 - np.mean(other.blocked_rgb))
    assert found[0].shift[0] == pytest.approx(darker, rel=0.35)


def test_a_known_lamp_far_away_leaves_what_a_known_sun_does() -> None:
    painted = paint(CYLINDER, other=STRONG)
    lamp = np.append(1e6 * painted.to_light, 1.0)
    (by_sun,), (by_lamp,) = (
        shadow_candidates(BODY, light[None], *seen(painted), 1) for light in (at_infinity(painted.to_light), lamp)
    )
    np.testing.assert_array_equal(by_sun.area, by_lamp.area)
    np.testing.assert_allclose(by_lamp.shift, by_sun.shift, rtol=1e-3)


def test_the_shadow_of_a_known_lamp_is_no_candidate() -> None:
    painted = paint(CYLINDER)
    to_light, foot = painted.to_light, np.array([*CYLINDER.at, 0.0])
    view, ground = seen(painted)
    aside = np.append(foot + 0.25 * direction(80.0, 45.0), 1.0)
    (candidate,) = shadow_candidates(BODY, aside[None], view, ground, 1)
    assert not (candidate.area & predicted(BODY, aside[None], view).whole).any()
    assert math.degrees(angle_between(candidate.light[:3], to_light)) < 8
    in_line = np.append(foot + 0.5 * to_light, 1.0)
    assert shadow_candidates(BODY, in_line[None], view, ground, 1) == []


def test_shadows_are_tried_where_suns_and_lamps_cast_them() -> None:
    view, ground = seen(paint(CYLINDER))
    lamp = np.array([*((*CYLINDER.at, 0.0) + 0.25 * direction(100.0, 45.0)), 1.0])
    lights = np.array([lamp, at_infinity(direction(100.0, 45.0))])
    cube = Proxy("box", np.array([(x, y, z, 0, 0) for x in (0.1, 0.15) for y in (0.0, 0.05) for z in (0.0, 0.06)]))
    tried = _MatchedFilter.of(cube, view, view.is_ground, ground.colours, view.is_ground)
    found, is_seen = tried._outlines(lights)
    assert is_seen.all()
    for outline, true in zip(found, outlines(cube, lights, view)[1:], strict=True):
        assert true is not None
        np.testing.assert_allclose((outline @ DIRECTIONS.T).max(axis=0), (true @ DIRECTIONS.T).max(axis=0), atol=0.01)


def test_one_light_leaves_no_further_candidate_on_an_even_ground() -> None:
    painted = paint(CYLINDER)
    assert shadow_candidates(BODY, at_infinity(painted.to_light)[None], *seen(painted), 2) == []


def test_what_lies_out_of_view_is_no_candidate() -> None:
    coarse, ground = seen(paint(CYLINDER, other=PALE))
    far = Proxy("frustum", BODY.spheroids_marker + np.array([50.0, 0, 0, 0, 0]))
    assert shadow_candidates(far, at_infinity(np.array([[0.0, 0, 1]])), coarse, ground, 2) == []


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=["box", "cylinder"])
@pytest.mark.parametrize("other", [PALE, STRONG], ids=["pale", "strong"])
def test_both_lights_are_answered(caster: Caster, other: OtherLight) -> None:
    painted = paint(caster, other=other)
    estimate = estimated(painted)
    assert len(estimate.lights) == 2
    assert max(errors_deg(estimate, painted.to_light, other.to_light)) < 3
    apart = angle_between(estimate.lights[0].to_light_marker, estimate.lights[1].to_light_marker)
    assert apart == pytest.approx(angle_between(painted.to_light, other.to_light), abs=math.radians(4))


def test_other_things_on_the_table_hide_no_second_light() -> None:
    """Lit ground says how clear a pale shadow is, not the objects beside it."""
    black = Caster("box", at=(-0.13, 0.12), width_m=0.09, height_m=0.09, rgb=(0.01, 0.01, 0.02))
    red = Caster("box", at=(-0.13, -0.1), width_m=0.09, height_m=0.06, rgb=(0.7, 0.02, 0.02))
    painted = paint(CYLINDER, black, red, other=PALE)
    found = shadow_candidates(BODY, at_infinity(painted.to_light)[None], *seen(painted), 1)
    assert len(found) == 1
    assert math.degrees(angle_between(found[0].light[:3], PALE.to_light)) < 8


def test_each_light_leaves_its_own_shadow_colour() -> None:
    painted = paint(CYLINDER, other=STRONG)
    first, second = estimated(painted).lights
    np.testing.assert_allclose(np.array(first.shadow_rgb_ratio), SHADOW_RATIO, atol=0.1)
    np.testing.assert_allclose(np.array(second.shadow_rgb_ratio), 1 - np.array(STRONG.blocked_rgb), atol=0.1)


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
def test_one_light_stays_one(ground: str) -> None:
    assert len(estimated(paint(CYLINDER, ground=ground)).lights) == 1


def test_a_stain_beside_the_shadow_is_no_second_light() -> None:
    flat = Caster("cylinder", at=(0.12, -0.09), width_m=0.05, height_m=0.0005, rgb=(0.3, 0.27, 0.24))
    painted = paint(CYLINDER, flat)
    assert len(estimated(painted).lights) <= 1


@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_two_true_shifts_explain_a_region_better_than_any_wrong_one_with_them(ground: str) -> None:
    painted = painted_region(CYLINDER, ground=ground, other=STRONG)
    true = [shift_of_ratio(painted.ground, ratio) for ratio in (SHADOW_RATIO, 1 - np.array(STRONG.blocked_rgb))]
    wrong = [true[0] + (0, 0.5, 0.2), true[1] + (-0.4, -0.4, 0.2)]
    best, *_ = likeliest_pairs(painted.region, painted.ground, [wrong[0], true[0], wrong[1], true[1]], 3)
    assert best == (1, 3)


def test_shifts_that_leave_no_light_are_no_pair() -> None:
    painted = painted_region(CYLINDER)
    dark, darker = (shift_of_ratio(painted.ground, np.full(3, left)) for left in (0.45, 0.5))
    assert likeliest_pairs(painted.region, painted.ground, [dark, darker], 3) == []


@pytest.mark.parametrize(("left", "are_two"), [(0.6, True), (0.45, True), (0.3, False)])
def test_contributions_may_exceed_all_light_by_their_noise_only(left: float, are_two: bool) -> None:
    painted = painted_region(CYLINDER)
    one, other = (
        materials_of(painted.region, painted.ground, shift_of_ratio(painted.ground, np.full(3, each)))
        for each in (left, left + 0.05)
    )
    both = materials_of_two(painted.region, painted.ground, one, other)
    assert (both is not None) == are_two
    if both is not None:
        deeper, paler, together = both.shifts
        assert together[0] < deeper[0] < paler[0]


def test_a_pair_with_a_wrong_second_light_leaves_the_right_one_to_be_found() -> None:
    """A region that cuts one of two shadows shows both, so that its pair is likelier than the first light alone."""
    painted = paint(BOX, other=STRONG)
    _, trace = ProxyEstimator().traced(painted.tracked)
    both = trace.judged[int(np.argmax(trace.probabilities))]
    known, other = both.lights
    single = next(
        each for each in trace.rough if angle_between(each.lights[0].to_light_marker, known.to_light_marker) < 0.1
    )
    wrong = replace(both, lights=(known, replace(other, light=at_infinity(direction(-100.0, 60.0)))))
    view, ground = seen(painted)
    scene = SceneView(0, View.of(painted.tracked, BALANCED.fine_width_px), view, ground)
    found = with_lights_counted([wrong, single], [], scene, BALANCED.region_px, lambda one: float(len(one.lights)))
    assert found[0] is wrong
    assert any(
        max(angle_between(light.to_light_marker, true) for light, true in zip(one.lights, pair, strict=True)) < 0.05
        for one in found[1:]
        for pair in ((painted.to_light, STRONG.to_light), (STRONG.to_light, painted.to_light))
        if len(one.lights) == 2
    )


@pytest.mark.parametrize("elevation_deg", [55.0, 65.0])
def test_a_pair_with_one_shadow_cut_short_gives_way_to_the_pair_with_all_of_it(elevation_deg: float) -> None:
    painted = paint(BOX, other=STRONG)
    _, trace = ProxyEstimator().traced(painted.tracked)
    both = trace.judged[int(np.argmax(trace.probabilities))]
    truths = (painted.to_light, STRONG.to_light)
    known, other = sorted(both.lights, key=lambda light: angle_between(light.to_light_marker, painted.to_light))
    single = next(
        each for each in trace.rough if angle_between(each.lights[0].to_light_marker, known.to_light_marker) < 0.1
    )
    higher = replace(other, light=at_infinity(direction(STRONG.azimuth_deg, elevation_deg)))
    view, ground = seen(painted)
    scene = SceneView(0, View.of(painted.tracked, BALANCED.fine_width_px), view, ground)
    for lights in ((known, higher), (higher, known)):
        short = replace(both, lights=lights)
        found = with_lights_counted([short, single], [], scene, BALANCED.region_px, lambda one: float(len(one.lights)))
        pairs = [one for one in found if len(one.lights) == 2]
        assert pairs
        for one in pairs:
            errors = [min(angle_between(light.to_light_marker, true) for true in truths) for light in one.lights]
            assert max(errors) < 0.05


@pytest.mark.parametrize(("clear", "is_light"), [(0.2, False), (0.35, True)])
def test_a_shadow_of_whose_border_little_is_seen_is_no_second_lights(clear: float, is_light: bool) -> None:
    """Of an object's dark surroundings, where it hides the sky, some border always agrees with some light's shadow."""
    painted = paint(BOX, other=STRONG)
    _, trace = ProxyEstimator().traced(painted.tracked)
    both = trace.judged[int(np.argmax(trace.probabilities))]
    pair = replace(both, alignment=replace(both.alignment, clear_shadows=(0.9, clear)))
    view, ground = seen(painted)
    scene = SceneView(0, View.of(painted.tracked, BALANCED.fine_width_px), view, ground)
    found = with_lights_counted([pair], [], scene, BALANCED.region_px, lambda one: float(len(one.lights)))
    assert any(one is pair for one in found) == is_light
