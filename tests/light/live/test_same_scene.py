"""Two views of one scene agree on its plane, however the camera moved; a changed light, object or marker does not."""

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame
from ashe_live.light.live import same_scene
from ashe_live.light.live.key_views import KeyViews
from ashe_live.light.live.same_scene import (
    CELLS_A_SIDE,
    HALF_SIDES,
    HIGHEST_SIDES,
    LEAST_DIFFERENCES,
    PlanePicture,
    differs,
    first_of_most,
    of_one_scene,
    outdated,
    outdated_with_far,
)
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from tests.light.painted_scenes import BOX, Caster, paint
from tests.light.synthetic_masks import camera_towards

MUG = Caster("cylinder", at=(0.02, -0.13), width_m=0.07, height_m=0.1)


@cache
def seen(*casters, azimuth_deg=0.0, ground="checkered", light_deg=200.0, exposure=1.0, seed=0, **kwargs):
    """A picture from the side `azimuth_deg` of the first, drawn onto the plane."""
    kwargs |= {"ground": ground, "azimuth_deg": light_deg, "exposure": exposure, "seed": seed}
    towards = camera_towards((0.02, 0.0), 0.6, 45.0, azimuth_deg)
    return PlanePicture.of(paint(*casters, T_cam_marker=towards, **kwargs).tracked)


@pytest.mark.parametrize("ground", ["plain", "checkered", "bricks"])
@pytest.mark.parametrize("turned_deg", [0.5, 3, 8, 14])
def test_a_moving_camera_changes_nothing(ground, turned_deg) -> None:
    first = seen(BOX, MUG, ground=ground)
    assert differs(first, seen(BOX, MUG, ground=ground, azimuth_deg=turned_deg, exposure=0.8, seed=1)) is False


def test_neither_does_another_exposure() -> None:
    assert differs(seen(BOX), seen(BOX, exposure=0.55, seed=1)) is False


def test_from_far_apart_or_by_a_glimpse_of_the_ground_nothing_is_said() -> None:
    assert differs(seen(BOX), seen(BOX, azimuth_deg=40)) is None
    for sides, said in ((1.9, None), (2.1, False)):
        now = seen(BOX)
        cells = np.zeros(now.is_seen.size, np.bool_)
        cells[np.flatnonzero(now.is_seen)[: round(sides * CELLS_A_SIDE**2)]] = True
        assert differs(seen(BOX, seed=1), replace(now, is_seen=cells.reshape(now.is_seen.shape))) is said


@pytest.mark.parametrize(("grey", "said"), [(60, True), (255, False)], ids=["dark paper", "glare"])
def test_a_glare_on_the_table_is_no_change(grey, said) -> None:
    tracked = paint(BOX, T_cam_marker=camera_towards((0.02, 0.0), 0.6, 45.0), ground="plain").tracked
    image = np.array(tracked.frame.image_bgr)
    corners = np.array([(-0.16, -0.16, 0), (-0.08, -0.16, 0), (-0.08, -0.08, 0), (-0.16, -0.08, 0)])
    outline = np.round(project(tracked.camera, tracked.marker.T_cam_marker, corners)).astype(np.int32)
    cv2.fillConvexPoly(image, outline, (grey, grey, grey))
    lit = replace(tracked, frame=Frame(image, 1, 0.0))
    assert differs(PlanePicture.of(tracked), PlanePicture.of(lit)) is said


@pytest.mark.parametrize("factor", [0.1, 10])
def test_a_table_ten_times_as_large_looks_the_same(factor) -> None:
    tracked = paint(BOX, T_cam_marker=camera_towards((0.02, 0.0), 0.6, 45.0)).tracked
    T = tracked.marker.T_cam_marker.copy()
    T[:3, 3] *= factor
    larger = replace(tracked, marker=replace(tracked.marker, T_cam_marker=T, side_m=factor * tracked.marker.side_m))
    here, there = PlanePicture.of(tracked), PlanePicture.of(larger)
    np.testing.assert_allclose(there.slope, here.slope)
    assert there.height_sides == pytest.approx(here.height_sides)
    assert differs(here, there) is False


@pytest.mark.parametrize("turned_deg", [0, 3])
@pytest.mark.parametrize(
    "changed",
    [
        lambda **view: seen(BOX, light_deg=235.0, **view),
        lambda **view: seen(BOX, elevation_deg=75.0, **view),
        lambda **view: seen(BOX, light_deg=20.0, **view),
        lambda **view: seen(Caster(at=(0.12, 0.06)), **view),
        lambda **view: seen(Caster(at=(0.16, 0.05)), **view),
        lambda **view: seen(BOX, MUG, **view),
        lambda **view: seen(**view),
    ],
    ids=["sun turned", "sun risen", "another lamp", "box moved", "marker moved", "mug put down", "box taken away"],
)
def test_what_has_changed_is_noticed(changed, turned_deg) -> None:
    assert differs(seen(BOX), changed(azimuth_deg=turned_deg, seed=1)) is True


def test_a_hand_in_one_view_makes_that_one_of_no_use_and_a_new_light_all_of_them() -> None:
    now = seen(BOX)
    steady = [seen(BOX, azimuth_deg=angle, seed=angle) for angle in (1, 4, 7)]
    hand = seen(BOX, Caster(at=(-0.1, -0.1), width_m=0.12, height_m=0.05), azimuth_deg=2)
    far = seen(BOX, light_deg=235.0, azimuth_deg=60)
    assert outdated(now, [steady[0], hand, *steady[1:], far]) == [1]
    old = [seen(BOX, light_deg=235.0, azimuth_deg=angle) for angle in (1, 4, 7, 60)]
    assert outdated(now, old) == [0, 1, 2, 3]
    assert outdated(now, []) == []


def test_a_hand_in_the_only_view_that_can_be_compared_is_told_by_the_others() -> None:
    now = seen(BOX)
    hand = Caster(at=(-0.1, -0.1), width_m=0.12, height_m=0.05)
    far = [seen(BOX, azimuth_deg=angle, seed=angle) for angle in (17, 19, 21)]
    assert [differs(now, each) for each in far] == [None, None, None]
    assert outdated(now, [*far, seen(BOX, hand, azimuth_deg=14)]) == [3]
    assert outdated(now, [*far, seen(BOX, azimuth_deg=14)]) == []
    changed = seen(BOX, MUG)
    assert outdated(changed, [*far, seen(BOX, azimuth_deg=14)]) == [0, 1, 2, 3]


def test_the_nearest_views_say_whether_a_low_thing_is_new() -> None:
    """From farther aside it may have stood there before: its shadow shears as a thing above the plane does."""
    now = seen(BOX, Caster(at=(-0.1, -0.1), width_m=0.06, height_m=0.02))
    before = [seen(BOX, azimuth_deg=angle, seed=angle) for angle in (13, 1, 9, 3, 11)]
    assert [differs(now, each) for each in before] == [False, True, False, True, False]
    assert outdated(now, before) == [0, 1, 2, 3, 4]


def test_what_is_too_far_aside_is_compared_with_what_is_between() -> None:
    now = seen(BOX)
    angles = range(3, 36, 3)
    changed = [seen(BOX, *[MUG] * (angle > 17), azimuth_deg=angle, seed=angle) for angle in angles]
    assert outdated(now, changed) == []
    assert outdated_with_far(now, changed) == [at for at, angle in enumerate(angles) if angle > 17]
    same = [seen(BOX, azimuth_deg=angle, seed=angle) for angle in angles]
    assert outdated_with_far(now, same) == []
    hand = seen(BOX, Caster(at=(-0.1, -0.1), width_m=0.12, height_m=0.05), azimuth_deg=18)
    assert set(outdated_with_far(now, [*same[:5], hand, *same[6:]])) <= {5}
    assert outdated_with_far(now, []) == []


def test_the_shipped_clip_shows_one_scene() -> None:
    clip = shipped_clip()
    tracker = MarkerTracker(parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, BALANCED)
    kept = KeyViews()
    with ClipSource(clip.path) as source:
        while (frame := source.read()) is not None:
            kept.add(tracker.track(frame))
    pictures = [PlanePicture.of(view) for view in kept.views]
    told = [differs(a, b) for at, a in enumerate(pictures) for b in pictures[:at]]
    assert not any(told)
    assert told.count(False) >= len(pictures)


def test_a_thing_as_bright_as_the_ground_is_noticed_by_its_colour(monkeypatch) -> None:
    hand = Caster(at=(-0.1, -0.1), width_m=0.12, height_m=0.004, rgb=(0.75, 0.36, 0.25))
    now, before = (seen(BOX, *things, ground="plain", azimuth_deg=3 * len(things)) for things in ((hand,), ()))
    assert differs(now, before) is True
    monkeypatch.setattr(same_scene, "LEAST_DIFFERENCES", np.array([0.3, np.inf, np.inf]))
    assert differs(now, before) is False


def drawn(
    patch: tuple[slice, slice] | None = None,
    colours: tuple[float, float, float] = (0.5, 0.0, 0.0),
    slope: float = 0.0,
    height_sides: float = 30.0,
    exposure: float = 0.0,
) -> PlanePicture:
    """Plain ground with a patch of another colour, from the side by that slope."""
    cells = 2 * HALF_SIDES * CELLS_A_SIDE
    ground = np.full((cells, cells, 3), (exposure, 0.0, 0.0), np.float32)
    if patch is not None:
        ground[patch] += np.array(colours, np.float32)
    return PlanePicture(ground, np.ones((cells, cells), np.bool_), np.array((slope, 0.0)), height_sides)


def strip(width: int) -> tuple[slice, slice]:
    return slice(20, 60), slice(30, 30 + width)


@pytest.mark.parametrize("slope", [0.0, 1 / 6, -1 / 6])
@pytest.mark.parametrize("exposure", [0.0, -0.4])
def test_what_a_thing_on_the_plane_may_shear_by_is_no_change(slope, exposure) -> None:
    """By its height times the difference of the slopes: of three sides and a sixth, half a side, or five cells."""
    sheared = round(HIGHEST_SIDES * abs(slope) * CELLS_A_SIDE)
    for width, is_changed in ((sheared + 3, False), (sheared + 6, True)):
        now, before = drawn(strip(width), slope=slope), drawn(exposure=exposure)
        assert differs(now, before) is differs(before, now) is is_changed


@pytest.mark.parametrize(("height_sides", "least"), [(30.0, 10), (7.5, 12), (3.0, 12)])
def test_high_things_near_the_camera_shear_more_which_colours_alone_pay_for(height_sides, least) -> None:
    """The slope to a thing's top is larger by 1 / (1 - its share of the camera's height), of which 0.4 are allowed."""
    for colours, widest in (((0.0, 0.7, 0.0), least), ((0.0, 0.0, 0.5), least), ((0.4, 0.0, 0.0), 9)):
        for width, is_changed in ((widest - 1, False), (widest + 1, True)):
            now = drawn(strip(width), colours, slope=1 / 6, height_sides=30.0)
            assert differs(now, drawn(height_sides=height_sides)) is is_changed


def test_a_change_counts_from_a_fifth_of_a_squared_side_on_and_from_its_least_difference() -> None:
    for width, is_changed in ((4, False), (6, True)):  # cells, a hundred of which are a squared side
        assert differs(drawn((slice(40, 40 + width), slice(40, 40 + width))), drawn()) is is_changed
    for axis, least in enumerate(LEAST_DIFFERENCES):
        for factor in (-1.1, -0.9, 0.9, 1.1):
            colours = factor * least * np.eye(3)[axis]
            assert differs(drawn(strip(20), tuple(colours)), drawn()) is (abs(factor) > 1)


def test_what_one_of_both_does_not_see_is_no_change() -> None:
    now, before = drawn(strip(20)), drawn()
    is_seen = np.ones_like(before.is_seen)
    is_seen[strip(20)] = False
    assert differs(now, replace(before, is_seen=is_seen)) is False
    assert differs(replace(now, is_seen=is_seen), before) is False


HAND, OTHER = (slice(10, 30), slice(10, 30)), (slice(60, 80), slice(40, 70))


@pytest.mark.parametrize(
    ("before", "gone"),
    [
        # Slopes, and which of the views show something else than now.
        ({0.01: True, 0.05: False, 0.10: False}, [0]),
        ({0.01: False, 0.05: True, 0.10: True}, [0, 1, 2]),  # most of them
        ({0.01: False, 0.05: False, 0.10: True, 0.15: True}, [2, 3]),  # half of them
        ({0.10: False, 0.01: True, 0.15: False, 0.05: True, 0.20: False}, [0, 1, 2, 3, 4]),  # the two nearest
        ({0.01: True, 0.05: False, 0.10: True, 0.15: False, 0.20: False}, [0, 2]),
        ({0.20: True}, [0]),
        ({0.20: True, 0.40: False, 0.45: False}, [0]),  # it is alone among those that now cannot be compared with
        ({0.20: True, 0.40: False, 0.45: True}, [0, 1, 2]),
        ({0.20: True, 0.40: True, 0.45: True}, [0, 1, 2]),
        ({0.30: True, 0.40: True}, []),
    ],
)
def test_all_views_are_outdated_where_most_or_the_two_nearest_are(before, gone) -> None:
    views = [drawn(OTHER if is_other else None, slope=slope) for slope, is_other in before.items()]
    assert outdated(drawn(), views) == gone


def test_from_view_to_view_it_is_told_which_of_those_far_aside_show_the_scene() -> None:
    """Seen from so far apart as two slopes that differ by more than 0.27, things shear too much to be compared."""
    at = np.array([5, 2, 7, 1, 4, 3, 6])  # in no order, as views are that replaced others
    same = [drawn(slope=0.1 * place) for place in at]
    assert outdated_with_far(drawn(), same) == []
    changed = [drawn(OTHER if place > 4 else None, slope=0.1 * place) for place in at]
    assert outdated(drawn(), changed) == []
    assert outdated_with_far(drawn(), changed) == list(np.flatnonzero(at > 4))
    for covered in at:
        hand = [drawn(HAND if place == covered else None, slope=0.1 * place) for place in at]
        assert outdated_with_far(drawn(), hand) == list(np.flatnonzero(at == covered))
    close = [drawn(OTHER if place > 4 else None, slope=0.05 * place) for place in range(1, 12)]
    assert outdated_with_far(drawn(), close) == [4, 5, 6, 7, 8, 9, 10], "each has several beside it"
    alone = drawn(slope=3.0)
    assert outdated_with_far(drawn(), [*same, drawn(OTHER, slope=3.0)]) == [], "of which nobody can tell"
    assert outdated_with_far(drawn(OTHER), [*same, alone]) == list(range(len(same) + 1)), "all are of before"


@pytest.mark.parametrize(
    ("scenes", "first"),
    [
        ((HAND, None, None, None), 1),
        ((HAND, None, None), 1),
        ((None, HAND, None), 0),
        ((HAND, HAND, None), 0),
        ((HAND, OTHER, None, None, None), 2),
        ((HAND, OTHER, None), 0),
        ((HAND, None), 0),
        ((None,), 0),
    ],
)
def test_of_several_views_the_first_is_taken_that_shows_what_most_of_them_show(monkeypatch, scenes, first) -> None:
    """Where there is none, the very first."""
    views = [paint(T_cam_marker=camera_towards((0.0, 0.0), 0.6, 45.0), size=(64, 48)).tracked for _ in scenes]
    pictures = {
        id(view): drawn(scene, slope=0.01 * at) for at, (view, scene) in enumerate(zip(views, scenes, strict=True))
    }
    monkeypatch.setattr(PlanePicture, "of", staticmethod(lambda view: pictures[id(view)]))
    assert first_of_most(views) is views[first]
    others = views[:first] + views[first + 1 :]
    of_it = of_one_scene(views[first], others)
    alike = [view for view in others if differs(pictures[id(view)], pictures[id(views[first])]) is False]
    assert [id(view) for view in of_it] == [id(view) for view in alike]
