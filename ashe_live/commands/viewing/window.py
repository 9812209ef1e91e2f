"""The viewer in a window, until it is closed."""

import contextlib

from ashe_live.commands.flags.setup import quality_of
from ashe_live.commands.viewing.headless import show_without_window
from ashe_live.commands.viewing.replay_flags import replay_flags
from ashe_live.commands.viewing.setup import ViewerSetup, has_display, opened_session, report_recordings_cut_short
from ashe_live.core.camera import drawn_size
from ashe_live.errors import ExitStatus, UserError
from ashe_live.process.signals import ended_by_signals
from ashe_live.render.gl.offscreen import graphics_failures_reported
from ashe_live.render.renderer import SceneRenderer
from ashe_live.viewer.display import bare_scene


def show(setup: ViewerSetup) -> int:
    """Runs the viewer as the options want it; returns the exit status."""
    return show_without_window(setup, bare_scene).status if setup.options.headless else show_in_window(setup)


def show_in_window(setup: ViewerSetup) -> int:
    """Runs the viewer until its window is closed; returns the exit status."""
    # Imported here, as playing without a display must not need GLFW.
    from ashe_live.commands.viewing.later_sources import LaterSources
    from ashe_live.viewer.live import LiveViewer, ViewerOptions
    from ashe_live.viewer.output.recording import Recording
    from ashe_live.viewer.sources.pipeline import Pipeline
    from ashe_live.viewer.windows.glfw_window import GlfwWindow

    options = setup.options
    if not has_display():
        written = "FILE.png" if setup.source.is_photo else "VIDEO.mp4"
        raise UserError("there is no display for a window", f"give --headless --out {written}")
    report_recordings_cut_short(options.out)
    with contextlib.ExitStack() as stack:
        end_if_asked = stack.enter_context(ended_by_signals())
        stack.enter_context(graphics_failures_reported())
        # Before the window, so that the light's process starts meanwhile, and no window opens for an unreadable model.
        session = stack.enter_context(opened_session(setup))
        window = stack.enter_context(GlfwWindow(f"ashe-live: {setup.source.name}", setup.size))
        pipeline = Pipeline(setup.source, setup.tracker, options.loop, setup.tracker_for)
        stack.callback(pipeline.close)
        pipeline.start()
        preset = quality_of(options).render
        renderer = SceneRenderer(window.context, preset, window.screen.size)
        recording = None
        if options.out is not None:
            recording = Recording(options.out, drawn_size(setup.source.size), pipeline.fps, options.overwrite)
        asked = ViewerOptions(
            options.quality,
            loop=options.loop,
            recording=recording,
            opener=LaterSources(options),
            takes_any_marker=options.takes_any_marker,
            flags=tuple(replay_flags(options)),
        )
        LiveViewer(window, renderer, pipeline, session, asked).run(options.frames, end_if_asked)
    # Its line has been shown; what was asked for by --out is not there, or not all of it.
    is_lost = recording is not None and recording.failure is not None
    return ExitStatus.WRONG_USE if is_lost else ExitStatus.ANSWERED
