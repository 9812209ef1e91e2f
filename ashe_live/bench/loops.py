"""Timing of the viewer's loop, offscreen: as fast as possible, and at a display's rate.

As in a window, pictures do not wait for what takes longer, such as the marker's cover.
"""

import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field

from ashe_live.capture.sources import Source
from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.sources.pipeline import Pipeline

# Frames before the measurement, in which shaders are compiled, textures are made and the marker is first found.
WARM_UP_FRAMES = 30
LONGEST_WAIT_FOR_FRAME_S = 10.0


class StageTimes:
    """Wall and CPU time of the stages of a loop, in milliseconds, one entry per frame."""

    def __init__(self) -> None:
        self.wall_ms: dict[str, list[float]] = defaultdict(list)
        self.cpu_ms: dict[str, list[float]] = defaultdict(list)  # of all threads of this process
        self.start()

    def start(self) -> None:
        self._wall_s, self._cpu_s = time.perf_counter(), time.process_time()

    def stage(self, name: str) -> None:
        """Records the time since the last call as that of stage `name`."""
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        self.wall_ms[name].append((wall_s - self._wall_s) * 1e3)
        self.cpu_ms[name].append((cpu_s - self._cpu_s) * 1e3)
        self._wall_s, self._cpu_s = wall_s, cpu_s

    def sum_up(self, stages: tuple[str, ...]) -> None:
        """Adds the stage `whole`, the sum of `stages` in each frame."""
        for times in (self.wall_ms, self.cpu_ms):
            times["whole"] = [sum(frame) for frame in zip(*(times[stage] for stage in stages), strict=True)]

    @property
    def pictures_per_second(self) -> float:
        """How many there are in a second of the stage `whole`."""
        return len(self.wall_ms["whole"]) * 1e3 / sum(self.wall_ms["whole"])


def time_unpaced(
    source: Source, tracker: MarkerTracker, renderer: SceneRenderer, scene: Callable[[TrackedFrame], Scene], frames: int
) -> StageTimes:
    """Times of the stages `decode`, `track` and `render`, run one after another, and of their sum `whole`."""
    times = StageTimes()
    for count in range(WARM_UP_FRAMES + frames):
        if count == WARM_UP_FRAMES:
            times = StageTimes()
        frame = _next_frame(source, tracker, times)
        times.stage("decode")
        tracked = tracker.track(frame)
        times.stage("track")
        renderer.render(scene(tracked), waits=False)
        renderer.finish()
        times.stage("render")
    times.sum_up(("decode", "track", "render"))
    return times


def time_blit(
    source: Source, tracker: MarkerTracker, renderer: SceneRenderer, camera: Camera, frames: int
) -> StageTimes:
    """Times of the stage `blit`: drawing the bare video, a reference for comparing machines."""
    times = StageTimes()
    for _ in range(frames):
        bare = Scene(TrackedFrame(_next_frame(source, tracker, times), camera, None))
        times.start()
        renderer.render(bare, waits=False)
        renderer.finish()
        times.stage("blit")
    return times


def _next_frame(source: Source, tracker: MarkerTracker, times: StageTimes) -> Frame:
    """The next frame of the clip, which is repeated as needed; rewinding is not timed."""
    frame = source.read()
    if frame is None:
        source.rewind()
        tracker.reset()
        times.start()
        frame = source.read()
        assert frame is not None
    return frame


@dataclass(slots=True)
class PacedTimes:
    """Frame times at a display's rate, in milliseconds."""

    work_ms: list[float] = field(default_factory=list)  # from the start of work on a frame until it is drawn
    interval_ms: list[float] = field(default_factory=list)  # from one frame drawn to the next

    def add(self, more: "PacedTimes") -> None:
        self.work_ms += more.work_ms
        self.interval_ms += more.interval_ms


def time_paced(
    pipeline: Pipeline, renderer: SceneRenderer, scene: Callable[[TrackedFrame], Scene], frames: int, rate_hz: float
) -> PacedTimes:
    """Times of `frames` at `rate_hz`: the viewer's loop without its window, beside a started pipeline's capture."""
    times = PacedTimes()
    tracked = pipeline.frames.take(LONGEST_WAIT_FOR_FRAME_S)
    assert tracked is not None
    drawn_s: float | None = None
    due_s = time.perf_counter()
    for _ in range(frames):
        due_s = max(due_s + 1 / rate_hz, time.perf_counter())
        time.sleep(max(0.0, due_s - time.perf_counter()))
        started_s = time.perf_counter()
        tracked = pipeline.frames.take(0.0) or tracked
        renderer.render(scene(tracked), waits=False)
        renderer.finish()
        last_s, drawn_s = drawn_s, time.perf_counter()
        times.work_ms.append((drawn_s - started_s) * 1e3)
        if last_s is not None:
            times.interval_ms.append((drawn_s - last_s) * 1e3)
    return times
