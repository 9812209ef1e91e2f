"""What demo, play and webcam have in common: a source and a session, shown in a window or rendered without one."""

import argparse
import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from ashe_live.capture.recording.cut_short import rescue_recordings
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.recording.transparent import TransparentRecorder
from ashe_live.capture.sources import Source
from ashe_live.commands.flags.marker_choice import others_said
from ashe_live.commands.flags.model_choice import chosen_models, names_of
from ashe_live.commands.flags.setup import light_steps, quality_of
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Size, drawn_size
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files import writing as files
from ashe_live.light.live.worker import LightWorker
from ashe_live.models.catalogue import model_names
from ashe_live.models.memory import ModelMemory
from ashe_live.process.messages import say, tell
from ashe_live.process.signals import ended_by_signals
from ashe_live.render.gl.offscreen import graphics_failures_told, offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.families.in_view import markers_in_view
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.cores import leave_cores_to_renderer
from ashe_live.viewer.display import bare_scene
from ashe_live.viewer.estimates.policy import EstimatePolicy
from ashe_live.viewer.headless import HeadlessRun, play_headless
from ashe_live.viewer.output.report import Report
from ashe_live.viewer.session import Session
from ashe_live.viewer.status import camera_line, light_line
from ashe_live.viewer.table.shelf import Shelf


@dataclass(frozen=True, slots=True)
class ViewerSetup:
    """A source, and how it is to be looked at."""

    source: Source
    tracker: MarkerTracker
    options: argparse.Namespace
    true_to_light_marker: Float | None = None  # (3,) unit, where it is known
    shows_light: bool = False
    # By another marker's spec, or another field of view in degrees; None: there is no other.
    tracker_for: Callable[[str | None, float | None], MarkerTracker] | None = None

    @property
    def size(self) -> Size:
        size: Size = self.options.size or drawn_size(self.source.size)
        return size


def check_outputs(options: argparse.Namespace) -> None:
    """Raises UserError before anything is opened when a file must not or cannot be written."""
    models = (Path(name) for name in names_of(options) if name not in model_names())
    inputs = (getattr(options, "file", None), options.camera_file, *models)
    files.check_outputs((options.out, options.report), inputs, options.overwrite)
    if options.headless and options.loop and options.frames is None:
        raise UserError("--loop without a window never ends", "give --frames N too")
    if options.layers is not None and (not options.headless or options.out is None):
        raise UserError(
            "--layers are written without a window", "give --headless --out FILE.mov too; Shift+S saves one"
        )
    if options.report is not None and not options.headless:
        raise UserError("--report is written without a window only", "give --headless too")


def has_display() -> bool:
    """Whether a window can be hoped for; only X11 and Wayland name their display in the environment."""
    return not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextlib.contextmanager
def opened_session(setup: ViewerSetup) -> Iterator[Session]:
    """The session of `setup` with its light process, which ends with it."""
    options = setup.options
    leave_cores_to_renderer()
    policy = EstimatePolicy(not setup.source.is_live, options.estimate_at, options.auto)
    steadiness = Steadiness(1) if setup.source.is_photo else Steadiness()
    first, *others = chosen_models(options)
    side_m, names = setup.tracker.side_m, [other.name for other in others]
    shelf = Shelf(first.name, side_m, options.up, ModelMemory(), names)
    with LightWorker(options.estimator) as worker:
        session = Session(shelf, worker, policy, steadiness, setup.true_to_light_marker, others)
        session.show_light = setup.shows_light
        session.hides_marker = options.hide_marker
        session.is_mirrored = options.mirror
        session.watch.preset = light_steps(options)
        if options.headless:
            for line in shelf.take_words():
                tell(line)
        yield session


def show(setup: ViewerSetup) -> int:
    """Runs the viewer as the options want it; returns the exit status."""
    return show_without_window(setup, bare_scene) if setup.options.headless else show_in_window(setup)


def show_in_window(setup: ViewerSetup) -> int:
    """Until it is closed."""
    # Only here, so that playing without a display does without GLFW.
    from ashe_live.commands.flags.opening import LaterSources
    from ashe_live.viewer.live import LiveViewer
    from ashe_live.viewer.output.recording import Recording
    from ashe_live.viewer.sources.pipeline import Pipeline
    from ashe_live.viewer.windows.glfw_window import GlfwWindow

    options = setup.options
    if not has_display():
        raise UserError("there is no display for a window", "give --headless --out VIDEO.mp4")
    _tell_of_recordings_cut_short(options.out)
    with contextlib.ExitStack() as stack:
        end_if_asked = stack.enter_context(ended_by_signals())
        stack.enter_context(graphics_failures_told())
        # First, as its process starts while the window opens, and a model that cannot be read opens none.
        session = stack.enter_context(opened_session(setup))
        window = stack.enter_context(GlfwWindow(f"ashe-live: {setup.source.name}", setup.size))
        pipeline = Pipeline(setup.source, setup.tracker, options.loop, setup.tracker_for)
        stack.callback(pipeline.close)
        pipeline.start()
        preset = quality_of(options).render
        renderer = SceneRenderer(window.context, preset, window.framebuffer_size, switches_at_once=False)
        recording = None
        if options.out is not None:
            recording = Recording(options.out, drawn_size(setup.source.size), pipeline.fps, options.overwrite)

        viewer = LiveViewer(
            window, renderer, pipeline, session, options.quality, recording, options.loop, LaterSources(options)
        )
        viewer.followed.takes_any_marker = options.takes_any_marker
        viewer.run(options.frames, end_if_asked)
    return ExitStatus.ANSWERED


def show_without_window(
    setup: ViewerSetup, scene: Callable[[Session], Scene], *takers: Callable[[Image, float], None]
) -> int:
    """Every frame; `takers` get each picture (h, w, 3) uint8 BGR and its time in seconds."""
    options = setup.options
    _tell_of_recordings_cut_short(options.out)
    with contextlib.ExitStack() as stack:
        end_if_asked = stack.enter_context(ended_by_signals())
        stack.enter_context(graphics_failures_told())
        stack.enter_context(setup.source)
        renderer = SceneRenderer(offscreen_context(), quality_of(options).render, setup.size)
        stack.callback(renderer.release)
        session = stack.enter_context(opened_session(setup))
        recorder: Recorder | TransparentRecorder | None = None
        if options.out is not None:
            wanted = options.out, setup.size, setup.source.fps or 1.0, options.overwrite
            recorder = Recorder(*wanted) if options.layers is None else TransparentRecorder(*wanted)
            stack.enter_context(recorder)
            takers = (*takers, recorder.write)
        report = Report(renderer.gl_renderer, renderer.gl_version, options.quality)

        def next_scene(session: Session) -> Scene:
            end_if_asked()
            return _layers(scene(session), options.layers)

        run = HeadlessRun(next_scene, options.frames, options.loop, takers, options.layers is not None)
        play_headless(setup.source, setup.tracker, session, renderer, run, report)
        if options.report is not None:
            _tell_where(options.report, report.write(options.report, options.overwrite))
    # Only now it is known what has become of the recording.
    if recorder is not None:
        _tell_where(options.out, recorder.path)
        options.out = recorder.path
    return _summed_up(setup, session, report)


def _layers(scene: Scene, wanted: str | None) -> Scene:
    if wanted is None:
        return scene
    return replace(scene, is_cut_out=True, shows_model=wanted != "shadow", casts_shadow=wanted != "model")


def _tell_where(wanted: Path, path: Path) -> None:
    if path != wanted:
        tell(f"{wanted} has appeared meanwhile and stays as it is: see {path}")


def _summed_up(setup: ViewerSetup, session: Session, report: Report) -> int:
    found = sum(frame["found"] for frame in report.frames)
    light = "light: not estimated" if session.estimate is None else light_line(session)
    say(f"{setup.source.name}: marker in {found} of {len(report.frames)} frames; {light}")
    for notice in _notices(setup, session, {frame["index"] for frame in report.frames if frame["found"]}):
        tell(notice)
    return ExitStatus.ANSWERED if found else ExitStatus.NO_MARKER


def _notices(setup: ViewerSetup, session: Session, found: set[int]) -> Iterator[str]:
    """What went otherwise than asked for; `found`: the indices of the frames with a marker."""
    name, options = setup.source.name, setup.options
    if setup.source.note is not None:
        yield setup.source.note
    if not found:
        in_view = () if session.tracked is None else markers_in_view(session.tracked.frame.image_bgr)
        named = others_said(in_view) if in_view else "if another one is there, name it with --marker"
        yield f"the marker {options.marker} is not seen in {name}: {named}"
    elif options.estimate_at not in (None, *found):
        yield f"nothing to estimate in frame {options.estimate_at}: no marker in it, or no such frame was played"
    elif session.last_notice is not None:
        yield session.last_notice
    camera = camera_line(session.tracked)
    if camera is not None and session.tracked is not None and session.tracked.camera.source == "estimated":
        yield camera


def _tell_of_recordings_cut_short(out: Path | None) -> None:
    """Of a program that was killed, at the next one's start."""
    for folder in {Path.cwd(), *([] if out is None else [out.absolute().parent])}:
        for path in rescue_recordings(folder):
            tell(f"a recording that was cut short is now {path}")
