"""The viewer without a window: every frame into a file, a report, or to whoever takes it."""

import argparse
import contextlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ashe_live.capture.recording.last_picture import PICTURE_SUFFIX, LastPicture
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.capture.recording.transparent import TransparentRecorder
from ashe_live.commands.flags.marker_choice import not_found_text
from ashe_live.commands.flags.setup import assumed_note, quality_of
from ashe_live.commands.viewing.setup import (
    ViewerSetup,
    check_outputs_and_models,
    opened_session,
    report_recordings_cut_short,
)
from ashe_live.core.arrays import Image
from ashe_live.errors import ExitStatus, UserError
from ashe_live.process.messages import listed, print_answer, print_message
from ashe_live.process.signals import ended_by_signals
from ashe_live.render.gl.offscreen import graphics_failures_reported, offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.families.seen_instead import SeenInstead, seen_instead
from ashe_live.viewer.display import cut_out
from ashe_live.viewer.headless import HeadlessRun, play_headless
from ashe_live.viewer.output.as_shown import AsShown, read_as_shown
from ashe_live.viewer.output.report import Report
from ashe_live.viewer.session import Session
from ashe_live.viewer.status import camera_line, light_line


class Played(NamedTuple):
    """How a run without a window ended."""

    status: int  # of the process
    recording: Path | None  # under another name than the one asked for, if a file of that name has appeared meanwhile


def show_without_window(
    setup: ViewerSetup, scene: Callable[[Session], Scene], *takers: Callable[[Image, float], None]
) -> Played:
    """Plays every frame; `takers` get each picture (h, w, 3) uint8 BGR and its time in seconds."""
    options = setup.options
    report_recordings_cut_short(options.out)
    with contextlib.ExitStack() as stack:
        end_if_asked = stack.enter_context(ended_by_signals())
        stack.enter_context(graphics_failures_reported())
        stack.enter_context(setup.source)
        renderer = SceneRenderer(offscreen_context(), quality_of(options).render.offline, setup.size)
        stack.callback(renderer.release)
        session = stack.enter_context(opened_session(setup))
        as_shown = _as_shown(options, session)
        recorder = None if options.out is None else _recorder(setup)
        if recorder is not None:
            stack.push(partial(_report_if_cut_short, recorder))  # once it is closed
            stack.enter_context(recorder)
            takers = (*takers, recorder.write)
        report = Report(renderer.gl_renderer, renderer.gl_version, options.quality)
        never_seen = {each.marker for each in session.arrangement.chosen if each.marker is not None}

        def next_scene(session: Session) -> Scene:
            end_if_asked()
            as_shown.set_up(session)
            if never_seen and session.tracked is not None:
                never_seen.intersection_update(session.arrangement.without_marker(session.tracked))
            return _layers(scene(session), options.layers)

        run = HeadlessRun(next_scene, options.frames, options.loop, takers, options.layers is not None)
        try:
            play_headless(setup.source, setup.tracker, session, renderer, run, report)
        except BaseException as error:  # what has been recorded until then is kept as well, whatever ends it
            if options.report is not None and report.frames:
                refusal = _report_refused(report, options)
                if refusal is None or not isinstance(error, UserError):  # which may well be about the same full disk
                    print_message(str(refusal or f"saved {options.report} ({len(report.frames)} frames)"))
            raise
        refusal = _report_refused(report, options)
    # Only now is it known what has become of the recording.
    if recorder is not None:
        _report_where(options.out, recorder.path)
    status = _summed_up(setup, session, report, never_seen)
    if refusal is not None:
        raise refusal
    return Played(status, None if recorder is None else recorder.path)


def _as_shown(options: argparse.Namespace, session: Session) -> AsShown:
    """What the file of --as-shown sets up, if one is given."""
    if options.as_shown is None:
        return AsShown()
    as_shown = read_as_shown(options.as_shown, session.table.shelf)
    check_outputs_and_models(options, session.table.shelf)  # with those that only this file names
    return as_shown


def _report_refused(report: Report, options: argparse.Namespace) -> UserError | None:
    """Writes the report if one is asked for. The error if it cannot be: the recording and the answer come first."""
    if options.report is not None:
        try:
            _report_where(options.report, report.write(options.report, options.overwrite))
        except UserError as error:
            return error
    return None


def _recorder(setup: ViewerSetup) -> Recorder | TransparentRecorder | LastPicture:
    options = setup.options
    if options.out.suffix.lower() == PICTURE_SUFFIX:
        return LastPicture(options.out, options.overwrite)
    wanted = options.out, setup.size, setup.source.fps or 1.0, options.overwrite
    return Recorder(*wanted) if options.layers is None else TransparentRecorder(*wanted)


def _report_if_cut_short(
    recorder: Recorder | TransparentRecorder | LastPicture,
    _kind: type[BaseException] | None,
    error: BaseException | None,
    _at: object,
) -> None:
    """Says where a recording is that was ended before its time, unless the error is its own, and says that."""
    if error is None or isinstance(recorder, LastPicture) or not recorder.frame_count:
        return
    if not (isinstance(error, UserError) and str(recorder.path) in error.message):
        print_message(f"saved {recorder.path} ({recorder.frame_count} frames)")


def _layers(scene: Scene, wanted: str | None) -> Scene:
    if wanted is None:
        return scene
    return cut_out(replace(scene, shows_model=wanted != "shadow", casts_shadow=wanted != "model"))


def _report_where(wanted: Path, path: Path) -> None:
    if path.parent != wanted.parent:
        print_message(f"the folder {wanted.parent} was renamed meanwhile: see {path}")
    elif path != wanted:
        print_message(f"{wanted} has appeared meanwhile and stays as it is: see {path}")


def _summed_up(setup: ViewerSetup, session: Session, report: Report, never_seen: set[str]) -> int:
    """Prints how the run went; `never_seen`: the markers of models that no picture shows."""
    found = sum(frame["found"] for frame in report.frames)
    light = "light: not estimated" if session.estimate is None else light_line(session)
    print_answer(f"{setup.source.name}: marker in {found} of {len(report.frames)} frames; {light}")
    for notice in _notices(setup, session, {frame["index"] for frame in report.frames if frame["found"]}):
        print_message(notice)
    if found and never_seen:
        print_message(f"no picture shows {listed(sorted(never_seen))}: what stands there is not drawn")
    return ExitStatus.ANSWERED if found else ExitStatus.NO_MARKER


def _notices(setup: ViewerSetup, session: Session, found: set[int]) -> Iterator[str]:
    """Notices about what did not go as asked; `found`: the indices of the frames with a marker."""
    name, options = setup.source.name, setup.options
    if setup.source.note is not None:
        yield setup.source.note
    if not found:
        instead = SeenInstead() if session.tracked is None else seen_instead(session.tracked.frame.image_bgr)
        if not setup.source.is_photo:
            instead = replace(instead, fault=None)  # a clip's last picture may be the end of a fade
        yield f"{name}: {not_found_text(options.marker, not options.takes_any_marker, instead)}"
    elif options.estimate_at not in (None, *found):
        yield f"nothing to estimate in frame {options.estimate_at}: no marker in it, or no such frame was played"
    elif session.notice.text is not None:
        yield session.notice.text
    camera = camera_line(session.tracked)
    if camera is not None and session.tracked is not None and session.tracked.camera.source == "estimated":
        yield camera
    elif session.tracked is not None and (note := assumed_note(session.tracked)) is not None:
        yield note
