"""What the benches of the loop time, and what not, by a clock that only stages which are known to take so long move."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.bench.loops import WARM_UP_FRAMES, PacedTimes, time_blit, time_paced, time_unpaced
from ashe_live.bench.viewer import key_view_times
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.scene import Scene
from tests.bench.fake_clock import FakeClock

SIZE = (64, 48)
CAMERA = Camera.from_hfov(SIZE, 60)
PICTURE = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
CLIP_FRAMES = 7
FRAMES = 20


def decode_ms(index: int) -> float:
    return 1.0 + index


class Clip:
    """A source whose frames take longer one by one; its end and its beginning take long, and are not to be timed."""

    def __init__(self, clock: FakeClock) -> None:
        self._clock, self._next = clock, 0

    def read(self) -> Frame | None:
        if self._next == CLIP_FRAMES:
            self._clock.work(500)
            return None
        self._clock.work(decode_ms(self._next))
        self._next += 1
        return Frame(PICTURE, self._next - 1, 0.0)

    def rewind(self) -> None:
        self._clock.work(500)
        self._next = 0


class Tracker:
    def __init__(self, clock: FakeClock) -> None:
        self._clock, self.resets = clock, 0

    def track(self, frame: Frame) -> TrackedFrame:
        self._clock.work(20)
        return TrackedFrame(frame, CAMERA, None)

    def reset(self) -> None:
        self._clock.work(500)
        self.resets += 1


class Renderer:
    """Takes 30 ms to hand a picture over and 10 to draw it; while it warms up, a second longer."""

    def __init__(self, clock: FakeClock, warm_up: int = 0) -> None:
        self._clock, self._warm_up = clock, warm_up
        self.drawn: list[Scene] = []

    def render(self, scene: Scene, waits: bool) -> None:
        assert not waits, "as in a window, no picture waits for what takes longer"
        self.drawn.append(scene)
        self._clock.work(1030 if len(self.drawn) <= self._warm_up else 30)

    def finish(self) -> None:
        self._clock.work(10)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> FakeClock:
    clock = FakeClock()
    clock.install(monkeypatch, "ashe_live.bench.loops", "ashe_live.bench.viewer.key_view_times")
    return clock


def test_each_stage_has_its_own_time_without_warm_up_and_rewinding(clock: FakeClock) -> None:
    tracker, renderer = Tracker(clock), Renderer(clock, WARM_UP_FRAMES)
    times = time_unpaced(Clip(clock), tracker, renderer, Scene, FRAMES)
    decoded = [decode_ms(index % CLIP_FRAMES) for index in range(WARM_UP_FRAMES, WARM_UP_FRAMES + FRAMES)]
    whole = [ms + 60 for ms in decoded]
    expected = {"decode": decoded, "track": [20] * FRAMES, "render": [40] * FRAMES, "whole": whole}
    assert times.wall_ms == {stage: pytest.approx(ms) for stage, ms in expected.items()}
    assert times.cpu_ms == {stage: pytest.approx(np.array(ms) / 2) for stage, ms in expected.items()}
    assert times.pictures_per_second == pytest.approx(FRAMES / (sum(whole) / 1e3))
    assert tracker.resets == (WARM_UP_FRAMES + FRAMES - 1) // CLIP_FRAMES


def test_the_bare_video_is_drawn_without_a_pose_and_timed_without_decoding_it(clock: FakeClock) -> None:
    renderer = Renderer(clock)
    times = time_blit(Clip(clock), Tracker(clock), renderer, CAMERA, FRAMES)
    assert times.wall_ms == {"blit": pytest.approx([40] * FRAMES)}
    shown = [scene.tracked for scene in renderer.drawn]
    assert [tracked.frame.index for tracked in shown] == [index % CLIP_FRAMES for index in range(FRAMES)]
    assert {tracked.marker for tracked in shown} == {None}


def paced(clock: FakeClock, taken: list[int | None], rate_hz: float) -> tuple[PacedTimes, list[int]]:
    """Times while the capture has these frames, None for no new one, and the frames that are drawn."""
    frames = iter(None if index is None else TrackedFrame(Frame(PICTURE, index, 0.0), CAMERA, None) for index in taken)
    pipeline = SimpleNamespace(frames=SimpleNamespace(take=lambda _: next(frames)))
    renderer = Renderer(clock)
    times = time_paced(pipeline, renderer, Scene, len(taken) - 1, rate_hz)
    return times, [scene.tracked.frame.index for scene in renderer.drawn]


def test_at_a_displays_rate_work_and_intervals_are_timed_and_the_last_frame_is_drawn_again(clock: FakeClock) -> None:
    times, drawn = paced(clock, [0, 1, None, 2, None], rate_hz=10)
    assert drawn == [1, 1, 2, 2]
    assert times.work_ms == pytest.approx([40] * 4)
    assert times.interval_ms == pytest.approx([100] * 3)


def test_pictures_that_take_longer_than_the_display_gives_follow_at_once_and_none_is_caught_up(
    clock: FakeClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = iter((40, 210, 40, 40))
    monkeypatch.setattr(Renderer, "finish", lambda self: self._clock.work(next(slow) - 30))
    times, _ = paced(clock, [0, *[None] * 4], rate_hz=10)
    assert times.work_ms == pytest.approx([40, 210, 40, 40])
    # The slow one is begun on time and ends late; what follows it begins at once, and then keeps the display's pace.
    assert times.interval_ms == pytest.approx([270, 40, 100])


def test_rounds_of_paced_times_are_one_list() -> None:
    whole = PacedTimes([1.0], [2.0])
    whole.add(PacedTimes([3.0, 4.0], [5.0]))
    assert whole == PacedTimes([1.0, 3.0, 4.0], [2.0, 5.0])


def test_key_views_cost_what_choosing_them_takes_and_their_memory_at_its_most(
    clock: FakeClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    added: list[int] = []

    class Views:
        """Takes 2 ms for a frame, of which 1 on the processor, and keeps a MiB of it until they are dropped."""

        nbytes = 0

        def add(self, tracked: TrackedFrame) -> None:
            added.append(tracked.frame.index)
            clock.work(2)
            self.nbytes += 2**20

        def drop(self) -> None:
            clock.work(500)
            self.nbytes = 0

    monkeypatch.setattr(key_view_times, "KeyViews", Views)
    clip, tracker = Clip(clock), Tracker(clock)
    clip.read()  # as it was left by what was timed before
    times = key_view_times.time_key_views(clip, tracker, 2 * CLIP_FRAMES + 2)
    assert added == [*range(CLIP_FRAMES), *range(CLIP_FRAMES), 0, 1]
    assert tracker.resets == 3, "at first, and with each new beginning of the clip"
    assert times == replace(times, add_ms=pytest.approx([1.0] * (2 * CLIP_FRAMES + 2)), mib=CLIP_FRAMES)
