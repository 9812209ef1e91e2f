"""Several pictures of the paper cube: what each hides another shows, and what one shows by chance the others do not."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators.proxy import VIEWS_OF_BODY, ProxyEstimator
from ashe_live.light.known_body.outline.confirmed import confirmed
from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.folded import beside_folds
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.pictures.merged import merged_facets, merged_table
from ashe_live.light.known_body.pictures.shots import Shot, shots_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.pixels.view import View
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, Folds, PaintedLight, looking, painted, sun

TILT_DEG, FROM_DEG = 55.0, 30.0
BEHIND_CAMERA = sun(FROM_DEG, 48, on_table=0.6)  # the cube hides its shadow from there
ASIDE = sun(FROM_DEG + 110, 40, on_table=0.6)
HALF = 0.5


def tracked(scenes: Sequence[CubeScene]) -> list[TrackedFrame]:
    """The cube as one tracker sees it in pictures that are taken seconds apart."""
    tracker = MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED)
    found = [tracker.track(Frame(painted(scene), index, 2.0 * index)) for index, scene in enumerate(scenes)]
    assert all(each.marker is not None for each in found)
    return found


def from_sides(
    lights: Sequence[PaintedLight], turns_deg: Sequence[float], folds: Folds | None = None
) -> list[CubeScene]:
    return [
        CubeScene(CAMERA, looking(0.45, TILT_DEG, FROM_DEG + turn), lights, folds=folds or Folds(), seed=3)
        for turn in turns_deg
    ]


def error_deg(estimate: LightEstimate, light: PaintedLight) -> float:
    assert estimate.light is not None
    return math.degrees(
        angle_between(estimate.light.to_light_marker, light.point[:3] / np.linalg.norm(light.point[:3]))
    )


@pytest.fixture(scope="module")
def around() -> list[TrackedFrame]:
    """A crooked cube in a sun behind the camera, which then moves aside."""
    folds = Folds.drawn(np.random.default_rng(4), EDGE_M)
    return tracked(from_sides([BEHIND_CAMERA], (0, 15, 30, 45), folds))


def test_a_shadow_that_one_picture_hides_is_seen_in_another(around: list[TrackedFrame]) -> None:
    first, *others = around
    alone, together = ProxyEstimator().estimate(first), ProxyEstimator().estimate(first, others)
    assert alone.light is not None
    assert together.light is not None
    assert math.degrees(alone.light.sigma_rad or 0) > 5
    assert math.degrees(together.light.sigma_rad or 0) < 3
    assert error_deg(together, BEHIND_CAMERA) < 2
    assert (alone.views, alone.span_rad) == ((0,), None)
    assert set(together.views) == {0, 1, 2, 3}
    assert together.views[0] == 0
    # The camera moves around the upright axis: seen from the cube by less, as it looks down.
    steep = math.cos(math.radians(90 - TILT_DEG))
    expected = 2 * math.asin(steep * math.sin(math.radians(45) / 2))
    assert together.span_rad == pytest.approx(expected, abs=math.radians(3))


def test_more_pictures_never_make_a_right_answer_less_sure(around: list[TrackedFrame]) -> None:
    first, *others = around
    answers = [ProxyEstimator().estimate(first, others[:count]) for count in range(len(others) + 1)]
    sure = [each.light.confidence or 0.0 for each in answers if each.light is not None]
    assert len(sure) == len(answers)
    assert all(more > fewer - 0.02 for fewer, more in pairwise(sure))


def test_no_more_pictures_are_used_than_are_useful() -> None:
    first, *others = tracked(from_sides([ASIDE], range(0, 60, 10)))
    assert len(ProxyEstimator().estimate(first, others).views) == VIEWS_OF_BODY


@pytest.mark.parametrize("other", [[sun(FROM_DEG + 250, 40, on_table=0.6)], []], ids=["another sun", "no sun"])
def test_a_picture_in_another_light_is_left_out(other: list[PaintedLight]) -> None:
    first, changed = tracked([*from_sides([ASIDE], [0]), *from_sides(other, [20])])
    alone, together = ProxyEstimator().estimate(first), ProxyEstimator().estimate(first, [changed])
    assert together.views == (0,)
    assert together.light is not None
    assert alone.light is not None
    assert together.light.to_light_marker == pytest.approx(alone.light.to_light_marker, abs=1e-12)


def shots(scenes: Sequence[CubeScene]) -> tuple[list[Shot], list[TrackedFrame]]:
    found = tracked(scenes)
    body = found[0].pose.body
    assert body is not None
    return shots_of([(View.of(each, 640), each.pose.pose_shape_errors) for each in found], body), found


def test_pictures_are_brought_to_one_exposure() -> None:
    bright, dark = from_sides([ASIDE], (0, 20))
    dark = replace(dark, exposure=HALF * bright.exposure)
    several, (first, other) = shots([bright, dark])
    assert several[1].gain == pytest.approx(np.full(3, 1 / HALF), rel=0.05)
    alone, _ = shots([bright])
    both, own = merged_table(several), alone[0].table
    assert both.seen[own.seen].all()
    assert np.count_nonzero(both.seen) > np.count_nonzero(own.seen)  # what the cube hides in one of them
    assert np.median(both.light_rgb[own.seen] / own.light_rgb[own.seen]) == pytest.approx(1, abs=0.02)
    assert error_deg(ProxyEstimator().estimate(first, [other]), ASIDE) < 1


def test_a_facet_that_one_picture_overexposes_is_measured_in_another() -> None:
    bright, dark = from_sides([ASIDE], (0, 20))
    bright, dark = replace(bright, exposure=1.5), replace(dark, exposure=0.6)
    several, found = shots([bright, dark])
    body = found[0].pose.body
    assert body is not None
    alone, together = merged_facets(several[:1], body), merged_facets(several, body)
    assert alone.level_sigma > 0
    assert together.level_sigma == 0
    assert not together.is_clipped.any()
    normals = {tuple(each) for each in together.normals.round().tolist()}
    assert {tuple(each) for each in alone.normals.round().tolist()} <= normals
    level = together.light_rgb[together.normals[:, 2] > 0.9][0].mean()
    in_its_own = merged_facets(several[1:], body)
    own = in_its_own.light_rgb[in_its_own.normals[:, 2] > 0.9][0]
    assert level == pytest.approx((several[1].gain * own).mean())


def prepared(scenes: Sequence[CubeScene]) -> Seen:
    """By pictures that need not show one scene."""
    found = tracked(scenes)
    body = found[0].pose.body
    assert body is not None
    seen = [Seen.of(View.of(each, 640), body, each.pose.pose_shape_errors) for each in found]
    first = seen[0]
    assert first is not None
    return replace(first, photos=tuple(one.photos[0] for one in seen if one is not None))


def fit_in(seen: Seen, light: PaintedLight) -> ShadowFit:
    fit = fitted(seen.photos[0].edge_image, light.point / light.point[2], 0.6, size_rad=0.0)
    assert fit is not None
    return fit


def test_edges_that_only_one_of_two_pictures_shows_are_half_as_clear() -> None:
    seen = prepared([*from_sides([ASIDE], [0]), *from_sides([], [10])])
    fit = fit_in(seen, ASIDE)
    assert fit.clear > 0.9
    assert confirmed(fit, seen.edge_images, 0.6).clear == pytest.approx(fit.clear / 2, abs=0.05)
    alone = EdgeImages((seen.photos[0].edge_image,))
    assert confirmed(fit, alone, 0.6) is fit


def test_edges_that_both_show_are_as_clear_as_in_one() -> None:
    seen = prepared(from_sides([ASIDE], (0, 10)))
    fit = fit_in(seen, ASIDE)
    both = confirmed(fit, seen.edge_images, 0.6)
    assert both.clear == pytest.approx(fit.clear, abs=0.05)
    assert both.misfit_px < 1
    assert both.light == pytest.approx(fit.light)


def test_the_same_picture_twice_says_no_more_than_once() -> None:
    """However exact it is, the same folds are behind it."""
    seen = prepared(from_sides([ASIDE], [0]))
    fit, (image,) = fit_in(seen, ASIDE), seen.edge_images.several
    once = beside_folds(fit, EdgeImages((image,)), 0.6, with_nearness=False)
    twice = beside_folds(fit, EdgeImages((image, image)), 0.6, with_nearness=False)
    assert once is not None
    assert twice is not None
    assert twice[0] == pytest.approx(once[0], abs=1e-9)
    assert twice[1] == pytest.approx(once[1], rel=1e-6)


def test_a_picture_with_other_edges_says_nothing_of_these() -> None:
    """Its own are those of a light that is farther away than the body may be off."""
    near = sun(FROM_DEG + 110, 41.5, on_table=0.6)
    seen = prepared([*from_sides([ASIDE], [0]), *from_sides([near], [0])])
    fit = fit_in(seen, ASIDE)
    errors = seen.photos[0].pose_shape_errors
    assert errors is not None
    hardly_off = replace(errors, pose=0.01 * errors.pose, points=0.01 * errors.points)
    first, other = (replace(each, pose_shape_errors=hardly_off) for each in seen.edge_images.several)
    own = beside_folds(fit, EdgeImages((first,)), 0.6, with_nearness=False)
    by_other = beside_folds(fit, EdgeImages((other,)), 0.6, with_nearness=False)
    both = beside_folds(fit, EdgeImages((first, other)), 0.6, with_nearness=False)
    assert own is not None
    assert by_other is not None
    assert both is not None
    assert np.abs(by_other[0][:2] - own[0][:2]).max() > 0.03
    assert both[0] == pytest.approx(own[0], abs=1e-9)


def test_a_light_is_looked_for_in_the_first_picture_that_shows_its_shadow() -> None:
    seen = prepared(from_sides([BEHIND_CAMERA, ASIDE], (0, 60, 61)))
    hidden, shown = (each.point / each.point[2] for each in (BEHIND_CAMERA, ASIDE))
    first, second, _ = seen.photos
    assert seen.showing(shown) is first
    assert seen.showing(hidden) is second
    assert seen.edge_images.shown(hidden) == max(each.shown(hidden) for each in seen.edge_images.several)
