"""`ashe-live bench viewer`: frames per second, times by stage, and how much running estimates slow frames down."""

import contextlib
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from enum import Enum
from typing import ClassVar

import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.loops import PacedTimes, StageTimes, time_blit, time_paced, time_unpaced
from ashe_live.bench.viewer.key_view_times import time_key_views
from ashe_live.bench.viewer.starts import time_start
from ashe_live.bench.viewer.tables import print_viewer_figures
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.core.camera import Size
from ashe_live.core.contract import Json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import Estimator
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.live.held_answer import HeldAnswer
from ashe_live.light.live.key_views import KeyViews
from ashe_live.light.live.worker import LightWorker
from ashe_live.quality import Quality
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.render.screen import Screen
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.cores import leave_cores_to_renderer
from ashe_live.viewer.display import Display, Readings
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.estimates.light_watch import NewAnswer
from ashe_live.viewer.output.report import frame_time_percentiles
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.pipeline import Pipeline
from ashe_live.viewer.table.shelf import Shelf

DISPLAY_HZ = 60.0
# Runs with and without estimates alternate, so that other load on the machine affects both equally.
ROUNDS = 4
LONGEST_WARM_UP_S = 10  # in which the model and the cover are made that the first pictures call for
MODEL = "cube"


@dataclass(frozen=True, slots=True)
class ViewerBench(Bench):
    """The viewer's bench on `clip` at `quality`, with estimates by `estimator`."""

    NEEDS_OPENGL: ClassVar[bool] = True

    clip: KnownClip
    quality: Quality
    estimator: str | Callable[[ProxyPreset], Estimator]
    frames: int  # in each run
    size: Size | None = None  # of the framebuffer; None: the clip's
    starts: int = 5  # runs from the command to the first picture, without a window and in one

    def parts(self) -> Iterator[Json]:
        figures = self._measured()
        print_viewer_figures(self.console, figures)
        yield figures

    def _measured(self) -> Json:
        clip, size = self.clip, self.size or self.clip.camera.size
        leave_cores_to_renderer()
        with contextlib.ExitStack() as stack:
            renderer = SceneRenderer(offscreen_context(), self.quality.render, size)
            stack.callback(renderer.release)
            source = stack.enter_context(ClipSource(clip.path))
            tracker = MarkerTracker(
                parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, self.quality.tracking
            )
            worker = stack.enter_context(LightWorker(self.estimator))
            session = Session(Shelf(MODEL, clip.marker_side_m), worker, FirstEstimate())
            scene = BenchScene(session, clip, size, self.quality.name)
            scene.wait_for_first_estimate(source, tracker)
            unpaced = self._unpaced(source, tracker, renderer, scene)
            key_views = time_key_views(source, tracker, self.frames)
            paced = self._paced(source, tracker, renderer, scene)
        return {
            "clip": clip.path.name,
            "clip_size": list(clip.camera.size),
            "size": list(size),
            "quality": self.quality.name,
            "frames": self.frames,
            "first_picture": self._first_picture(),
            "unpaced": unpaced,
            "key_views": {
                "mean_ms": float(np.mean(key_views.add_ms)),
                **(frame_time_percentiles(key_views.add_ms) or {}),
                "mib": key_views.mib,
            },
            "paced": paced,
        }

    def _first_picture(self) -> Json:
        """Seconds that the command `play` takes to show one frame; None for the window if there is no display."""
        ways = {"headless": ("--headless",), "window": ()}
        timed = {name: time_start(self.clip, self.quality.name, self.starts, *ways[name]) for name in ways}
        return {name: None if start is None else asdict(start) for name, start in timed.items()}

    def _unpaced(
        self, source: ClipSource, tracker: MarkerTracker, renderer: SceneRenderer, scene: "BenchScene"
    ) -> Json:
        stages = time_unpaced(source, tracker, renderer, scene, self.frames)
        blit = time_blit(source, tracker, renderer, self.clip.camera, self.frames)
        return {
            "fps": stages.pictures_per_second,
            "stages_ms": {**_stages_json(stages), **_stages_json(blit)},
        }

    def _paced(self, source: ClipSource, tracker: MarkerTracker, renderer: SceneRenderer, scene: "BenchScene") -> Json:
        source.rewind()
        tracker.reset()
        pipeline = Pipeline(source, tracker, loop=True)
        pipeline.start()
        scene.watch(pipeline.key_views)
        times = {task: PacedTimes() for task in Task}
        frames = max(2, math.ceil(self.frames / ROUNDS))
        try:
            for _ in range(LONGEST_WARM_UP_S):
                time_paced(pipeline, renderer, scene, int(DISPLAY_HZ), DISPLAY_HZ)
                if renderer.is_settled:
                    break
            for _ in range(ROUNDS):
                for task in Task:
                    scene.task = task
                    times[task].add(time_paced(pipeline, renderer, scene, frames, DISPLAY_HZ))
                    scene.end_estimates()
        finally:
            pipeline.close()
        p99 = {task: float(np.percentile(times[task].work_ms, 99)) for task in Task}
        busy = {
            task.value: {
                **_paced_json(times[task]),
                "estimates_ms": scene.estimates_ms[task],
                "p99_ratio": p99[task] / p99[Task.IDLE],
            }
            for task in (Task.ESTIMATING, Task.SHARPENING)
        }
        return {"rate_hz": DISPLAY_HZ, "idle": _paced_json(times[Task.IDLE]), **busy}


class Task(Enum):
    """What the light worker does meanwhile."""

    IDLE = "idle"
    ESTIMATING = "estimating"  # one estimate after the other, as if a person waited for each
    SHARPENING = "sharpening"  # one after the other, in the background, from the key views


class BenchScene:
    """The viewer's scene for each frame of the clip, under the true light, so that every frame costs the same."""

    def __init__(self, session: Session, clip: KnownClip, size: Size, quality: str) -> None:
        self.task = Task.IDLE
        self.estimates_ms: dict[Task, list[float]] = {task: [] for task in Task}  # how long each of them took
        self._session = session
        assert clip.to_light_marker is not None
        self._true = Illumination((Light(clip.to_light_marker),))
        self._screen, self._readings = Screen(size), Readings(quality, DISPLAY_HZ)
        self._display = Display()

    def __call__(self, tracked: TrackedFrame) -> Scene:
        """As LiveViewer composes it; unless it is idle, a new estimate is requested whenever one has ended."""
        now_s = time.monotonic()
        if tracked is not self._session.tracked:
            self._session.take(tracked, now_s)
        if not self._session.watch.is_estimating and tracked.marker is not None:
            self._request(now_s)
        self._note(self._session.poll(now_s))
        self._session.hand.light = self._session.shown = self._true
        return self._display.scene(self._session, self._screen, self._readings, now_s)

    def watch(self, key_views: KeyViews) -> None:
        """Takes these key views from now on."""
        self._session.watch.key_views = key_views

    def end_estimates(self) -> None:
        """Waits for the estimate under way."""
        self._note(self._session.wait_for_estimate(time.monotonic()))

    def _request(self, now_s: float) -> None:
        watch = self._session.watch
        if self.task is Task.ESTIMATING:
            self._session.request_estimate(now_s)
        elif self.task is Task.SHARPENING and (views := watch.key_views.views):
            # A fresh look at each: that it gains nothing is no reason to end here.
            watch.held = HeldAnswer()
            watch.ask_in_background(views[-1], now_s)

    def _note(self, new: NewAnswer | None) -> None:
        if new is not None:
            self.estimates_ms[self.task].append(new.estimate.timing_ms["total"])

    def wait_for_first_estimate(self, source: ClipSource, tracker: MarkerTracker) -> None:
        """Returns when the estimator's process has started up, and is idle."""
        frame = source.read()
        assert frame is not None
        self._session.take(tracker.track(frame), 0.0)
        if self._session.request_estimate(0.0):
            self._session.wait_for_estimate(0.0)


def _stages_json(times: StageTimes) -> Json:
    return {
        name: {**(frame_time_percentiles(wall_ms) or {}), "mean_cpu": float(np.mean(times.cpu_ms[name]))}
        for name, wall_ms in times.wall_ms.items()
    }


def _paced_json(times: PacedTimes) -> Json:
    return {
        "work_ms": frame_time_percentiles(times.work_ms),
        "interval_ms": frame_time_percentiles(times.interval_ms),
    }
