"""`ashe-live estimate`: where the light is, one-shot, in photos and clips, folders and patterns."""

import argparse
import math
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from ashe_live.commands.answers.empty_table import EmptyTable
from ashe_live.commands.answers.file_answers import FileEstimator
from ashe_live.commands.answers.light_page import LightPage
from ashe_live.commands.flags.model_choice import marker_files
from ashe_live.commands.flags.named_files import named_files
from ashe_live.commands.flags.setup import camera_chooser, light_preset, make_tracker
from ashe_live.core.arrays import Image
from ashe_live.core.contract import FileRecord
from ashe_live.drawing.light_text import light_text
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files.writing import check_folder, check_outputs, make_folder
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.light.live.clean_plates import refuse_unused
from ashe_live.process.console import TerminalConsole
from ashe_live.process.messages import listed, print_answer, print_exactly, print_message, printable
from ashe_live.process.signals import ended_by_signals

PAGES = (".html", ".htm")
NAMED = 3  # of the files without a marker in a folder
WORST_FIRST = (
    ExitStatus.FAULT,
    ExitStatus.WRONG_USE,
    ExitStatus.NO_MARKER,
    ExitStatus.NO_DIRECTIONAL_LIGHT,
    ExitStatus.ANSWERED,
)


def run(options: argparse.Namespace) -> int:
    named = _checked_files(options)
    estimator = make_estimator(options.estimator, light_preset(options))
    camera_for = camera_chooser(options)
    empty = _empty_table(options, estimator.name)
    make_tracker(options, camera_for)  # reports a wrong --marker before any file is opened
    files = FileEstimator(estimator, camera_for, options, empty)
    told = _ToldAnswers(options)
    answers = files.of_all(named) if options.together else (files.of(path) for path in _watched(named))
    with ended_by_signals() as end_if_asked:
        try:
            for record, picture in answers:
                if not told.tell(record, picture):
                    break
                end_if_asked()
        finally:  # a request to end in the middle of a long batch must not lose the sheet
            told.tell_what_is_left()
    if files.without_steps:
        told.statuses.add(ExitStatus.WRONG_USE)
    return next(status for status in WORST_FIRST if status in told.statuses)


def _checked_files(options: argparse.Namespace) -> list[Path]:
    """The files to estimate. Raises UserError, before any is opened, where what is asked for cannot be written."""
    if options.debug is not None:
        check_folder(options.debug)
    _check_frames(options)
    named = named_files(options.files)
    if options.sheet is not None and options.sheet.suffix.lower() not in PAGES:
        raise UserError(f"the sheet is a page, and {options.sheet} is not named as one", "let its name end in .html")
    sheets = [] if _is_in_folder_to_be(options.sheet, options.debug) else [options.sheet]
    caster = None if options.caster is None else Path(options.caster)  # it may be a model's file
    inputs = [*named, options.empty, options.camera_file, options.debug, caster, *marker_files(options)]
    check_outputs(sheets, inputs, options.overwrite)
    return named


class _ToldAnswers:
    """Prints the answers file by file, and keeps for the end what is told of all files together."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        # For the sheet, if no steps have been written into it by then.
        self._folder_to_make = options.debug if _is_in_folder_to_be(options.sheet, options.debug) else None
        self._page = LightPage()
        self._without_marker: dict[str, list[str]] = {}  # what is said of them, and the files that no one named
        self.statuses: set[ExitStatus] = set()

    def tell(self, record: FileRecord, picture: Image | None) -> bool:
        """Prints the answer and puts it onto the sheet; returns whether anyone is there for the next one."""
        options = self._options
        self.statuses.add(_status(record))
        is_read = True
        if options.json:
            is_read = print_exactly(record.to_line())
        elif _shows_no_marker(record) and Path(record.file) not in options.files:
            self._without_marker.setdefault(record.not_found, []).append(record.file)
        else:
            is_read = print_answer(_line(record))
        if options.sheet is not None:
            self._page.add(_named(record), _answer_text(record), picture)
        return is_read or options.sheet is not None or options.debug is not None

    def tell_what_is_left(self) -> None:
        """Names the files without a marker, and writes the sheet."""
        options = self._options
        for not_found, files in self._without_marker.items():
            print_answer(f"{listed(files, NAMED)}: {not_found}")
        if self._page.has_figures:
            if self._folder_to_make is not None:
                make_folder(self._folder_to_make)
            print_message(f"sheet in {self._page.write(options.sheet, options.overwrite)}")


def _is_in_folder_to_be(sheet: Path | None, folder: Path | None) -> bool:
    """Whether the sheet is to be put beside the steps, into a folder that is made when there is something to write."""
    return (
        sheet is not None
        and folder is not None
        and not folder.exists()
        and sheet.absolute().parent == folder.absolute()
    )


def _empty_table(options: argparse.Namespace, estimator: str) -> EmptyTable | None:
    if options.empty is None:
        return None
    if options.together:
        raise UserError("--empty is for a camera that stands still, and --together for one that moves", "leave one out")
    refuse_unused(estimator, "--empty")
    return EmptyTable.read(options.empty)


def _check_frames(options: argparse.Namespace) -> None:
    first, last = options.frames
    at = options.estimate_at
    if at is not None and not first <= at <= (at if last is None else last):
        raise UserError(f"--estimate-at {at} is not within --frames", "choose a frame within them")


def _watched(paths: Sequence[Path]) -> Iterator[Path]:
    """The paths, with a progress bar on stderr if that is a terminal and there is something to wait for."""
    progress = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=TerminalConsole(stderr=True),
        transient=True,
        disable=len(paths) < 2 or not sys.stderr.isatty(),
        # On a terminal the answers are printed above the bar; into a file or another program they go unchanged.
        redirect_stdout=sys.stdout.isatty(),
    )
    with progress:
        task = progress.add_task("", total=len(paths))
        for path in paths:
            progress.update(task, description=printable(path.name, 60))
            yield path
            progress.advance(task)


def _named(record: FileRecord) -> str:
    """The name of the file, or of all files that the answer rests on."""
    return listed(dict.fromkeys(file for file, _ in record.places) or [record.file])


def _line(record: FileRecord) -> str:
    """The line about a file: its name, unless the error says it itself, and the answer."""
    # A name may be as short as a word of the error, or as a letter in one.
    as_word = rf"(?<!\w){re.escape(printable(record.file))}(?!\w)"
    names_itself = record.error is not None and re.search(as_word, record.error) is not None
    answer = _answer_text(record)
    return answer if names_itself else f"{_named(record)}: {answer}"


def _answer_text(record: FileRecord) -> str:
    if record.error is not None:
        return record.error
    if record.marker is None:
        return record.not_found
    estimate = record.estimate
    assert estimate is not None
    if not estimate.lights:
        return f"no clear light: {estimate.reason}"
    milliseconds = (record.timing_ms or {}).get("total", 0.0)
    where = "" if record.is_photo else f"frame {record.frame}, "
    if estimate.span_rad is not None:
        where = f"{len(estimate.views)} views over {math.degrees(estimate.span_rad):.0f}°, "
    lights = "; ".join(light_text(light, decimals=1) for light in estimate.lights)
    return f"{lights} ({where}{milliseconds:.0f} ms)"


def _shows_no_marker(record: FileRecord) -> bool:
    """Whether the file could be read and has no marker at all, neither the one that is looked for nor another."""
    return record.error is None and record.marker is None and not record.in_view


def _status(record: FileRecord) -> ExitStatus:
    if record.error is not None:
        return ExitStatus.FAULT if record.is_fault else ExitStatus.WRONG_USE
    if record.estimate is None:
        return ExitStatus.NO_MARKER
    return ExitStatus.ANSWERED if record.estimate.lights else ExitStatus.NO_DIRECTIONAL_LIGHT
