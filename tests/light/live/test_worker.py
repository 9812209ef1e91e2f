"""The light worker's process: answers, failures, its death and its end."""

import gc
import multiprocessing
import os
import signal
import sys
import threading
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.caster import parsed_caster
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.drawing.steps_sheet import steps_sheet
from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.estimators.preset import BALANCED, FAST, ProxyPreset
from ashe_live.light.explanation.no_answer import NOTHING_THERE
from ashe_live.light.live import worker as worker_module
from ashe_live.light.live.same_scene import PlanePicture
from ashe_live.light.live.worker import LightWorker
from ashe_live.light.live.worker_messages import (
    Answered,
    Estimated,
    EstimateRequest,
    EstimateTask,
    Followed,
    OtherScene,
    Unchanged,
    WorkerFailure,
)
from ashe_live.light.live.worker_process import LOWEST_PRIORITY, HeldViews
from ashe_live.light.paper.estimator import PaperEstimator
from ashe_live.process import awake
from tests.light.painted_scenes import BOX
from tests.light.painted_scenes import paint as painted
from tests.light.synthetic_masks import camera_towards
from tests.patience import PATIENCE_S, await_that


def quick(preset: ProxyPreset = BALANCED) -> PaperEstimator:  # noqa: ARG001
    return PaperEstimator(size=(160, 120), grabcut_iterations=2)


def endless(preset: ProxyPreset) -> PaperEstimator:  # noqa: ARG001
    return PaperEstimator(grabcut_iterations=10**6)


def children() -> set[int]:
    return {child.pid for child in multiprocessing.active_children() if child.name == "ashe-live light worker"}


def wait_until_no_child_is_left() -> None:
    """A killed process is there until the system has ended it, which takes a busy machine a while."""
    await_that(lambda: not children(), "the end of a process")


@pytest.fixture(autouse=True)
def _alone() -> Iterator[None]:
    """So that a test's children are its own; none may be left behind."""
    wait_until_no_child_is_left()
    yield
    wait_until_no_child_is_left()


@pytest.fixture
def worker() -> Iterator[LightWorker]:
    with LightWorker(quick) as worker:
        yield worker


@pytest.fixture
def without_marker(scene) -> TrackedFrame:
    return TrackedFrame(Frame(scene.tracked.frame.image_bgr, 3, 0.0), scene.tracked.camera, None)


def test_it_answers_as_a_direct_call_does_however_late(worker, scene, monkeypatch):
    monkeypatch.setattr(worker_module, "LONGEST_ESTIMATE_S", 0.0)  # which is for one that is not there yet
    assert worker.wait(0.0) is None
    assert worker.request(scene.tracked)
    assert worker.busy
    assert not worker.request(scene.tracked)
    outcome, direct = worker.wait(PATIENCE_S), quick().estimate(scene.tracked)
    assert isinstance(outcome, Estimated)
    assert outcome.picture_bgr is None
    answer = outcome.estimate
    np.testing.assert_array_equal(answer.light.to_light_marker, direct.light.to_light_marker)
    np.testing.assert_array_equal(answer.object_mask, direct.object_mask)
    assert answer.frame_index == scene.tracked.frame.index
    assert not answer.light.to_light_marker.flags.writeable
    assert not worker.busy
    assert worker.wait(0.0) is None


def test_what_led_to_the_answer_is_drawn_only_when_asked_for(scene):
    with LightWorker("proxy") as worker:
        worker.request(scene.tracked, task=EstimateTask(FAST))
        assert worker.wait(PATIENCE_S).picture_bgr is None
        worker.request(scene.tracked, task=EstimateTask(FAST, steps_sheet))
        outcome = worker.wait(PATIENCE_S)
    estimate, trace = make_estimator("proxy", FAST).traced(scene.tracked)
    assert outcome.estimate.light.to_light_marker.tobytes() == estimate.light.to_light_marker.tobytes()
    np.testing.assert_array_equal(outcome.picture_bgr, steps_sheet(scene.tracked, estimate, trace))


def test_an_estimator_that_keeps_no_trace_answers_all_the_same(worker, scene):
    worker.request(scene.tracked, task=EstimateTask(BALANCED, steps_sheet))
    outcome = worker.wait(PATIENCE_S)
    assert outcome.estimate.light is not None
    assert outcome.picture_bgr is None


def test_a_picture_that_is_a_cut_out_of_another_arrives_whole(worker, scene):
    image = np.zeros((480, 1280, 3), np.uint8)[:, ::2]
    image[:] = scene.tracked.frame.image_bgr
    worker.request(TrackedFrame(Frame(image, 7, 0.0), scene.tracked.camera, scene.tracked.marker))
    direct = quick().estimate(scene.tracked)
    np.testing.assert_array_equal(worker.wait(PATIENCE_S).estimate.light.to_light_marker, direct.light.to_light_marker)


def test_an_exception_comes_back_as_a_value_and_the_worker_goes_on(worker, scene, without_marker):
    worker.request(without_marker)
    failure = worker.wait(PATIENCE_S)
    assert isinstance(failure, WorkerFailure)
    assert failure.frame_index == 3
    assert "marker" in failure.message
    assert "\n" not in failure.message
    worker.request(scene.tracked)
    assert isinstance(worker.wait(PATIENCE_S), Estimated)


def test_a_preset_that_the_estimator_cannot_use_is_reported_in_words_and_the_worker_goes_on(scene):
    with LightWorker("paper") as worker:
        worker.request(scene.tracked, task=EstimateTask(BALANCED.assuming(caster=parsed_caster("box:0.05x0.05x0.08"))))
        failure = worker.wait(PATIENCE_S)
        assert isinstance(failure, WorkerFailure)
        assert failure.message.startswith("the estimator paper makes no use of a known caster")
        assert len(children()) == 1


def test_a_killed_process_is_reported_once_and_replaced(scene, without_marker):
    with LightWorker(endless) as worker:
        worker.request(without_marker)
        worker.wait(PATIENCE_S)
        (first,) = children()
        worker.request(scene.tracked)
        os.kill(first, signal.SIGKILL)
        failure = worker.wait(PATIENCE_S)
        assert isinstance(failure, WorkerFailure)
        assert failure.frame_index == scene.tracked.frame.index
        assert worker.wait(0.0) is None
        assert not worker.busy
        assert worker.request(without_marker)
        assert isinstance(worker.wait(PATIENCE_S), WorkerFailure)
        assert children() != {first}


def test_a_process_killed_between_requests_is_replaced(worker, scene):
    (first,) = children()
    os.kill(first, signal.SIGKILL)
    wait_until_no_child_is_left()
    worker.request(scene.tracked)
    assert isinstance(worker.wait(PATIENCE_S), Estimated)


class Unreadable(str):
    """Words that nobody can unpack, as what needs more memory than there is."""

    __slots__ = ()

    def __reduce__(self):
        return refused, ()


def refused() -> str:
    raise MemoryError("no room for it")


class AnsweringUnreadably:
    name = "odd"

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked: TrackedFrame, _others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        return LightEstimate(self.name, tracked.frame.index, Illumination(), Unreadable("it is odd"))


@pytest.mark.parametrize("is_of_request", [True, False])
def test_what_cannot_be_packed_or_unpacked_is_reported_at_once_and_the_process_replaced(scene, is_of_request):
    """Not after the time that the longest estimate may take."""
    with LightWorker(quick if is_of_request else AnsweringUnreadably) as worker:
        (first,) = children()
        worker.request(scene.tracked, task=EstimateTask(BALANCED, (lambda *_: None) if is_of_request else None))
        failure = worker.wait(PATIENCE_S)
        assert isinstance(failure, WorkerFailure)
        assert failure.frame_index == scene.tracked.frame.index
        assert ("<lambda>" if is_of_request else "MemoryError: no room for it") in failure.message
        assert worker.wait(0.0) is None
        assert worker.request(scene.tracked, task=EstimateTask(BALANCED, steps_sheet))
        assert children() != {first}


def test_one_that_hangs_is_given_up_reported_once_and_replaced(scene, without_marker, monkeypatch):
    with LightWorker(endless) as worker:
        worker.request(without_marker)
        worker.wait(PATIENCE_S)
        (first,) = children()
        worker.request(scene.tracked)
        assert worker.wait(0.0) is None
        monkeypatch.setattr(worker_module, "LONGEST_ESTIMATE_S", 0.0)
        failure = worker.wait(0.0)
        monkeypatch.undo()
        assert isinstance(failure, WorkerFailure)
        assert failure.frame_index == scene.tracked.frame.index
        assert "no answer" in failure.message
        await_that(lambda: first not in children(), "the end of a process")
        assert worker.wait(0.0) is None
        assert worker.request(without_marker)
        assert isinstance(worker.wait(PATIENCE_S), WorkerFailure)


def test_one_is_still_awaited_after_all_was_suspended_for_an_hour(scene, monkeypatch):
    with LightWorker(endless) as worker:
        worker.request(scene.tracked)
        now_s = awake.now_s
        monkeypatch.setattr(awake, "now_s", lambda: now_s() + 3600.0)
        assert worker.wait(0.0) is None
        assert worker.busy
        assert worker.waited_s < 1800.0


def test_what_is_given_up_has_no_outcome_and_the_next_request_may_come_at_once(worker, scene, without_marker):
    worker.give_up()  # nothing was asked for
    assert worker.request(scene.tracked)
    worker.give_up()
    assert not worker.busy
    assert worker.wait(0.0) is None
    assert worker.request(without_marker)
    outcome = worker.wait(PATIENCE_S)
    assert isinstance(outcome, WorkerFailure)
    assert outcome.frame_index == without_marker.frame.index
    await_that(lambda: len(children()) == 1, "the end of a process")


def test_closing_ends_an_estimate_in_its_middle(scene, without_marker):
    worker = LightWorker(endless)
    worker.request(without_marker)
    assert isinstance(worker.wait(PATIENCE_S), WorkerFailure)
    worker.request(scene.tracked)
    assert worker.wait(0.2) is None
    worker.close()  # the estimate would take hours
    wait_until_no_child_is_left()
    worker.close()
    with pytest.raises(ValueError, match="closed"):
        worker.request(scene.tracked)


def test_closing_before_it_has_started_is_quiet(capfd):
    worker = LightWorker("paper")
    assert worker.takes_one_frame
    worker.close()
    wait_until_no_child_is_left()
    assert "Traceback" not in capfd.readouterr().err


def test_an_estimator_that_compares_views_is_no_estimator_of_one_frame():
    for estimator in ("proxy", quick):
        with LightWorker(estimator) as worker:
            assert not worker.takes_one_frame


def test_ctrl_c_does_not_reach_it(worker, scene, without_marker, capfd):
    worker.request(without_marker)
    worker.wait(PATIENCE_S)
    (pid,) = children()
    os.kill(pid, signal.SIGINT)
    worker.request(scene.tracked)
    assert isinstance(worker.wait(PATIENCE_S), Estimated)
    assert children() == {pid}
    assert "Traceback" not in capfd.readouterr().err


def test_an_unknown_estimator_is_refused_before_a_process_starts():
    with pytest.raises(UserError, match="paper"):
        LightWorker("no such")
    assert not children()


class Telling:
    """Answers with the indices of the frames that it was given."""

    name = "telling"

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        views = tracked.frame.index, *(other.frame.index for other in others)
        return LightEstimate(self.name, views[0], Illumination(), "it only tells", views=views)


def view(
    index: int, turned_deg: float = 0.0, light_deg: float = 200.0, is_empty: bool = False, ground: str = "plain"
) -> TrackedFrame:
    towards = camera_towards((0.02, 0.0), 0.6, 45.0, turned_deg)
    casters = () if is_empty else (BOX,)
    scene = painted(*casters, ground=ground, azimuth_deg=light_deg, T_cam_marker=towards, size=(320, 240)).tracked
    return replace(scene, frame=Frame(scene.frame.image_bgr, index, 0.0))


def answered(
    worker: LightWorker,
    frozen: TrackedFrame,
    others: Sequence[TrackedFrame],
    doubted: TrackedFrame | None = None,
    empty: TrackedFrame | None = None,
    **how: object,
) -> Answered:
    assert worker.request(frozen, others, doubted, EstimateTask(BALANCED, **how), empty)
    answer = worker.wait(PATIENCE_S)
    assert isinstance(answer, Answered)
    return answer


def test_other_views_reach_the_estimator_and_those_of_another_scene_do_not():
    with LightWorker(Telling) as worker:
        here = [view(index, 4.0 * index) for index in range(4)]
        assert answered(worker, here[0], here[1:]).estimate.views == (0, 1, 2, 3)
        other = view(4, 2.0, light_deg=20.0)
        answer = answered(worker, here[0], [here[1], other, *here[2:]])
        assert answer.estimate.views == (0, 1, 2, 3)
        assert answer.outdated == (1,)
        answer = answered(worker, other, here[:3], is_awaited=True)
        assert answer.estimate.views == (4,)
        assert answer.outdated == (0, 1, 2)


def test_a_scene_that_one_frame_shows_alone_is_estimated_only_for_a_person_who_waits():
    with LightWorker(Telling) as worker:
        here = [view(index, 4.0 * index) for index in range(3)]
        other, again = view(4, 2.0, light_deg=20.0), view(5, 5.0, light_deg=20.0)
        answer = answered(worker, other, here)
        assert isinstance(answer, OtherScene)
        assert answer.outdated == (0, 1, 2)
        doubted = view(6, 3.0, light_deg=110.0)
        assert isinstance(answered(worker, again, here, doubted), OtherScene)
        answer = answered(worker, again, here, doubted=other)
        assert answer.is_of_changed_scene
        assert answer.estimate.views == (5, 4)
        assert answer.outdated == (0, 1, 2)


class TellingHow:
    """Answers with the priority of its thread, and the number of OpenCV's."""

    name = "how"

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked: TrackedFrame, _others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        priority = os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
        return LightEstimate(self.name, tracked.frame.index, Illumination(), f"{priority} {cv2.getNumThreads()}")


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere threads have no priority of their own")
def test_an_estimate_gives_way_to_the_viewer_unless_a_person_waits_for_it():
    with LightWorker(TellingHow) as worker:
        for is_awaited, priority in ((True, os.nice(0)), (False, LOWEST_PRIORITY), (True, os.nice(0))):
            answer = answered(worker, view(0), (), is_awaited=is_awaited)
            assert answer.estimate.reason == f"{priority} 1"


class Plates:
    """Answers with whether it was given a clean plate; of a frame that is the plate, that nothing stands there."""

    name = "plates"

    def __init__(self, _preset: ProxyPreset) -> None: ...

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        views = tracked.frame.index, *(other.frame.index for other in others)
        plate = tracked.clean_plate_bgr
        is_empty = plate is not None and np.array_equal(plate, tracked.frame.image_bgr)
        reason = NOTHING_THERE if is_empty else "alone" if plate is None else "over a plate"
        return LightEstimate(self.name, views[0], Illumination(), reason, views=views)


class PlatesOfOneFrame(Plates):
    """As the paper's estimator, which makes no use of a clean plate."""

    name = "paper"


def test_an_estimator_of_one_frame_is_given_no_clean_plate():
    with LightWorker(PlatesOfOneFrame) as worker:
        answer = answered(worker, view(0), (), empty=view(1, is_empty=True))
        assert answer.estimate.reason == "alone"
        assert not answer.is_over_empty_table


def test_a_frame_is_estimated_over_the_empty_table_where_that_tells_more():
    here, empty = view(0), view(1, is_empty=True)
    with LightWorker(Plates) as worker:
        answer = answered(worker, here, (), empty=empty, is_awaited=True)
        assert answer.estimate.reason == "over a plate"
        assert answer.is_over_empty_table
        assert not answer.shows_empty_table
        # The same object stands there in both: the plate says nothing.
        answer = answered(worker, here, (), empty=replace(here, frame=Frame(here.frame.image_bgr, 2, 0.0)))
        assert answer.estimate.reason == "alone"
        assert not answer.is_over_empty_table
        # Of another table.
        answer = answered(worker, here, (), empty=view(3, is_empty=True, ground="striped"))
        assert not answer.is_over_empty_table
        # Views from other sides show more.
        answer = answered(worker, here, [view(4, 8.0), view(5, 16.0)], empty=empty)
        assert answer.estimate.views == (0, 4, 5)
        assert not answer.is_over_empty_table


def test_an_estimate_says_that_nothing_stands_there():
    with LightWorker("proxy") as worker:
        assert answered(worker, view(0, is_empty=True), ()).shows_empty_table
        assert not answered(worker, view(1), ()).shows_empty_table


def test_views_from_one_side_are_left_out_as_they_add_no_information():
    with LightWorker(Telling) as worker:
        answer = answered(worker, view(0), [view(1, 0.5)])
    assert answer.estimate.views == (0,)
    assert answer.outdated == ()


def test_what_cannot_be_compared_with_a_doubted_frame_does_not_show_that_the_scene_has_changed():
    with LightWorker(Telling) as worker:
        here = [view(index, 4.0 * index) for index in range(3)]
        now, aside = view(4, 2.0, light_deg=20.0), view(5, 120.0, light_deg=20.0)
        assert isinstance(answered(worker, now, here, doubted=aside), OtherScene)


def test_what_is_known_of_an_unchanged_scene_still_holds():
    known = LightEstimate("telling", 0, Illumination((Light((0.0, 0.3, 1.0)),)))
    with LightWorker(Telling) as worker:
        here = [view(index, 4.0 * index) for index in range(3)]
        assert isinstance(answered(worker, here[0], here[1:], held=known, follows=True), Unchanged)
        assert isinstance(answered(worker, here[0], here[1:], held=known), Estimated)
        now = view(5, light_deg=20.0)
        assert answered(worker, now, here, held=known, follows=True, is_awaited=True).estimate.views == (5,)
        assert answered(worker, now, (), held=known, follows=True).estimate.views == (5,)


def test_a_known_bodys_light_is_followed_and_where_it_is_not_seen_estimated_anew(scene):
    known = make_estimator("proxy", FAST).estimate(scene.tracked)
    assert known.illumination.real_object is not None
    elsewhere = replace(known.light, to_light_marker=-known.light.to_light_marker * (1, 1, -1))
    gone = replace(known, illumination=replace(known.illumination, lights=(elsewhere,)))
    beside = replace(scene.tracked, frame=Frame(scene.tracked.frame.image_bgr, 8, 0.1))
    with LightWorker(Telling) as worker:
        answer = answered(worker, scene.tracked, [beside], held=known, follows=True)
        assert isinstance(answer, Followed)
        assert angle_between(answer.estimate.light.to_light_marker, known.light.to_light_marker) < np.radians(3)
        answer = answered(worker, scene.tracked, [beside], held=gone, follows=True)
        assert isinstance(answer, Estimated)
        assert answer.estimate.estimator == "telling"


def test_a_view_is_sent_once_and_kept_while_requests_name_it(monkeypatch):
    sent: list[tuple[int, int]] = []
    send_value = worker_module.send_value

    def counted(connection, request) -> None:
        sent.append((len(request.numbers), len(request.new)))
        send_value(connection, request)

    monkeypatch.setattr(worker_module, "send_value", counted)
    here = [view(index, 4.0 * index) for index in range(4)]
    with LightWorker(Telling) as worker:
        for frozen, *others in ((0, 1, 2), (0, 1, 2), (3, 1, 2), (0, 3, 1)):
            answer = answered(worker, here[frozen], [here[each] for each in others])
            assert answer.estimate.views == (frozen, *others)
    assert sent == [(3, 3), (3, 0), (3, 1), (3, 1)]


def test_a_view_that_a_request_no_longer_names_is_let_go_with_its_picture_of_the_plane(monkeypatch) -> None:
    """As a window may be open for hours."""
    held, images, planes, made = HeldViews(), [], [], PlanePicture.of

    def noted(tracked: TrackedFrame) -> PlanePicture:
        plane = made(tracked)
        planes.append((tracked.frame.index, weakref.ref(plane.colours)))
        return plane

    monkeypatch.setattr(PlanePicture, "of", noted)
    for numbers in ((0, 1), (2, 1), (3, 2)):
        new = {number: view(number, 4.0 * number) for number in numbers if number >= len(images)}
        images += [weakref.ref(tracked.frame.image_bgr) for tracked in new.values()]
        held.take(EstimateRequest(numbers, None, None, new, EstimateTask(BALANCED)))
        held.outdated()
        del new
        gc.collect()
        assert {number for number, image in enumerate(images) if image() is not None} == set(numbers)
        assert {number for number, plane in planes if plane() is not None} == set(numbers)
    assert len(planes) == 4, "of each view one is made, and used again"
