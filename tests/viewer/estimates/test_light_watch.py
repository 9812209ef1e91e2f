"""The light of a painted table, watched with the real worker: sharpened by views, followed, and found anew."""

import math
from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, direction_from_angles, rigid
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.live.key_views import RENEWED_AFTER_S
from ashe_live.light.live.worker import LightWorker
from ashe_live.light.live.worker_messages import OtherScene, WorkerFailure
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.preset import BALANCED
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.estimates.light_watch import LightWatch
from ashe_live.viewer.estimates.sharpening import EVERY_S, FUTILE
from tests.patience import PATIENCE_S

SIDES_DEG = (-100, -97, -94, -91, -88)


@pytest.fixture(scope="module")
def table(picture_of_box) -> dict[float, list[TrackedFrame]]:
    """The table from several sides, in the light of two azimuths."""
    tracker = MarkerTracker(parse_marker("aruco:4x4_50:0"), Camera.from_hfov((640, 480), 55), 0.08, BALANCED)
    frames: dict[float, list[TrackedFrame]] = {}
    for light_deg in (200.0, 60.0):
        frames[light_deg] = []
        for side_deg in SIDES_DEG:
            tracker.reset()
            frames[light_deg].append(tracker.track(Frame(picture_of_box(side_deg, light_deg), 0, 0.0)))
    return frames


@pytest.fixture
def watch() -> Iterator[LightWatch]:
    with LightWorker("proxy") as worker:
        watch = LightWatch(worker)
        watch.preset = FAST
        yield watch


class Clock:
    """Frames with numbers and times of their own, a second apart."""

    def __init__(self) -> None:
        self.count = 0

    def now(self, tracked: TrackedFrame) -> tuple[TrackedFrame, float]:
        self.count += 1
        return replace(tracked, frame=Frame(tracked.frame.image_bgr, self.count, float(self.count))), float(self.count)


def error_deg(watch: LightWatch, light_deg: float) -> float:
    truth = direction_from_angles(np.radians(light_deg), np.radians(42))
    return math.degrees(angle_between(watch.held.estimate.light.to_light_marker, truth))


def test_an_answer_is_sharpened_then_followed_and_a_changed_light_replaces_it(watch, table) -> None:
    clock = Clock()
    first, now_s = clock.now(table[200.0][0])
    watch.key_views.add(first)
    assert watch.ask(first, now_s)
    watch.wait(PATIENCE_S)
    alone = watch.held.estimate
    assert alone.views == (first.frame.index,)
    assert not watch.sharpen(first, now_s + 10, None), "there is nothing new to look at"

    sharpened = 0
    for tracked in table[200.0][1:]:
        seen, now_s = clock.now(tracked)
        watch.key_views.add(seen)
        if watch.sharpen(seen, now_s, None):
            watch.wait(PATIENCE_S)
            sharpened += 1
    assert sharpened >= 2
    assert error_deg(watch, 200.0) < 10

    assert watch.sharpening.is_settled
    before = watch.held.estimate
    seen, now_s = clock.now(table[200.0][0])
    seen, now_s = clock.now(table[200.0][0])
    assert watch.look_again(seen, now_s, None)
    watch.wait(PATIENCE_S)
    assert watch.held.estimate is before, "an unchanged light is looked for, and stays"

    views_before = watch.key_views.views
    for _ in range(5):
        seen, now_s = clock.now(table[60.0][0])
        watch.key_views.add(seen)
        if watch.sharpen(seen, now_s, None) or watch.look_again(seen, now_s, None):
            watch.wait(PATIENCE_S)
    assert error_deg(watch, 60.0) < 10
    assert not any(view is old for view in watch.key_views.views for old in views_before)


def seen_from_all_sides(watch: LightWatch, frames: list[TrackedFrame], clock: Clock) -> TrackedFrame:
    """The last of the frames, which are the key views of an answer."""
    for tracked in frames:
        seen, now_s = clock.now(tracked)
        watch.key_views.add(seen)
    assert watch.ask(seen, now_s)
    watch.wait(PATIENCE_S)
    return seen


def test_a_light_that_goes_out_is_noticed_by_the_second_frame_without_it(watch, table, picture_of_box) -> None:
    clock = Clock()
    seen = seen_from_all_sides(watch, table[200.0], clock)
    assert watch.held.estimate.light is not None
    # From straight above there is no shadow to be seen.
    dark = replace(seen, frame=Frame(picture_of_box(SIDES_DEG[-1], 200.0, 89.9), 0, 0.0))
    for is_noticed in (False, True):
        seen, now_s = clock.now(dark)
        assert watch.sharpen(seen, now_s, None) or watch.look_again(seen, now_s, None)
        watch.wait(PATIENCE_S)
        assert (watch.held.estimate.light is None) is is_noticed
    assert watch.key_views.views == ()


def test_a_watched_light_is_looked_at_soon_where_the_picture_becomes_darker_at_once(watch, table) -> None:
    clock = Clock()
    first, now_s = clock.now(table[200.0][0])
    assert watch.ask(first, now_s)
    watch.wait(PATIENCE_S)
    while not watch.sharpening.is_settled:
        seen, now_s = clock.now(table[200.0][0])
        if watch.look_again(seen, now_s, None):
            watch.wait(PATIENCE_S)
    assert not watch.look_again(seen, now_s + 2 * EVERY_S, None)
    dimmed = replace(seen, frame=Frame((0.8 * seen.frame.image_bgr).astype(np.uint8), 99, 0.0))
    assert not watch.look_again(dimmed, now_s + 0.5 * EVERY_S, None)
    assert watch.look_again(dimmed, now_s + 2 * EVERY_S, None)
    watch.wait(PATIENCE_S)
    assert not watch.look_again(dimmed, now_s + 4 * EVERY_S, None), "it has been looked at"


def test_views_from_before_are_not_asked_about_while_something_has_changed(watch, table) -> None:
    """They would bring back what has gone."""
    clock = Clock()
    seen_from_all_sides(watch, table[200.0][:2], clock)
    other, now_s = clock.now(table[60.0][0])
    assert watch.look_again(other, now_s, None)
    watch.wait(PATIENCE_S)
    watch.key_views.add(clock.now(table[200.0][3])[0])
    watch.key_views.add(clock.now(table[200.0][4])[0])
    assert not watch.sharpen(other, now_s + 0.5 * EVERY_S, None)
    seen, later_s = clock.now(table[60.0][0])
    assert watch.sharpen(seen, later_s, None)
    assert watch._frozen is seen


def with_hand(seen: TrackedFrame, elbow: tuple[int, int] = (700, 500)) -> TrackedFrame:
    """The frame with an arm in it."""
    picture = np.array(seen.frame.image_bgr)
    cv2.line(picture, elbow, (330, 130), (40, 50, 75), 170, cv2.LINE_AA)
    return replace(seen, frame=Frame(picture, 0, 0.0))


def test_a_hand_that_passes_costs_neither_the_light_nor_the_views(watch, table, monkeypatch) -> None:
    clock, outcomes, wait = Clock(), [], watch._worker.wait
    monkeypatch.setattr(watch._worker, "wait", lambda timeout_s: outcomes.append(wait(timeout_s)) or outcomes[-1])
    seen = seen_from_all_sides(watch, table[200.0], clock)
    light, views = watch.held.estimate, watch.key_views.views
    assert len(light.views) > 2

    for tracked in (with_hand(seen), with_hand(seen, (0, 300)), table[200.0][2]):
        seen, now_s = clock.now(tracked)
        assert watch.sharpen(seen, now_s, None) or watch.look_again(seen, now_s, None)
        watch.wait(PATIENCE_S)
        assert isinstance(outcomes[-1], OtherScene) == (tracked is not table[200.0][2])
        assert watch.key_views.views == views
        assert error_deg(watch, 200.0) < 10
    seen, now_s = clock.now(table[200.0][2])
    assert not watch.sharpen(seen, now_s, None), "the hand has gone"


def test_a_view_with_a_hand_is_dropped_once_the_hand_has_gone(watch, table) -> None:
    clock = Clock()
    first, now_s = clock.now(table[200.0][0])
    watch.key_views.add(first)
    assert watch.ask(first, now_s)
    watch.wait(PATIENCE_S)
    hand, now_s = clock.now(with_hand(table[200.0][2]))
    assert watch.key_views.add(hand)
    assert watch.sharpen(hand, now_s, None)
    watch.wait(PATIENCE_S)
    seen, now_s = clock.now(table[200.0][1])
    assert watch.sharpen(seen, now_s, None), "to see what has become of it"
    watch.wait(PATIENCE_S)
    assert watch.key_views.views == (first,)
    assert error_deg(watch, 200.0) < 10


def test_what_the_user_asks_meanwhile_is_answered_in_the_place_of_the_estimate_in_progress(watch, table) -> None:
    clock = Clock()
    (first, first_s), (asked, asked_s) = clock.now(table[200.0][0]), clock.now(table[200.0][1])
    assert watch.ask_in_background(first, first_s)
    assert watch.ask(asked, asked_s)
    assert watch.is_awaited
    outcome = watch.wait(PATIENCE_S)
    assert outcome is not None
    assert outcome.estimate.frame_index == asked.frame.index


def test_who_leans_in_until_object_and_shadow_are_out_of_view_loses_no_light(watch, table) -> None:
    clock = Clock()
    seen = seen_from_all_sides(watch, table[200.0], clock)
    before = watch.held.estimate
    assert before.light is not None
    T = seen.marker.T_cam_marker.copy()
    T[:3, 3] *= 0.25  # so near to the marker that nothing else is in the picture
    leant_in = replace(seen, marker=replace(seen.marker, T_cam_marker=T))
    for _ in range(20):
        near, now_s = clock.now(leant_in)
        assert not watch.look_again(near, now_s, None)
        assert not watch.sharpen(near, now_s, None)
    assert watch.held.estimate is before
    assert watch.ask(near, now_s), "who asks for it gets an answer"
    watch.wait(PATIENCE_S)


def answered(watch: LightWatch, estimate: LightEstimate, outdated: tuple[int, ...] = ()) -> None:
    """The stand-in for the worker answers so."""
    watch._worker.answer, watch._worker.outdated = estimate, outdated
    watch.wait(0.0)


def test_another_scene_begins_without_views_doubts_and_empty_table_of_the_one_before(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(1), fakes.tracked(2))
    watch.show_empty_table(fakes.tracked(0))
    assert watch.ask(fakes.tracked(3), 0.0)
    answered(watch, fakes.estimate(3))
    assert watch.ask_in_background(fakes.tracked(4), 1.0)
    answered(watch, fakes.estimate(4), (0, 1))
    assert watch.ask_in_background(fakes.tracked(5), 2.0)
    assert (len(worker.others), worker.doubted.frame.index, worker.empty.frame.index) == (2, 4, 0)

    watch.begin_anew()
    assert not watch.is_estimating
    assert watch.held.estimate is None
    assert watch.ask(fakes.tracked(6), 3.0)
    assert (worker.others, worker.doubted, worker.empty) == ((), None, None)


def test_views_by_another_focal_length_or_of_the_marker_elsewhere_are_not_asked_about(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    seen, zoomed, elsewhere, asked = (replace(fakes.tracked(index), T_room_marker=np.eye(4)) for index in range(4))
    zoomed = replace(zoomed, camera=Camera.from_hfov(seen.camera.size, 40))
    elsewhere = replace(elsewhere, T_room_marker=rigid(np.eye(3), (0.1, 0, 0)))
    watch.key_views = fakes.KeyViews(seen, zoomed, elsewhere, asked)
    assert watch.ask(asked, 0.0)
    assert worker.others == (seen,)


def test_a_doubted_frame_by_another_focal_length_or_of_the_marker_elsewhere_tells_nothing(fakes) -> None:
    seen = replace(fakes.tracked(5), T_room_marker=np.eye(4))
    zoomed = replace(seen, camera=Camera.from_hfov(seen.camera.size, 40))
    elsewhere = replace(seen, T_room_marker=rigid(np.eye(3), (0.1, 0, 0)))
    for after, tells in ((seen, True), (zoomed, False), (elsewhere, False)):
        watch = LightWatch(worker := fakes.Worker())
        watch.key_views = fakes.KeyViews(replace(fakes.tracked(1), T_room_marker=np.eye(4)))
        assert watch.ask_in_background(replace(fakes.tracked(2), T_room_marker=np.eye(4)), 0.0)
        answered(watch, fakes.estimate(2), (0,))
        assert watch.ask_in_background(after, 1.0)
        assert (worker.doubted is not None) is tells


def test_what_is_in_progress_is_told_from_what_a_person_waits_for(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    assert (watch.is_estimating, watch.is_awaited) == (False, False)
    assert watch.how_it_gets_known == "Space estimates it"
    assert watch.ask_in_background(fakes.tracked(1), 0.0)
    assert (watch.is_estimating, watch.is_awaited) == (True, False)
    assert watch.how_it_gets_known == "it is being estimated"
    assert watch.ask(asked := fakes.tracked(2), 1.0), "it is given up for a person"
    assert (watch.is_estimating, watch.is_awaited) == (True, True)
    assert worker.requested[-1] is asked
    worker.waited_s = 7.5
    assert watch.waited_s == 7.5
    answered(watch, fakes.estimate(2))
    assert (watch.is_estimating, watch.is_awaited) == (False, False)


def test_a_request_that_failed_is_made_again_as_awaited_until_it_has_failed_too_often(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    assert not watch.sharpen(fakes.tracked(0), 0.0, None), "there is no answer to refine"
    assert watch.ask(fakes.tracked(0), 0.0)
    awaited = []
    for now_s in range(1, 6):
        worker.answer = failure = WorkerFailure(0, "odd")
        assert watch.wait(0.0) is failure
        assert watch.look_again(fakes.tracked(now_s), 10.0 * now_s, None)
        awaited.append(watch.is_awaited)
    assert awaited == [True] * (FUTILE - 1) + [False] * (6 - FUTILE)


def settled(watch: LightWatch, fakes, light: LightEstimate) -> None:
    """Further estimates of the key views gain nothing."""
    for now_s in range(FUTILE + 1):
        assert watch.ask_in_background(fakes.tracked(now_s), float(now_s))
        answered(watch, light)
    assert watch.sharpening.is_settled


def test_a_light_that_is_followed_is_the_answer_once_it_has_moved(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(90), fakes.tracked(91))
    settled(watch, fakes, known := fakes.estimate(1, sigma_rad=0.001))
    worker.follows = True
    for now_s, towards, is_moved in ((20.0, (1.0, 0.001, 1.0), False), (25.0, (1.0, 0.2, 1.0), True)):
        assert watch.look_again(fakes.tracked(20), now_s, None)
        worker.answer = followed = fakes.estimate(20, towards=towards)
        answer = watch.wait(0.0)
        assert (answer is not None) is is_moved
        assert watch.held.estimate is (followed if is_moved else known)
    assert answer.is_news
    assert answer.estimate is followed


def test_a_light_is_only_followed_for_half_a_minute_after_it_was_estimated_or_followed(fakes) -> None:
    """By then the sun may have moved, and what it was found by with it."""
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(90), fakes.tracked(91))
    settled(watch, fakes, light := fakes.estimate(1))
    worker.follows = True
    now_s = 0.0
    for after_s, is_followed in ((0.9, True), (0.9, True), (1.1, False)):
        now_s += after_s * RENEWED_AFTER_S
        assert watch.look_again(fakes.tracked(20), now_s, None)
        assert (worker.known[-1] is not None) is is_followed
        answered(watch, light)


def test_the_newest_key_view_is_looked_at_with_the_others(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    assert watch.ask(fakes.tracked(1), 0.0)
    answered(watch, fakes.estimate(1))
    *others, newest = views = [fakes.tracked(index, tilt_deg=10 * index) for index in range(2, 6)]
    watch.key_views = fakes.KeyViews(*views)
    assert watch.sharpen(fakes.tracked(9), 1.0, None)
    assert worker.requested[-1] is newest
    assert list(worker.others) == others


def test_while_a_hand_rests_there_the_views_are_kept(fakes) -> None:
    """A changed scene without a light may be one with a hand in it; with one, it is another scene."""
    for with_light in (False, True):
        watch = LightWatch(fakes.Worker())
        watch.key_views = fakes.KeyViews(*(views := (fakes.tracked(1), fakes.tracked(2))))
        assert watch.ask(fakes.tracked(3), 0.0)
        answered(watch, fakes.estimate(3))
        for index in (4, 5):  # that shows another scene, which the second one confirms
            assert watch.look_again(fakes.tracked(index), float(index), None)
            answered(watch, fakes.estimate(index, with_light, towards=(-1.0, 0.0, 1.0)), (0, 1))
            if index == 4:
                before = watch.sharpening
        assert (watch.sharpening is before) is not with_light
        assert watch.held.is_news is with_light
        assert watch.key_views.views == (() if with_light else views)


def test_what_a_person_asked_for_stands_whatever_was_known(fakes) -> None:
    watch = LightWatch(fakes.Worker())
    for now_s, towards in enumerate(((1.0, 0.0, 1.0), (-1.0, 0.0, 1.0))):
        assert watch.ask(fakes.tracked(now_s), float(now_s))
        answered(watch, light := fakes.estimate(now_s, towards=towards))
        assert watch.held.estimate is light
        assert watch.held.is_news


def test_the_same_views_are_looked_at_once_where_the_scene_is_the_same(fakes) -> None:
    watch = LightWatch(fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(1), fakes.tracked(2, tilt_deg=40))
    assert watch.ask(fakes.tracked(3), 0.0)
    answered(watch, fakes.estimate(3))
    assert not watch.sharpen(fakes.tracked(4), 10.0, None)


def test_estimates_are_made_often_as_long_as_they_gain_something_or_contradict_one_another(fakes) -> None:
    watch = LightWatch(fakes.Worker())
    sharper = [fakes.estimate(index, sigma_rad=0.1 * 0.8**index) for index in range(FUTILE + 2)]
    alike = [sharper[-1]] * FUTILE
    other = fakes.estimate(9, towards=(-1.0, 0.0, 1.0))
    settles = [False] * len(sharper) + [False] * (FUTILE - 1) + [True] + [False]
    for now_s, (estimate, is_settled) in enumerate(zip((*sharper, *alike, other), settles, strict=True)):
        assert watch.ask_in_background(fakes.tracked(now_s), float(now_s))
        answered(watch, estimate)
        assert watch.sharpening.is_settled is is_settled


@pytest.mark.parametrize("is_followed", [True, False])
def test_a_view_that_shows_another_scene_is_dropped_and_a_doubt_with_it(is_followed, fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(90), other := fakes.tracked(91))
    settled(watch, fakes, light := fakes.estimate(1))
    worker.follows = True
    if not is_followed:
        assert watch.look_again(fakes.tracked(20), 20.0, None)
        answered(watch, light, (0, 1))
        assert watch.sharpen(fakes.tracked(21), 21.0, None), "to see what has become of it"
        assert worker.doubted.frame.index == 20
    else:
        assert watch.look_again(fakes.tracked(21), 20.0, None)
    answered(watch, light, (0,))
    assert watch.key_views.views == (other,)
    assert watch.look_again(fakes.tracked(22), 25.0, None)
    assert worker.doubted is None


def test_a_light_that_was_found_over_the_empty_table_stays_so_while_it_is_followed(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(90), fakes.tracked(91))
    worker.is_over_empty_table = True
    settled(watch, fakes, fakes.estimate(1, sigma_rad=0.001))
    worker.follows, worker.is_over_empty_table = True, False
    for now_s, towards in ((20.0, (1.0, 0.2, 1.0)), (25.0, (1.0, 0.4, 1.0))):
        assert watch.look_again(fakes.tracked(20), now_s, None)
        worker.answer = fakes.estimate(20, towards=towards, sigma_rad=0.001)
        assert watch.wait(0.0).is_over_empty_table
    assert watch.ask(fakes.tracked(30), 30.0)
    worker.answer = fakes.estimate(30)
    assert not watch.wait(0.0).is_over_empty_table


def test_the_empty_table_is_asked_for_only_where_it_may_be_shown_to_some_use(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    assert not watch.may_show_empty_table, "the camera of a clip is not moved any more"
    watch.camera_may_move = True
    assert watch.may_show_empty_table
    worker.takes_one_frame = True
    assert not watch.may_show_empty_table
    assert watch.show_empty_table(fakes.tracked(1)) == "this estimator makes no use of the empty table"
    worker.takes_one_frame, watch.is_photo = False, True
    assert "takes a photo of the empty table" in watch.show_empty_table(fakes.tracked(1))
    watch.is_photo, seen = False, fakes.tracked(1)
    body = Proxy("box", np.zeros((1, 5)))
    on_cube = replace(seen, marker=replace(seen.marker, body=body))
    assert "the paper cube" in watch.show_empty_table(on_cube)
    assert watch.empty_table.frame is None
    assert watch.may_show_empty_table
    watch.show_empty_table(seen)
    assert not watch.may_show_empty_table, "it is known"


def test_a_second_request_of_who_waits_already_changes_nothing(fakes) -> None:
    worker = fakes.Worker()
    watch = LightWatch(worker)
    assert watch.ask(fakes.tracked(1), 0.0)
    asked = watch.sharpening
    assert not watch.ask(fakes.tracked(2), 1.0)
    assert watch.sharpening is asked
    assert len(worker.requested) == 1
    answered(watch, fakes.estimate(1))
    assert watch.ask(fakes.tracked(3), 2.0)
    assert watch.sharpening is not asked, "another request may gain something again"


@pytest.mark.parametrize(("estimator", "gains"), [("proxy", True), ("paper", False)])
def test_an_estimator_of_one_frame_is_not_asked_about_further_views(estimator, gains, fakes) -> None:
    watch = LightWatch(fakes.Worker())
    assert watch.ask(fakes.tracked(1), 0.0)
    answered(watch, replace(fakes.estimate(1), estimator=estimator))
    watch.key_views = fakes.KeyViews(fakes.tracked(2), fakes.tracked(3, tilt_deg=20))
    assert watch.sharpen(fakes.tracked(4), 1.0, None) is gains


def test_of_the_empty_table_it_is_said_what_to_do_next_and_without_a_marker_nothing_is_kept(fakes) -> None:
    watch = LightWatch(fakes.Worker())
    for tracked in (None, fakes.tracked(0, has_marker=False)):
        assert watch.show_empty_table(tracked) == "no marker in view"
        assert watch.empty_table.frame is None
    assert "in another frame of this view" in watch.show_empty_table(fakes.tracked(1)), "of a clip"
    watch.camera_may_move = True
    assert "put the object there" in watch.show_empty_table(fakes.tracked(2))


def test_only_a_frame_in_which_nothing_stands_on_the_table_serves_as_the_empty_one(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    assert watch.ask(fakes.tracked(1), 0.0)
    answered(watch, fakes.estimate(1))
    assert watch.ask(fakes.tracked(2), 1.0)
    assert worker.empty is None
    worker.shows_empty_table = True
    answered(watch, fakes.estimate(2, with_light=False))
    assert watch.ask(fakes.tracked(3), 2.0)
    assert worker.empty.frame.index == 2


def test_a_frame_of_another_scene_is_no_view_of_this_one_and_then_the_light_is_not_only_followed(fakes) -> None:
    watch = LightWatch(worker := fakes.Worker())
    watch.key_views = fakes.KeyViews(first := fakes.tracked(1), other := fakes.tracked(2))
    for now_s in range(4):  # until further estimates gain nothing
        assert watch.ask_in_background(first, now_s)
        answered(watch, fakes.estimate(1))
    assert watch.sharpening.is_settled
    full_size = replace(other)  # of which the view is a smaller copy
    assert watch.look_again(full_size, 10.0, None)
    assert worker.known[-1] is not None, "it is only followed"
    answered(watch, fakes.estimate(2), (0,))
    assert watch.key_views.views == (first,)
    assert watch.look_again(fakes.tracked(3), 20.0, None)
    assert worker.known[-1] is None
    assert worker.doubted is full_size


def test_in_a_changed_scene_the_views_begin_to_count_anew(fakes) -> None:
    """However widely the one before was seen."""
    watch = LightWatch(fakes.Worker())
    watch.key_views = fakes.KeyViews(fakes.tracked(1), fakes.tracked(2, tilt_deg=40))
    assert watch.ask(fakes.tracked(3), 0.0)
    answered(watch, fakes.estimate(3))
    for index in (4, 5):
        assert watch.look_again(fakes.tracked(index), float(index), None)
        answered(watch, fakes.estimate(index, towards=(-1.0, 0.0, 1.0)), (0, 1))
    assert watch.held.is_news
    watch.key_views = fakes.KeyViews(fakes.tracked(6), fakes.tracked(7, tilt_deg=10))
    assert watch.sharpen(fakes.tracked(8), 8.0, None)
