"""`ashe-live bench soak`: long runs of the viewer's loop, and the age of its pictures on the screen."""

import contextlib
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import ClassVar

from ashe_live.bench.bench import Bench
from ashe_live.bench.resources_held import left_running
from ashe_live.bench.soak.offscreen_window import OffscreenWindow, ShownPicture
from ashe_live.bench.soak.picture_age import PictureAges
from ashe_live.bench.soak.run import SoakRun, SoakTracker
from ashe_live.bench.soak.tables import print_soak_figures
from ashe_live.bench.soak.time_code import TimeCodeCamera
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.capture.webcam import WebcamSource
from ashe_live.core.contract import Json
from ashe_live.light.estimators.estimator import Estimator
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.live.worker import LightWorker
from ashe_live.quality import Quality
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.viewer.cores import leave_cores_to_renderer
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.live import LiveViewer, ViewerOptions
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.pipeline import Pipeline
from ashe_live.viewer.table.shelf import Shelf

MODEL = "cube"
# Rate of camera and display: about the fastest that two cores reach without a graphics card.
SOAK_HZ = 100.0
DISPLAY_HZ = 60.0
CAMERA_HZ = (30.0, 60.0)
AGE_FRAMES_AT_MOST = 900


@dataclass(frozen=True, slots=True)
class SoakBench(Bench):
    """The soak bench: `frames` of `clip` at `quality`, with estimates by `estimator`."""

    SCHEMA: ClassVar[int] = 2
    NEEDS_OPENGL: ClassVar[bool] = True

    clip: KnownClip
    quality: Quality
    estimator: str | Callable[[ProxyPreset], Estimator]
    frames: int

    def parts(self) -> Iterator[Json]:
        leave_cores_to_renderer()
        figures: Json = {
            "clip": self.clip.path.name,
            "size": list(self.clip.camera.size),
            "quality": self.quality.name,
            "frames": self.frames,
            "display_hz": DISPLAY_HZ,
            "age": [self._age(camera_hz) for camera_hz in CAMERA_HZ],
            "soak": self._soak(),
        }
        print_soak_figures(self.console, figures)
        yield figures

    def _age(self, camera_hz: float) -> Json:
        """The age of pictures on a display of DISPLAY_HZ, from their numbers read back from the screen."""
        frames = min(self.frames, AGE_FRAMES_AT_MOST)
        camera = TimeCodeCamera(self.clip, camera_hz)
        with self._stage(camera, DISPLAY_HZ) as stage:
            ages = PictureAges(camera, stage.window, stage.session)
            stage.on_picture = ages.add
            stage.viewer.run(frames)
        return {"camera_hz": camera_hz, **ages.to_json()}

    def _soak(self) -> Json:
        before = set(threading.enumerate())
        with self._stage(TimeCodeCamera(self.clip, SOAK_HZ), SOAK_HZ) as stage:
            run = SoakRun(stage.window, stage.session, stage.tracker, self.frames)
            stage.on_picture = run.add
            # Ctrl-C ends the run early, with the figures of the frames so far.
            with contextlib.suppress(KeyboardInterrupt):
                stage.viewer.run(self.frames)
        return {**run.to_json(), "left_running": left_running(before)}

    @contextlib.contextmanager
    def _stage(self, camera: TimeCodeCamera, rate_hz: float) -> Iterator["Stage"]:
        """Sets up all that `ashe-live webcam` does, with an offscreen window."""
        clip = self.clip
        with contextlib.ExitStack() as stack:
            ctx = offscreen_context()
            stack.callback(ctx.release)
            worker = stack.enter_context(LightWorker(self.estimator))
            session = Session(Shelf(MODEL, clip.marker_side_m), worker, FirstEstimate())
            session.watch.preset = self.quality.light
            renderer = SceneRenderer(ctx, self.quality.render, camera.size)
            stack.callback(renderer.release)
            tracker = SoakTracker(
                parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, self.quality.tracking
            )
            source = WebcamSource(0, camera.size, lambda _camera, _size: camera)
            pipeline = Pipeline(source, tracker, loop=False)
            stack.callback(pipeline.close)
            stage = Stage(session, tracker)
            stage.window = OffscreenWindow(ctx, camera.size, rate_hz, lambda picture: stage.on_picture(picture))
            stack.callback(stage.window.release)
            pipeline.start()
            stage.viewer = LiveViewer(stage.window, renderer, pipeline, session, ViewerOptions(self.quality.name))
            yield stage


class Stage:
    """A viewer, its window, and a callback for each picture shown."""

    window: OffscreenWindow
    viewer: LiveViewer

    def __init__(self, session: Session, tracker: SoakTracker) -> None:
        self.session = session
        self.tracker = tracker
        self.on_picture: Callable[[ShownPicture], None] = lambda _picture: None
