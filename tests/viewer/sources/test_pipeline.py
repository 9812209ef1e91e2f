"""The capture thread: pace, end, pause, restart, loss and shutdown. Everything is awaited, nothing slept for."""

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.capture.sources import SourceLost
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.process.mailbox import Closed
from ashe_live.quality import ACCURATE, FAST
from ashe_live.viewer.sources import capture_loop
from ashe_live.viewer.sources import pipeline as pipeline_module
from ashe_live.viewer.sources.capture_loop import PHOTO_FPS, CaptureLoop
from ashe_live.viewer.sources.pace import FALLEN_BEHIND_S
from ashe_live.viewer.sources.pipeline import Pipeline
from tests.patience import PATIENCE_S, await_that

A_WHILE_S = 0.15  # many frames long at 200 a second


class Gate:
    """A hook that holds a source's reads, or a tracker, until it is opened."""

    def __init__(self) -> None:
        self.reached, self.opened = threading.Event(), threading.Event()

    def __call__(self, _read_or_tracked: object) -> None:
        self.reached.set()
        self.opened.wait(PATIENCE_S)


def indices(pipeline: Pipeline, until: int) -> list[int]:
    """Of the frames taken, up to and with the first from `until` on; some may have been overtaken by the next."""
    taken: list[int] = []
    while not taken or taken[-1] < until:
        tracked = pipeline.frames.take(PATIENCE_S)
        assert tracked is not None
        taken.append(tracked.frame.index)
    return taken


def assert_settles(pipeline: Pipeline, at: int) -> None:
    """Frame `at` comes, and no other after it."""
    tracked = None
    while tracked is None or tracked.frame.index != at:
        tracked = pipeline.frames.take(PATIENCE_S)
        assert tracked is not None
    assert pipeline.frames.take(A_WHILE_S) is None


def pause(pipeline: Pipeline, tracker) -> None:
    """Pauses it while a frame is tracked, and takes that one: before another the capture thread looks at what to do."""
    gate = Gate()
    tracker.hook = gate
    assert gate.reached.wait(PATIENCE_S)
    pipeline.frames.take(0.0)  # the one before, if nobody has taken it
    pipeline.pause(True)
    tracker.hook = lambda _frame: None
    gate.opened.set()
    assert pipeline.frames.take(PATIENCE_S) is not None


@pytest.fixture
def make(fakes) -> Iterator[Callable[..., Pipeline]]:
    """Makes a pipeline, and closes it in the end."""
    with ExitStack() as stack:

        def make(source, loop: bool = False, tracker=None, tracker_for=None) -> Pipeline:
            pipeline = Pipeline(source, tracker or fakes.Tracker(), loop, tracker_for)
            stack.callback(pipeline.close)
            return pipeline

        yield make


@pytest.fixture
def run(make) -> Callable[..., Pipeline]:
    """Makes a pipeline and starts it."""

    def run(source, **options) -> Pipeline:
        pipeline = make(source, **options)
        pipeline.start()
        return pipeline

    return run


@pytest.fixture
def clock(monkeypatch) -> SimpleNamespace:
    """The capture thread's clock, which only its waits and the test move."""
    clock = SimpleNamespace(now=0.0, monotonic=lambda: clock.now)

    def wait(_loop: CaptureLoop, _until: object, timeout_s: float | None = None) -> None:
        clock.now += timeout_s or 0.0

    monkeypatch.setattr(capture_loop, "time", clock)
    monkeypatch.setattr(CaptureLoop, "_wait", wait)
    return clock


def stepped(pipeline: Pipeline, times: int) -> list[int | None]:
    """What is shown after each of so many steps of the capture thread, made in the test's own: a frame, or nothing."""
    shown = []
    for _ in range(times):
        pipeline._capture.step()
        tracked = pipeline.frames.take(0.0)
        shown.append(None if tracked is None else tracked.frame.index)
    return shown


@pytest.mark.parametrize("kind", ["Source", "Clip"])
def test_frames_come_in_order_and_the_end_holds(run, fakes, kind):
    source, read = getattr(fakes, kind)(6), list[int]()
    source.hook = read.append
    pipeline = run(source)
    taken = indices(pipeline, until=5)
    assert taken == sorted(taken)
    await_that(lambda: pipeline.status is not None)
    assert "R starts it again" in pipeline.status
    assert pipeline.frames.take(A_WHILE_S) is None
    assert not pipeline.frames.is_closed
    assert read.count(6) == 1, "nobody looks again and again whether there is more"


def test_the_last_frame_is_shown_however_late(make, fakes, clock):
    """It stays on screen. Where the others are late too, they are left out."""
    source = fakes.Source(4, fps=200.0)

    def be_late(_index: int) -> None:
        clock.now += 0.01

    source.hook = be_late
    assert stepped(make(source), 5) == [0, None, None, None, 3]


def test_no_picture_is_made_of_a_clip_s_frames_that_are_late_already(make, fakes, clock):
    """Tracking takes 32 ms, and frames come every 5 ms: those between are passed over, and the pace is the clip's."""
    source, tracker = fakes.Clip(20, fps=200.0), fakes.Tracker()
    read = []
    source.hook = read.append

    def take_time(_frame: object) -> None:
        clock.now += 0.032

    tracker.hook = take_time
    shown = stepped(make(source, tracker=tracker), 20)
    assert [index for index in shown if index is not None] == read == [0, 6, 12, 19]


def test_restart_begins_anew_also_at_the_end(run, fakes):
    source, tracker = fakes.Source(4), fakes.Tracker()
    pipeline = run(source, tracker=tracker)
    indices(pipeline, until=3)
    await_that(lambda: pipeline.status is not None)
    taken = threading.Event()
    source.hook = lambda index: index < 3 or taken.wait(PATIENCE_S)  # else the last may overtake all before it
    pipeline.restart()
    assert pipeline.frames.take(PATIENCE_S).frame.index < 3
    taken.set()
    indices(pipeline, until=3)
    assert source.rewinds == tracker.resets == 1


def test_a_loop_goes_round(run, fakes):
    source, tracker = fakes.Source(3), fakes.Tracker()
    pipeline = run(source, loop=True, tracker=tracker)
    for _ in range(3):
        indices(pipeline, until=2)
    assert source.rewinds >= 2
    assert tracker.resets >= 2
    assert pipeline.status is None


def test_every_round_of_a_short_clip_is_shown_whole(make, fakes, clock):
    """Its first frame is due a period after the last of the round before."""
    pipeline = make(fakes.Clip(4, fps=32.0), loop=True)
    assert stepped(pipeline, 15) == [0, 1, 2, 3, None] * 3
    assert clock.now == 11 / 32


def test_a_clip_that_ends_early_says_so_at_its_end(run, fakes):
    source = fakes.Source(3)
    source.note = "the clip is truncated"
    pipeline = run(source)
    await_that(lambda: pipeline.status is not None)
    assert pipeline.status == "the clip is truncated"


def test_a_looped_clip_still_reports_that_it_is_damaged(run, fakes):
    source = fakes.Source(3)
    source.note = "the clip is truncated"
    pipeline = run(source, loop=True)
    await_that(lambda: source.rewinds >= 2)
    indices(pipeline, until=2)
    assert pipeline.status == "the clip is truncated"


def test_of_a_looped_clip_that_was_mended_it_is_no_longer_said_that_it_is_damaged(run, fakes):
    """Once it is started again, and not only at its end."""
    source = fakes.Clip(3)
    source.note = "the clip is truncated"
    pipeline = run(source, loop=True)
    await_that(lambda: pipeline.status is not None)
    source._count = 10_000  # first, so that no round ends from now on
    source.note = None
    pipeline.restart()
    await_that(lambda: pipeline.status is None)


def test_a_looped_photo_is_read_once(run, fakes):
    source = fakes.Source(1, fps=None, is_photo=True)
    pipeline = run(source, loop=True)
    indices(pipeline, until=0)
    assert pipeline.frames.take(A_WHILE_S) is None
    assert source.reads <= 2
    assert pipeline.status is None


def test_what_a_photo_has_to_say_stays_on_the_screen(run, fakes):
    """That it is the first picture of an animation: without it the window seems to have stopped."""
    source = fakes.Source(1, fps=None, is_photo=True)
    source.note = "it is an animation"
    pipeline = run(source)
    await_that(lambda: pipeline.status is not None)
    assert pipeline.status == "it is an animation"


def test_pause_holds_and_goes_on_where_it_was(run, fakes):
    source, tracker = fakes.Source(10_000), fakes.Tracker()
    pipeline = run(source, tracker=tracker)
    indices(pipeline, until=0)
    pause(pipeline, tracker)
    next_index = source.reads
    assert pipeline.frames.take(A_WHILE_S) is None
    assert source.reads == next_index
    taken = threading.Event()
    source.hook = lambda index: index == next_index or taken.wait(PATIENCE_S)  # else those after it may overtake it
    pipeline.pause(False)
    assert pipeline.frames.take(PATIENCE_S).frame.index == next_index
    taken.set()


def test_restart_while_paused_shows_the_first_frame_and_stays_paused(run, fakes):
    tracker = fakes.Tracker()
    pipeline = run(fakes.Source(10_000), tracker=tracker)
    indices(pipeline, until=5)
    pause(pipeline, tracker)
    pipeline.restart()
    assert pipeline.frames.take(PATIENCE_S).frame.index == 0
    assert pipeline.frames.take(A_WHILE_S) is None


@pytest.mark.parametrize("is_live", [False, True])
def test_while_paused_the_frame_is_seen_anew_as_another_tracker_sees_it(make, fakes, is_live):
    """Nothing of what the tracker before saw is shown any more, and no other frame comes."""
    asked: list[object] = []

    def tracker_for(*what: object) -> object:
        asked.append(what)
        return fakes.Tracker()

    source = fakes.Source(10_000, is_live=True) if is_live else fakes.Clip(10_000)
    pipeline = make(source, tracker_for=tracker_for)
    if is_live:
        source.hook = lambda index: pipeline.pause(True) if index == 5 else None
    else:
        pipeline.pause(True)
        pipeline.seek(5 / source.fps)
    pipeline.start()
    assert_settles(pipeline, at=5)
    pipeline.see_by(50.0)
    assert_settles(pipeline, at=5)
    pipeline.follow("cube")
    assert_settles(pipeline, at=5)
    assert asked == [(None, 50.0), ("cube", 50.0)]


@pytest.fixture
def asked_meanwhile(run, fakes) -> Callable[[int, int], Pipeline]:
    """A clip of so many frames, of which another marker is asked for while one of them is tracked for the first.

    The notes of frames say by which marker they were tracked.
    """
    first, second = fakes.Tracker(), fakes.Tracker()
    first.note, second.note = "by the first", "by the second"

    def asked(frames: int, at: int) -> Pipeline:
        gate = Gate()
        first.hook = lambda frame: frame.index >= at and gate(at)  # one that comes late may be passed over
        pipeline = run(fakes.Clip(frames), tracker=first, tracker_for=lambda _spec, _hfov_deg: second)
        assert gate.reached.wait(PATIENCE_S)
        pipeline.follow("cube")
        gate.opened.set()
        return pipeline

    return asked


def test_a_frame_that_was_tracked_for_the_marker_before_is_never_shown(asked_meanwhile):
    pipeline = asked_meanwhile(10_000, at=1)  # frame 0 has not been taken
    assert pipeline.frames.take(PATIENCE_S).note == "by the second"


def test_the_last_frame_of_a_clip_is_tracked_again_for_another_marker(asked_meanwhile):
    pipeline = asked_meanwhile(3, at=2)  # no other frame comes
    tracked = pipeline.frames.take(PATIENCE_S)
    assert (tracked.frame.index, tracked.note) == (2, "by the second")
    await_that(lambda: pipeline.has_ended)
    pipeline.see_by(50.0)  # restarts it
    assert_settles(pipeline, at=2)
    assert pipeline._source.rewinds == 1


def test_a_photo_is_tracked_again_for_another_marker(run, fakes):
    second = fakes.Tracker()
    second.note = "by the second"
    source = fakes.Source(1, is_photo=True)
    pipeline = run(source, tracker_for=lambda _spec, _hfov_deg: second)
    assert pipeline.frames.take(PATIENCE_S).note is None
    await_that(lambda: source.reads == 2)  # and no more: it waits
    pipeline.follow("cube")
    assert pipeline.frames.take(PATIENCE_S).note == "by the second"


def test_where_nobody_can_seek_seeks_and_steps_change_nothing(run, fakes):
    tracker = fakes.Tracker()
    pipeline = run(fakes.Source(10_000), tracker=tracker)
    indices(pipeline, until=3)
    pipeline.step(-1)
    assert not pipeline._wish.paused
    assert min(indices(pipeline, until=8)) > 3
    pause(pipeline, tracker)
    pipeline.seek(0.0)
    assert pipeline.frames.take(A_WHILE_S) is None


@pytest.fixture
def held(run, fakes) -> tuple[Pipeline, object, object]:
    """A pipeline that is paused at frame 50 of 1000, with its clip and tracker."""
    source, tracker = fakes.Clip(1000), fakes.Tracker()
    pipeline = run(source, tracker=tracker)
    pipeline.pause(True)
    pipeline.seek(50 / source.fps)
    assert_settles(pipeline, at=50)
    tracker.jumps, source.sought = 0, []
    return pipeline, source, tracker


def test_steps_while_paused_are_tracked_and_shown(held):
    pipeline, _, tracker = held
    for by, wanted, jumps in ((1, 51, 0), (1, 52, 0), (-1, 51, 1), (-1, 50, 2), (-1, 49, 3), (1, 50, 3)):
        pipeline.step(by)
        tracked = pipeline.frames.take(PATIENCE_S)
        assert (tracked.frame.index, tracked.marker is not None) == (wanted, True)
        assert tracker.jumps == jumps  # the next one in a row is no cut
    assert pipeline.frames.take(A_WHILE_S) is None


def test_a_step_pauses_at_the_very_next_frame(run, fakes):
    pipeline = run(fakes.Clip(10_000, fps=0.1))
    assert pipeline.frames.take(PATIENCE_S).frame.index == 0
    pipeline.step(1)  # while the next frame is waiting to be due
    assert pipeline.frames.take(PATIENCE_S).frame.index == 1
    pipeline.step(-1)
    assert_settles(pipeline, at=0)


def test_a_held_key_does_not_queue(held):
    """While one jump is under way, all that is asked for becomes one more."""
    pipeline, source, _ = held
    source.hook = gate = Gate()
    pipeline.step(-1)
    assert gate.reached.wait(PATIENCE_S)
    for _ in range(20):
        pipeline.step(-1)
    gate.opened.set()
    assert_settles(pipeline, at=50 - 21)
    assert source.sought == [49, 29]
    source.sought.clear()
    source.hook = gate = Gate()
    pipeline.seek(0.5)
    assert gate.reached.wait(PATIENCE_S)
    for _ in range(10):
        pipeline.seek_by(0.1)
    gate.opened.set()
    assert_settles(pipeline, at=300)
    assert source.sought == [100, 300]


@pytest.mark.parametrize("loop", [False, True])
def test_stepping_off_the_ends_stays_there(run, fakes, loop):
    source = fakes.Clip(10)
    pipeline = run(source, loop=loop)
    pipeline.step(0)
    pipeline.seek(1.0)
    assert_settles(pipeline, at=9)
    pipeline.step(1)
    pipeline.step(1)
    await_that(lambda: pipeline._wish.jump is pipeline._capture.state.obeyed and pipeline._capture.state.at.index == 9)
    assert pipeline.frames.take(A_WHILE_S) is None
    assert (pipeline.has_ended, pipeline.status, source.rewinds) == (False, None, 0)
    pipeline.step(-1)
    assert_settles(pipeline, at=8)
    pipeline.step(-20)
    assert_settles(pipeline, at=0)
    pipeline.step(-1)
    assert_settles(pipeline, at=0)


def test_a_seek_is_a_cut_and_playing_goes_on_from_there(run, fakes):
    source, tracker = fakes.Clip(10_000), fakes.Tracker()
    pipeline = run(source, tracker=tracker)
    indices(pipeline, until=3)
    pipeline.seek(40.0)
    indices(pipeline, until=8050)
    assert tracker.jumps == 1
    pipeline.seek_by(-20.0)
    taken = [pipeline.frames.take(PATIENCE_S).frame.index for _ in range(30)]
    first = next(index for index in taken if index < 8000)
    assert 4000 <= first < 6000
    assert taken == sorted(taken[: taken.index(first)]) + sorted(taken[taken.index(first) :])
    assert tracker.jumps == 2


def test_a_seek_back_from_the_end_plays_on(run, fakes):
    pipeline = run(fakes.Clip(10))
    indices(pipeline, until=9)
    await_that(lambda: pipeline.has_ended)
    pipeline.seek_by(-0.02)
    taken = indices(pipeline, until=9)
    assert taken[0] >= 5
    await_that(lambda: pipeline.has_ended)
    pipeline.play(1.0, loop=True)
    await_that(lambda: not pipeline.has_ended)
    assert pipeline.frames.take(PATIENCE_S) is not None


def test_what_is_known_of_a_source_before_it_is_read(make, fakes):
    clip, photo = make(fakes.Clip(11, fps=10.0)), make(fakes.Source(1, fps=None, is_photo=True))
    assert (clip.is_clip, clip.fps, clip.duration_s, clip.marker) == (True, 10.0, 1.0, fakes.Tracker.marker.spec)
    assert (photo.is_clip, photo.fps, photo.duration_s) == (False, PHOTO_FPS, None)
    assert (clip.name, clip.clip_path) == ("fake", Path("clip.mp4"))
    assert (photo.name, photo.clip_path) == ("fake", None)
    other = make(fakes.Clip(2), tracker_for=lambda _spec, _hfov_deg: fakes.Tracker())
    other.follow("cube")
    other.see_by(50.0)
    assert other.marker == "cube"


@pytest.mark.parametrize(("duration_s", "at"), [(4.995, 799), (None, 999)])
def test_who_seeks_beyond_the_end_goes_back_from_there_where_it_is_known(held, duration_s, at):
    """Else from where it was sent; the clip itself stays at its last frame."""
    pipeline, source, _ = held
    source.duration_s = duration_s
    source.hook = gate = Gate()
    pipeline.step(1)
    assert gate.reached.wait(PATIENCE_S)
    pipeline.seek(100.0)
    pipeline.seek_by(-1.0)
    gate.opened.set()
    assert_settles(pipeline, at=at)


def test_what_is_no_clip_cannot_be_gone_through(run, fakes):
    pipeline = run(fakes.Source(1, fps=None, is_photo=True))
    indices(pipeline, until=0)
    assert (pipeline.is_clip, pipeline.duration_s) == (False, None)
    pipeline.seek(1.0)
    pipeline.seek_by(1.0)
    pipeline.step(1)
    assert pipeline.frames.take(A_WHILE_S) is None


def test_seconds_forwards_lead_through_a_pause_of_the_clip(make, fakes, clock):
    """As of a screen on which nothing moves: the frame before it is the one that is shown at every time within."""

    class Paused(fakes.Clip):
        """A hundred seconds between two frames."""

        def read(self):
            frame = super().read()
            return (
                frame if frame is None or frame.index < 2 else Frame(frame.image_bgr, frame.index, 100 + frame.time_s)
            )

        def seek(self, time_s: float) -> None:
            self.seek_frame(1 if time_s < 102 else round(time_s - 100))

    source = Paused(5, fps=1.0)
    source.duration_s = 104.0
    pipeline = make(source)
    assert stepped(pipeline, 2) == [0, 1]
    for _ in range(3):
        pipeline.seek_by(30.0)
        assert stepped(pipeline, 1) == [1]
    assert pipeline._bound_for.time_s == pytest.approx(91.0)
    before_s = clock.now
    assert stepped(pipeline, 1) == [2]
    assert clock.now - before_s == pytest.approx(11.0)
    pipeline.seek_by(-30.0)
    assert stepped(pipeline, 1) == [1]
    pipeline.seek_by(30.0)
    assert stepped(pipeline, 1) == [2]


@pytest.mark.parametrize(("speed", "hz"), [(0.25, 7.5), (0.5, 15), (1.0, 30), (2.0, 60), (4.0, 60)])
def test_speed_changes_the_pace_and_never_the_lag(make, fakes, clock, speed, hz):
    """Frames are tracked when they are due; of more than a display shows, some are left out."""
    tracker = fakes.Tracker()
    lags_s, seen = [], []

    def note(frame) -> None:
        lags_s.append(clock.now - frame.time_s / speed)
        seen.append(clock.now)
        clock.now += 0.004

    tracker.hook = note
    pipeline = make(fakes.Clip(240, fps=30.0), tracker=tracker)
    pipeline.play(speed, loop=False)
    stepped(pipeline, 240)
    assert max(map(abs, lags_s)) < 1e-9
    assert (len(seen) - 1) / (seen[-1] - seen[0]) == pytest.approx(hz, rel=0.02)


def test_after_a_short_pause_nothing_is_left_out(make, fakes, clock):
    """A longer one than FALLEN_BEHIND_S would be taken for a slow machine, which shows what comes next too."""
    pipeline = make(fakes.Clip(10, fps=30.0))
    assert stepped(pipeline, 3) == [0, 1, 2]
    pipeline.pause(True)
    clock.now += 0.8 * FALLEN_BEHIND_S  # then the clock's wait returns at once
    assert stepped(pipeline, 1) == [3]
    pipeline.pause(False)
    assert stepped(pipeline, 3) == [4, 5, 6]


def test_a_slow_tracker_drops_frames_instead_of_lagging(make, fakes, clock):
    tracker, lags_s = fakes.Tracker(), []

    def take_long(frame) -> None:
        lags_s.append(clock.now - frame.time_s)
        clock.now += 0.09

    tracker.hook = take_long
    stepped(make(fakes.Source(300, fps=30.0), tracker=tracker), 300)
    assert 80 < len(lags_s) < 120
    assert max(lags_s) <= 1 / 30 + 1e-9


def test_a_lost_camera_is_reported_and_comes_back(run, fakes, monkeypatch):
    monkeypatch.setattr(capture_loop, "RECONNECT_EVERY_S", 0.01)
    source, tracker = fakes.Source(10_000, is_live=True), fakes.Tracker()
    plugged_in = threading.Event()
    source.hook = fakes.lost_once(at=3)
    source.reopen = plugged_in.is_set
    pipeline = run(source, tracker=tracker)
    await_that(lambda: pipeline.status is not None)
    assert "waiting for it to come back" in pipeline.status
    assert not pipeline.frames.is_closed
    monkeypatch.setattr(pipeline_module, "STALLED_AFTER_S", 0.0)
    assert pipeline.stall is None, "it hangs nowhere"
    plugged_in.set()
    await_that(lambda: pipeline.status is None)
    assert pipeline.frames.take(PATIENCE_S) is not None
    assert tracker.resets == 1


def test_a_lost_camera_is_not_looked_for_all_the_time_because_somebody_wants_the_first_frame(run, fakes, monkeypatch):
    """Which a camera does not have."""
    monkeypatch.setattr(capture_loop, "RECONNECT_EVERY_S", PATIENCE_S)
    source, looks = fakes.Source(10_000, is_live=True), []

    def lose(_index: int) -> None:
        raise SourceLost("the camera gives no more pictures", "plug it in")

    source.hook, source.reopen = lose, lambda: looks.append(True)
    pipeline = run(source)
    await_that(lambda: pipeline.status is not None)
    pipeline.restart()
    await_that(lambda: pipeline._capture.state.obeyed is pipeline._wish.jump)
    assert pipeline.frames.take(A_WHILE_S) is None
    assert len(looks) <= 2


@pytest.mark.parametrize("error", [UserError("the disk is gone", "look for it"), RuntimeError("a bug"), MemoryError()])
def test_an_error_reaches_the_other_side(run, fakes, error):
    source = fakes.Source(5)

    def fail(index: int) -> None:
        if index == 2:
            raise error

    source.hook = fail
    pipeline = run(source)
    await_that(lambda: pipeline.frames.is_closed)
    pipeline.frames.take(0.0)  # the last frame before it
    with pytest.raises(type(error)) as met:
        pipeline.frames.take(0.0)
    assert met.value is error
    assert source.closed.wait(PATIENCE_S)


def test_a_looped_clip_whose_file_has_gone_goes_on_once_it_is_back(run, fakes):
    """Each round opens it anew. The last picture stays meanwhile."""
    clip = fakes.Clip(4)
    rewind, is_there, looks = clip.rewind, threading.Event(), []

    def look() -> None:
        looks.append(True)
        if not is_there.is_set():
            raise UserError("there is no file clip.mp4", "check the name and the folder")
        rewind()

    clip.rewind = look
    pipeline = run(clip, loop=True)
    await_that(lambda: pipeline.has_ended)
    assert pipeline.status == "there is no file clip.mp4: R tries again"
    assert pipeline.frames.take(PATIENCE_S) is not None
    assert pipeline.frames.take(A_WHILE_S) is None
    assert len(looks) == 1, "it is looked for when somebody asks"
    for ask in (pipeline.restart, lambda: pipeline.seek(0.0)):
        jump = pipeline._capture.state.obeyed
        ask()
        await_that(lambda jump=jump: pipeline._capture.state.obeyed is not jump and pipeline.has_ended)
        assert not pipeline.frames.is_closed
    assert clip.sought == [], "first it is opened anew"
    is_there.set()
    pipeline.seek(1 / clip.fps)
    await_that(lambda: clip.rewinds > 2)
    assert pipeline.frames.take(PATIENCE_S) is not None
    assert (pipeline.status, pipeline.has_ended) == (None, False)
    assert clip.sought[-1] == 1


def test_a_clip_that_was_replaced_by_one_of_another_size_is_not_shown(run, fakes):
    clip = fakes.Clip(4)
    whole, rewind = clip.read, clip.rewind

    def other() -> None:
        rewind()
        clip.size = (128, 96)
        clip.read = lambda: (
            None if (frame := whole()) is None else Frame(np.zeros((96, 128, 3), np.uint8), frame.index, 0.0)
        )

    clip.rewind = other
    pipeline = run(clip, loop=True)
    await_that(lambda: pipeline.has_ended)
    assert pipeline.status is not None
    assert "128x96 and not 64x48" in pipeline.status
    # However often it is tried again, this window has the other size.
    assert "drop the file here" in pipeline.status


def test_a_picture_of_another_size_is_an_error_that_names_both(run, fakes):
    size = (128, 96)
    source = fakes.Source(5)
    whole = source.read

    def read():
        frame = whole()
        return frame if frame.index < 2 else Frame(np.zeros((size[1], size[0], 3), np.uint8), frame.index, frame.time_s)

    source.read = read
    pipeline = run(source)
    await_that(lambda: pipeline.frames.is_closed)
    pipeline.frames.take(0.0)
    with pytest.raises(UserError, match=f"{size[0]}x{size[1]} and not 64x48"):
        pipeline.frames.take(0.0)


def test_a_source_that_hangs_is_reported_until_it_goes_on(run, fakes, monkeypatch):
    monkeypatch.setattr(pipeline_module, "STALLED_AFTER_S", 2 * PATIENCE_S)
    source, gate = fakes.Source(10_000), Gate()
    source.hook = lambda index: index < 3 or gate(index)
    pipeline = run(source)
    assert gate.reached.wait(PATIENCE_S)
    assert pipeline.stall is None  # it is waited for, and not yet for long
    monkeypatch.setattr(pipeline_module, "STALLED_AFTER_S", 0.02)
    await_that(lambda: pipeline.stall is not None)
    assert "fake has given no picture" in pipeline.stall
    monkeypatch.undo()
    gate.opened.set()
    indices(pipeline, until=5)
    assert pipeline.stall is None


def test_waiting_for_the_user_or_at_the_end_is_no_stall(run, fakes, monkeypatch):
    monkeypatch.setattr(pipeline_module, "STALLED_AFTER_S", 0.0)
    pipeline = run(fakes.Source(2))
    await_that(lambda: pipeline.status is not None)
    assert pipeline.stall is None


def test_who_looks_late_gets_the_newest_frame_and_never_one_before_it(run, fakes):
    """No queue: however many frames were tracked since the display last looked, the last one is what it gets."""
    source, tracked_up_to, gates = fakes.Source(10_000, is_live=True), threading.Semaphore(0), threading.Semaphore(0)

    def wait_at_gate(_index: int) -> None:
        tracked_up_to.release()  # all frames before this one have been handed over
        assert gates.acquire(timeout=PATIENCE_S)

    source.hook = wait_at_gate
    pipeline = run(source)
    assert tracked_up_to.acquire(timeout=PATIENCE_S)
    shown = []
    for batch in (1, 7, 2, 30):
        for _ in range(batch):
            gates.release()
            assert tracked_up_to.acquire(timeout=PATIENCE_S)
        shown.append(pipeline.frames.take(0.0).frame.index)
        assert pipeline.frames.take(0.0) is None
    assert shown == [0, 7, 9, 39]
    source.hook = lambda _index: None
    gates.release()


def test_an_error_of_the_tracker_reaches_the_other_side(run, fakes):
    tracker = fakes.Tracker()

    def refuse(_frame) -> None:
        raise UserError("the calibration does not fit", "calibrate again")

    tracker.hook = refuse
    with pytest.raises(UserError, match="calibration"):
        run(fakes.Source(5), tracker=tracker).frames.take(PATIENCE_S)


def test_the_tracking_preset_changes_between_frames_and_never_within_one(make, fakes):
    """The main thread asks for another quality while a frame is being tracked. Of other wishes none changes it."""
    tracker, gate, used = fakes.Tracker(), Gate(), []
    tracker.preset = FAST.tracking

    def track(frame) -> None:
        used.append(tracker.preset)
        gate(frame.index)
        used.append(tracker.preset)

    tracker.hook = track
    pipeline = make(fakes.Clip(10_000), tracker=tracker)
    pipeline.play(2.0, loop=False)
    pipeline.start()
    assert gate.reached.wait(PATIENCE_S)
    pipeline.track_with(ACCURATE.tracking)
    gate.opened.set()
    indices(pipeline, until=3)
    pipeline.close()
    assert used[:2] == [FAST.tracking] * 2
    assert set(map(id, used[2:])) == {id(ACCURATE.tracking)}


def test_another_tracker_goes_on_at_the_quality_that_was_asked_for(make, fakes):
    second = fakes.Tracker()
    pipeline = make(fakes.Source(3), tracker_for=lambda _spec, _hfov_deg: second)
    for change in (lambda: pipeline.track_with(ACCURATE.tracking), lambda: pipeline.follow("cube")):
        change()
        stepped(pipeline, 1)
    assert second.preset is ACCURATE.tracking


def test_a_frame_that_is_not_due_yet_is_not_shown_once_another_is_sought(make, fakes):
    source = fakes.Clip(100, fps=1.0)
    pipeline = make(source)
    source.hook = lambda index: pipeline.seek(50.0) if index == 1 else None
    assert stepped(pipeline, 3) == [0, None, 50]


def test_a_seek_by_an_amount_begins_where_the_step_before_it_leads(held):
    """Also while that has not been carried out yet."""
    pipeline, source, _ = held
    source.hook = gate = Gate()
    pipeline.step(1)
    assert gate.reached.wait(PATIENCE_S)
    pipeline.step(3)
    pipeline.seek_by(2 / source.fps)
    gate.opened.set()
    assert_settles(pipeline, at=56)


def test_of_wishes_that_come_faster_than_frames_none_is_lost(held):
    """They are one value: a pause does not undo a seek that nobody has obeyed yet. And where it was sent is shown,
    however soon after another frame: at twice the pace frames in a row that come so soon are left out."""
    pipeline, source, _ = held
    source.hook = gate = Gate()
    pipeline.step(1)
    assert gate.reached.wait(PATIENCE_S)
    pipeline.restart()
    pipeline.step(3)
    pipeline.play(2.0, loop=True)
    pipeline.pause(False)
    pipeline.pause(True)
    gate.opened.set()
    assert_settles(pipeline, at=3)  # from the start, where it was sent before
    assert (pipeline._capture._pace.speed, pipeline._capture._wish.loop) == (2.0, True)


def playing(_pipeline, _source) -> None: ...


def paused(pipeline, _source) -> None:
    pipeline.pause(True)


def at_the_end(pipeline, source) -> None:
    source._count = 0
    await_that(lambda: pipeline.status is not None)


def without_camera(pipeline, source) -> None:
    source.is_live = True

    def lose(_index: int) -> None:
        raise SourceLost("unplugged", "plug it in")

    source.hook = lose
    await_that(lambda: pipeline.status is not None)


def failed(pipeline, source) -> None:
    def fail(_index: int) -> None:
        raise UserError("broken", "mend it")

    source.hook = fail
    await_that(lambda: pipeline.frames.is_closed)


@pytest.mark.parametrize("state", [playing, paused, at_the_end, without_camera, failed])
def test_closing_ends_it_in_any_state(run, fakes, state):
    source = fakes.Source(10_000)
    pipeline = run(source)
    indices(pipeline, until=0)
    state(pipeline, source)
    pipeline.close()
    pipeline.close()
    assert source.closed.wait(PATIENCE_S)


def test_closing_leaves_a_driver_that_hangs_behind(run, fakes):
    source = fakes.Source(5)
    source.hook = gate = Gate()
    pipeline = run(source)
    assert gate.reached.wait(PATIENCE_S)
    pipeline.close()
    assert not source.closed.is_set()
    with pytest.raises(Closed):
        pipeline.frames.take(0.0)
    gate.opened.set()
    assert source.closed.wait(PATIENCE_S)


def test_closing_before_the_start_is_allowed(fakes):
    Pipeline(fakes.Source(5), fakes.Tracker(), False).close()
