"""`ashe-live estimate`: where the light is, one-shot, in photos and clips, folders and patterns."""

import argparse
import dataclasses
import statistics
import sys
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path

from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from ashe_live.capture.snapshot import write_png
from ashe_live.capture.sources import Source, open_source
from ashe_live.commands.light_page import LightPage, picture_of
from ashe_live.commands.marker_choice import others_said, with_marker_in
from ashe_live.commands.named_files import named_files
from ashe_live.commands.setup import CameraFor, camera_chooser, light_steps, make_tracker
from ashe_live.core.contract import FileRecord
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.drawing.contact_sheet import contact_sheet
from ashe_live.drawing.steps import DebugPicture, debug_pictures
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files.writing import check_outputs, make_folder, unused_name
from ashe_live.light.estimators.estimator import Estimator, TracingEstimator, make_estimator
from ashe_live.process.console import TerminalConsole
from ashe_live.process.messages import printable, say, say_exactly, tell
from ashe_live.tracking.focal_tracker import FocalTracker
from ashe_live.tracking.in_view import markers_in_view
from ashe_live.tracking.steadiness import Steadiness
from ashe_live.tracking.tracker import MarkerTracker

STEP_WIDTH_PX = 480
# Of a clip by an unknown camera: so much of it is watched for the focal length, before the frame is chosen.
LEARNING_S = 10.0
WORST_FIRST = (
    ExitStatus.WRONG_USE,
    ExitStatus.NO_MARKER,
    ExitStatus.NO_DIRECTIONAL_LIGHT,
    ExitStatus.ANSWERED,
)


def run(options: argparse.Namespace) -> int:
    if options.debug is not None:
        make_folder(options.debug)
    named = named_files(options.files)
    check_outputs([options.sheet], [*named, options.camera_file], options.overwrite)
    estimator = make_estimator(options.estimator, light_steps(options))
    camera_for = camera_chooser(options)
    make_tracker(options, camera_for)  # a marker that is none is said before any file is opened
    page = LightPage()
    statuses = set()
    for path in _watched(named):
        record, tracked = _answer(path, camera_for, estimator, options)
        is_read = say_exactly(record.to_line()) if options.json else say(_line(record))
        statuses.add(_status(record))
        if options.sheet is not None:
            picture = None if tracked is None else picture_of(tracked, record.estimate)
            page.add(record.file, _said(record), picture)
        elif not is_read and options.debug is None:
            break  # nobody wants the rest
    if options.sheet is not None:
        tell(f"sheet in {page.write(options.sheet, options.overwrite)}")
    return next(status for status in WORST_FIRST if status in statuses)


def _watched(paths: Sequence[Path]) -> Iterator[Path]:
    """The paths, and how far they are on stderr, if a person looks at it and there is something to wait for."""
    progress = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=TerminalConsole(stderr=True),
        transient=True,
        disable=len(paths) < 2 or not sys.stderr.isatty(),
        # Lines for a person go above the bar; those for a file or another program go there, as they are.
        redirect_stdout=sys.stdout.isatty(),
    )
    with progress:
        task = progress.add_task("", total=len(paths))
        for path in paths:
            progress.update(task, description=escape(printable(path.name, 60)))
            yield path
            progress.advance(task)


def _answer(
    path: Path, camera_for: CameraFor, estimator: Estimator, options: argparse.Namespace
) -> tuple[FileRecord, TrackedFrame | None]:
    """What is said about a file, and the frame that was used, unless the file cannot be."""
    record = FileRecord(str(path), options.quality, options.estimator)
    if path.is_dir():  # in the place of others stand the files in them
        problem = "there is no photo or clip in it: name another folder, or files"
        return dataclasses.replace(record, error=problem), None
    try:
        with open_source(path) as source:
            tracker = make_tracker(with_marker_in(source, options), camera_for, source=source)
            if isinstance(tracker, FocalTracker):
                learn_focal_length(source, tracker)
            tracked = usable_frame(source, tracker, options.estimate_at)
    except UserError as error:
        return dataclasses.replace(record, error=printable(error)), None
    record = dataclasses.replace(record, frame=tracked.frame.index, camera=tracked.camera, marker=tracked.marker)
    if tracked.marker is None:
        in_view = markers_in_view(tracked.frame.image_bgr)
        times = {"detect": tracked.detect_ms, "total": tracked.detect_ms}
        return dataclasses.replace(record, timing_ms=times, in_view=in_view), tracked
    estimate, timing_ms = _timed(tracker, tracked, estimator, options.repeat)
    if options.debug is not None:
        trace = None
        if isinstance(estimator, TracingEstimator):
            estimate, trace = estimator.traced(tracked)
        sheet = _write_steps(options.debug, path, debug_pictures(tracked, estimate, trace))
        tell(f"{path}: steps in {sheet}")
    return dataclasses.replace(record, estimate=estimate, timing_ms=timing_ms), tracked


def learn_focal_length(source: Source, tracker: FocalTracker) -> None:
    """Watches a clip's beginning, as far as it has something to tell, and goes back to its start."""
    if source.is_photo:
        return
    while not tracker.is_sure and (frame := source.read()) is not None and frame.time_s <= LEARNING_S:
        tracker.track(frame)
    source.rewind()
    tracker.reset()


def usable_frame(source: Source, tracker: MarkerTracker, estimate_at: int | None) -> TrackedFrame:
    """Frame `estimate_at`, or the first one with a steady marker, or else with a marker at all, or else the last.

    Raises UserError when the source ends before `estimate_at`.
    """
    steadiness = Steadiness(1) if source.is_photo else Steadiness()
    found: TrackedFrame | None = None
    last: TrackedFrame | None = None
    while (frame := source.read()) is not None:
        last = tracker.track(frame)
        if frame.index == estimate_at:
            return last
        if estimate_at is None and steadiness.add(last.marker):
            return last
        if last.marker is not None:
            found = found or last
    if estimate_at is not None and last is not None:
        raise UserError(
            f"there is no frame {estimate_at} in it", f"choose one from 0 to {last.frame.index} for --estimate-at"
        )
    answer = found or last
    if answer is None:
        raise UserError("there is no readable picture in it", "copy or record it again")
    return answer


def _write_steps(folder: Path, file: Path, pictures: Sequence[DebugPicture]) -> Path:
    """One sheet with all steps of an estimate, under a name that is not taken yet. Raises UserError."""
    sheet = contact_sheet(
        [picture.image_bgr for picture in pictures], [picture.title for picture in pictures], 4, STEP_WIDTH_PX
    )
    path = unused_name(folder, file.stem, ".png", datetime.now())
    return write_png(path, sheet, beside=True)


def _timed(
    tracker: MarkerTracker, tracked: TrackedFrame, estimator: Estimator, repeat: int | None
) -> tuple[LightEstimate, Mapping[str, float]]:
    """Once; or, after a warm-up, `repeat` times with the median time of every stage."""
    runs = []
    for _ in range(1 if repeat is None else repeat + 1):
        if repeat is not None:
            tracker.reset()
            tracked = tracker.track(tracked.frame)
        estimate = estimator.estimate(tracked)
        runs.append({**estimate.timing_ms, "detect": tracked.detect_ms})
        runs[-1]["total"] = estimate.timing_ms["total"] + tracked.detect_ms
    counted = runs[1:] or runs
    return estimate, {stage: statistics.median(run[stage] for run in counted) for stage in counted[0]}


def _line(record: FileRecord) -> str:
    """What is said of a file, after its name, which most errors say themselves."""
    said = _said(record)
    return said if printable(record.file) in said else f"{record.file}: {said}"


def _said(record: FileRecord) -> str:
    if record.error is not None:
        return record.error
    if record.marker is None:
        if record.in_view:
            return f"the marker was not found: {others_said(record.in_view)}"
        return "no marker found: show all of it, or name the one that is there with --marker"
    assert record.estimate is not None
    light = record.estimate.light
    if light is None:
        return f"no directional light ({record.estimate.reason})"
    milliseconds = (record.timing_ms or {}).get("total", 0.0)
    return f"{light.summary(decimals=1)} (frame {record.frame}, {milliseconds:.0f} ms)"


def _status(record: FileRecord) -> ExitStatus:
    if record.error is not None:
        return ExitStatus.WRONG_USE
    if record.estimate is None:
        return ExitStatus.NO_MARKER
    return ExitStatus.ANSWERED if record.estimate.lights else ExitStatus.NO_DIRECTIONAL_LIGHT
