"""Estimates the light in files: in each by itself, or in several that show one scene."""

import argparse
import dataclasses
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TypeVar

from ashe_live.capture.folder import refuse_folder
from ashe_live.capture.opening import open_source, openable
from ashe_live.commands.answers.empty_table import EmptyTable
from ashe_live.commands.answers.light_page import picture_of
from ashe_live.commands.answers.looked_at import LookedAt, Wanted, look_at, renumbered
from ashe_live.commands.answers.steps_sheet import write_steps
from ashe_live.commands.flags.marker_choice import marker_in, not_found_text, with_marker, with_marker_in
from ashe_live.commands.flags.model_choice import refuse_model
from ashe_live.commands.flags.setup import CameraFor, assumed_note, cameras_of_all, make_tracker, states_no_camera
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.contract import FileRecord
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.steps import DebugPicture, debug_pictures
from ashe_live.errors import UserError
from ashe_live.files.reading import as_given
from ashe_live.light.estimators.estimator import Estimator, TracingEstimator
from ashe_live.light.live.key_views import LEAST_SPAN_RAD, span_of
from ashe_live.light.live.same_scene import first_of_most, of_one_scene
from ashe_live.process.messages import listed, print_message, printable
from ashe_live.process.unexpected_errors import fault, outer_cause, show_traceback
from ashe_live.tracking.families.seen_instead import seen_instead
from ashe_live.tracking.tracker import MarkerTracker

Result = TypeVar("Result")

# The record, and, if a sheet is asked for, the frame that was used with the light drawn in; None if there is none.
FileAnswer = tuple[FileRecord, Image | None]


@dataclasses.dataclass(frozen=True, slots=True)
class FileEstimator:
    """An estimator with the options that concern files."""

    estimator: Estimator
    camera_for: CameraFor
    options: argparse.Namespace
    empty: EmptyTable | None = None
    # What the user has been told, and is not told again for every file.
    faults: set[str] = dataclasses.field(default_factory=set)  # faults whose traceback has been shown
    followed: set[str] = dataclasses.field(default_factory=set)  # markers that are followed without having been named
    assumed: set[str] = dataclasses.field(default_factory=set)  # what of cameras is assumed
    without_steps: set[Path] = dataclasses.field(default_factory=set)  # files whose steps could not be written

    def of(self, path: Path) -> FileAnswer:
        """The answer for a file."""

        def answered() -> FileAnswer:
            looked = self._looked_at(path, self.options, {})
            return looked if isinstance(looked, tuple) else self._answered(looked)

        return self._guarded(path, answered)

    def of_all(self, paths: Sequence[Path]) -> Iterator[FileAnswer]:
        """One answer for all files together, preceded by those for files that cannot be used for it.

        Raises UserError when there is only one file.
        """
        if len(paths) < 2:
            raise UserError("--together needs two files or more", "name them, or leave it out")
        options = self._marker_of_all(paths)
        cameras = cameras_of_all(paths, options, self.camera_for)
        used: list[_Looked] = []
        for path in paths:
            looked = self._guarded(path, partial(self._looked_at, path, options, cameras))
            if isinstance(looked, tuple):
                yield looked
            else:
                used.append(looked)
        if used:
            usual = first_of_most([each.seen.frozen for each in used])
            used.sort(key=lambda each: each.seen.frozen is not usual)  # the others stay in their order
            yield self._guarded(used[0].path, partial(self._answered, *used))

    def _guarded(self, path: Path, work: Callable[[], Result]) -> Result | FileAnswer:
        """What `work` returns; if it raises an unforeseen exception, an answer that says so."""
        try:
            return work()
        except UserError:
            raise
        except Exception as error:
            cause = outer_cause(error)
            said = cause or f"the program failed ({fault(error)}): report it with the traceback on standard error"
            if cause is None and said not in self.faults:
                self.faults.add(said)
                show_traceback(error)
            record = FileRecord(as_given(path), self.options.quality, self.options.estimator)
            return dataclasses.replace(record, error=printable(said), is_fault=cause is None), None

    def _looked_at(
        self, path: Path, options: argparse.Namespace, cameras: Mapping[Size, Camera]
    ) -> "_Looked | FileAnswer":
        """What the file shows, or an answer that says why it shows nothing. `cameras`: for photos that state none."""
        record = FileRecord(as_given(path), options.quality, options.estimator)
        first, last = options.frames
        wanted = Wanted(options.views if self.empty is None else 1, options.estimate_at, first, last)
        try:
            refuse_folder(path)  # others have been replaced by the files in them
            refuse_model(path)
            with open_source(path) as source:
                is_known = states_no_camera(source) and source.size in cameras
                camera_for = cameras.__getitem__ if is_known else self.camera_for
                chosen = with_marker_in(source, options, self.followed, searched=options.frames)
                tracker = make_tracker(chosen, camera_for, source=source)
                record = dataclasses.replace(record, is_photo=source.is_photo)
                seen = look_at(source, tracker, wanted)
                seen = seen if self.empty is None else LookedAt(self.empty.under(seen.frozen, tracker))
        except UserError as error:
            return dataclasses.replace(record, error=printable(error)), None
        tracked = seen.frozen
        record = dataclasses.replace(record, frame=tracked.frame.index, camera=tracked.camera, marker=tracked.marker)
        if source.note is not None:
            print_message(source.note)
        if tracked.note is not None:
            print_message(f"{path}: {tracked.note}")
        if (note := assumed_note(tracked)) is not None and note not in self.assumed:
            self.assumed.add(note)
            print_message(note)
        if tracked.marker is not None:
            return _Looked(path, record, seen, tracker)
        times = {"detect": tracked.detect_ms, "total": tracked.detect_ms}
        instead = seen_instead(tracked.frame.image_bgr)
        not_found = not_found_text(chosen.marker, not self.options.takes_any_marker, instead)
        record = dataclasses.replace(record, timing_ms=times, in_view=instead.in_view, not_found=not_found)
        return record, self._picture(tracked, None)

    def _answered(self, first: "_Looked", *more: "_Looked") -> FileAnswer:
        """The answer for the first file's frozen frame, from all views."""
        places: dict[int, tuple[str, int]] = {}
        frozen, *others = _renumbered([first, *more], places) if more else (first.seen.frozen, *first.seen.others)
        others = self._of_one_scene(frozen, others, places)
        if not more and span_of([frozen, *others]) < LEAST_SPAN_RAD:
            others = []  # the camera stood still: they show hardly more than the frame alone
        if len(others) >= self.options.views:
            print_message(f"of {len(others) + 1} views the first {self.options.views} are used")
            others = others[: self.options.views - 1]
        estimate, timing_ms = self._timed(first.tracker, frozen, others)
        if self.options.debug is not None:
            trace = None
            if isinstance(self.estimator, TracingEstimator):
                estimate, trace = self.estimator.traced(frozen, others)
            self._keep_steps(first.path, debug_pictures(frozen, estimate, trace))
        if more and estimate.lights:
            _report_unused(
                [places[view.frame.index][0] for view in others], [places[view][0] for view in estimate.views]
            )
        record = dataclasses.replace(
            first.record,
            estimate=estimate,
            timing_ms=timing_ms,
            places=tuple(places[view] for view in estimate.views) if more else (),
        )
        return record, self._picture(first.seen.frozen, estimate)

    def _keep_steps(self, file: Path, pictures: Sequence[DebugPicture]) -> None:
        """Writes them, and says where, or why not: the answer is worth more than they are, and is given anyway."""
        try:
            print_message(f"{file}: steps in {write_steps(self.options.debug, file, pictures)}")
        except UserError as error:
            self.without_steps.add(file)
            print_message(f"{file}: without its steps: {error}")

    def _picture(self, tracked: TrackedFrame, estimate: LightEstimate | None) -> Image | None:
        return None if self.options.sheet is None else picture_of(tracked, estimate)

    def _of_one_scene(
        self, frozen: TrackedFrame, others: Sequence[TrackedFrame], places: Mapping[int, tuple[str, int]]
    ) -> list[TrackedFrame]:
        of_it = of_one_scene(frozen, others)
        if places and len(of_it) < len(others):
            kept = {view.frame.index for view in of_it}
            gone = sorted({places[view.frame.index][0] for view in others if view.frame.index not in kept})
            print_message(f"{listed(gone)}: another light or arrangement than in {places[0][0]}, and left out")
        return of_it

    def _marker_of_all(self, paths: Sequence[Path]) -> argparse.Namespace:
        """The options with the marker of the first file in which there is one."""
        frames = self.options.frames
        for source in openable(paths) if self.options.takes_any_marker else ():
            with suppress(Exception):  # its own line says so
                if (found := marker_in(source, self.options, self.followed, searched=frames)) is not None:
                    return with_marker(self.options, found)
        return self.options

    def _timed(
        self, tracker: MarkerTracker, tracked: TrackedFrame, others: Sequence[TrackedFrame]
    ) -> tuple[LightEstimate, Mapping[str, float]]:
        """The estimate, and the time of every stage: with --repeat the median of so many runs after this warm-up.

        These look for the marker anew in the frame alone, so that their pose is not that of the answer, which a filter
        and the frames before it have a part in.
        """
        estimate = self.estimator.estimate(tracked, others)
        runs = [_times(tracked, estimate)]
        for _ in range(self.options.repeat or 0):
            tracker.reset()
            again = dataclasses.replace(tracker.track(tracked.frame), clean_plate_bgr=tracked.clean_plate_bgr)
            runs.append(_times(again, self.estimator.estimate(again, others)))
        counted = runs[1:] or runs
        return estimate, {stage: statistics.median(run[stage] for run in counted) for stage in counted[0]}


@dataclasses.dataclass(frozen=True, slots=True)
class _Looked:
    """A file in which there is a marker."""

    path: Path
    record: FileRecord
    seen: LookedAt
    tracker: MarkerTracker


def _times(tracked: TrackedFrame, estimate: LightEstimate) -> dict[str, float]:
    """Milliseconds by stage, with those in which the marker was found."""
    total = estimate.timing_ms["total"] + tracked.detect_ms
    return {**estimate.timing_ms, "detect": tracked.detect_ms, "total": total}


def _renumbered(looked: Sequence[_Looked], places: dict[int, tuple[str, int]]) -> list[TrackedFrame]:
    """All views, numbered anew, the first at its full size; adds to `places` where each comes from."""
    views: list[TrackedFrame] = []
    for each in looked:
        for view in (each.seen.frozen, *each.seen.others):
            places[len(views)] = str(each.path), view.frame.index
            views.append(renumbered(view, len(views), is_kept_large=not views))
    return views


def _report_unused(given: Sequence[str], used: Sequence[str]) -> None:
    """Says which files the estimator was given besides the first one, and has not used."""
    unused = [file for file in dict.fromkeys(given) if file not in used]
    if unused:
        print_message(f"{listed(unused)}: not used; the answer rests on {listed(dict.fromkeys(used))}")
