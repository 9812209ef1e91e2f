"""Several pictures of the paper cube: what each hides another shows, and what one shows by chance the others do not."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators import proxy
from ashe_live.light.estimators.known_body import BodyEstimate, estimate_by_body
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.estimators.proxy import VIEWS_OF_BODY, ProxyEstimator
from ashe_live.light.known_body.outline.confirmed import confirmed
from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.folded import beside_folds
from ashe_live.light.known_body.outline.profiles import EdgeImages
from ashe_live.light.known_body.pictures import merged as merged_module
from ashe_live.light.known_body.pictures import shots as shots_module
from ashe_live.light.known_body.pictures.merged import merged_facets, merged_table
from ashe_live.light.known_body.pictures.shots import BLACK, Shot, shots_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.known_body.table import LEAST_CELLS, SIDE, TableMap
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
    poses = [looking(0.45, TILT_DEG, FROM_DEG + turn) for turn in turns_deg]
    scene = CubeScene(CAMERA, poses[0], lights, folds=folds or Folds(), grain_from=poses[0], seed=3)
    return [replace(scene, T_cam_cube=pose) for pose in poses]


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


def test_the_same_picture_twice_says_no_more_than_once() -> None:
    """However exact it is, the same folds are behind it."""
    seen = prepared(from_sides([ASIDE], [0]))
    fit, (image,) = fit_in(seen, ASIDE), seen.edge_images.several
    once = beside_folds(fit, EdgeImages((image,)), 0.6, with_nearness=False)
    again = replace(image, view=replace(image.view))
    twice = beside_folds(fit, EdgeImages((image, again)), 0.6, with_nearness=False)
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
    by_other = beside_folds(replace(fit, view=other.view), EdgeImages((other,)), 0.6, with_nearness=False)
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
    assert seen.edge_images.shown(hidden) >= second.edge_image.shown(hidden) > 2 * first.edge_image.shown(hidden)


def test_a_picture_confirms_no_fit_that_was_made_in_it() -> None:
    """Though another one shows the light's shadow first."""
    seen = prepared([*from_sides([], [10]), *from_sides([ASIDE], [0])])
    image = seen.photos[1].edge_image
    fit = fitted(image, ASIDE.point / ASIDE.point[2], 0.6, size_rad=0.0)
    assert fit is not None
    assert seen.edge_images.showing(fit.light) is not image
    assert confirmed(fit, seen.edge_images, 0.6).clear == pytest.approx(fit.clear / 2, abs=0.05)


def test_no_picture_confirms_a_shadow_that_none_shows() -> None:
    images = prepared(from_sides([ASIDE], (0, 10))).edge_images
    below = np.array((0.3, 0.2, -1.0, 0.0))
    assert images.shown(below) == 0
    assert images.showing(below) is images.several[0]
    assert images.others_showing(below, images.several[0].view) == []


def test_a_preset_of_fewer_views_uses_as_many_of_a_cube(around: list[TrackedFrame]) -> None:
    first, *others = around
    for views in (1, 2, 3):
        estimate = ProxyEstimator(replace(FAST, views=views)).estimate(first, others)
        assert len(estimate.views) == views


def table_of(light: float, *rows: int) -> TableMap:
    """As bright throughout, and seen in these rows."""
    seen = np.zeros((SIDE, SIDE), bool)
    seen[slice(*rows)] = True
    return TableMap(np.full((SIDE, SIDE, 3), light, np.float32), seen)


def test_a_picture_that_shows_too_little_of_the_firsts_table_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    (frame,) = tracked(from_sides([ASIDE], [0]))
    body, view, rows = frame.pose.body, View.of(frame, 640), -(-LEAST_CELLS // SIDE)
    assert body is not None

    def gains(*tables: TableMap | None) -> list[list[float]]:
        given = iter(tables)
        monkeypatch.setattr(shots_module, "table_around", lambda *_: next(given))
        return [shot.gain.tolist() for shot in shots_of([(view, None)] * len(tables), body)]

    first = table_of(0.4, 0, 2 * rows)
    beside, beyond = table_of(0.2, rows, 9 * rows), table_of(0.2, 2 * rows - 1, 9 * rows)
    assert gains(first, beyond, None, beside) == [[1.0] * 3, pytest.approx([2.0] * 3)]
    assert gains(None, first, beside) == [], "all is in the exposure of the first"
    assert gains(first, table_of(0.0, 0, 2 * rows)) == [[1.0] * 3, pytest.approx([0.4 / BLACK] * 3)]


def test_of_each_facet_the_picture_counts_that_shows_it_best(monkeypatch: pytest.MonkeyPatch) -> None:
    """The level one's is that by whose ink its light is known best; of others the broadest that is not overexposed."""
    (frame,) = tracked(from_sides([ASIDE], [0]))
    normals = np.array([(0.0, 0, 1), (1, 0, 0), (0, 1, 0)])
    (shot,) = shots_of([(View.of(frame, 640), None)], frame.pose.body)

    def facets(light: float, clipped: list[bool], width_px: list[float], level_sigma: float) -> Facets:
        light_rgb = np.full((3, 3), light)
        return Facets(normals, light_rgb, light * normals, np.array(clipped), np.array(width_px), level_sigma)

    given = [facets(1.0, [True, False, True], [90, 60, 90], 0.2), facets(3.0, [True, False, False], [50, 20, 10], 0.1)]
    coming = iter(given)
    monkeypatch.setattr(merged_module, "facets_of", lambda *_: next(coming))
    gain = np.array((1.0, 2.0, 3.0))
    found = merged_facets([shot, replace(shot, gain=gain)], frame.pose.body)
    at = [int(np.flatnonzero((found.normals == normal).all(axis=1)).item()) for normal in normals]
    level, broad, exposed = at
    assert found.light_rgb[[level, broad, exposed]] == pytest.approx(np.array([3 * gain, np.ones(3), 3 * gain]))
    assert found.centres[at] == pytest.approx(normals * np.array([[3.0], [1.0], [3.0]]))
    assert found.is_clipped[at].tolist() == [True, False, False]
    assert found.width_px[at].tolist() == [50, 60, 10]
    assert found.level_sigma == 0.1
    without_level = [
        replace(each, **{name: getattr(each, name)[1:] for name in ("normals", "light_rgb", "centres", "is_clipped")},
                width_px=each.width_px[1:])
        for each in given
    ]  # fmt: skip
    coming = iter(without_level)
    assert merged_facets([shot, shot], frame.pose.body).level_sigma == math.inf


@pytest.mark.parametrize("odd", [1, 2, 3])
def test_where_nothing_explains_all_views_those_that_contradict_the_first_are_left_out_unless_all_do(
    odd: int, around: list[TrackedFrame], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Together the views give no light; then the answer by the first alone is asked which of them agree with it."""
    first, *others = around
    given: list[int] = []

    def estimated(tracked: TrackedFrame, beside: Sequence[TrackedFrame], **rest: object) -> BodyEstimate:
        given.append(len(beside))
        found = estimate_by_body(tracked, (), **rest)  # type: ignore[arg-type]
        if not beside or len(beside) == 3 - odd:
            return replace(found, used=list(beside))
        none = LightEstimate(found.estimate.estimator, tracked.frame.index, Illumination(), "no shadow")
        return replace(found, estimate=none, used=list(beside))

    monkeypatch.setattr(proxy, "estimate_by_body", estimated)
    monkeypatch.setattr(proxy, "contradicting", lambda _estimate, _tracked, used, _preset: used[3 - odd :])
    estimate = ProxyEstimator().estimate(first, others)
    if odd == 3:
        assert estimate.light is None
        assert given == [3, 0]
    else:
        assert estimate.light is not None
        assert given == [3, 0, 3 - odd]
