"""`ashe-live calibrate`: a camera's K and distortion, from a board shown to it, or from a clip or photos of one."""

import argparse
import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from rich.progress import BarColumn, Progress, TextColumn
from rich.table import Table

from ashe_live.capture.cameras import connected
from ashe_live.capture.folder import pictures_in
from ashe_live.capture.opening import open_source
from ashe_live.capture.photo_series import PhotoSeries
from ashe_live.capture.sources import Source, SourceLost
from ashe_live.capture.webcam import WebcamSource
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.core.types import Frame
from ashe_live.errors import ExitStatus, UserError
from ashe_live.files.writing import check_outputs, write_json
from ashe_live.process.console import TerminalConsole
from ashe_live.process.messages import print_answer, print_message
from ashe_live.tracking.boards.calibration import CameraCalibration
from ashe_live.tracking.boards.calibration_board import BoardView, CalibrationBoard
from ashe_live.tracking.boards.calibration_guide import CalibrationGuide, KeptView

RECONNECT_EVERY_S = 0.5


class Guidance(Protocol):
    """Tells a person how the board is still to be shown."""

    def show(self, frame: Frame, view: BoardView | None, guide: CalibrationGuide, said: str | None) -> bool:
        """Shows what this frame gave and what is wanted next; returns False when the user wants to end."""
        ...


def run(options: argparse.Namespace) -> int:
    inputs = [Path(options.camera), settings_path()]
    if options.size is not None and not options.camera.isdecimal() and _is_recorded(options.camera):
        raise UserError("--size is asked of a connected camera, and clips and photos have theirs", "leave it out")
    with contextlib.suppress(UserError):  # opening it says why
        inputs += pictures_in(inputs[0], with_clips=False)[0]
    check_outputs([options.out], inputs, options.overwrite)
    with _opened(options) as source:
        if (said := source.note) is not None:
            print_message(said)
        guide = CalibrationGuide(source.size)
        with _window(source) if source.is_live and not options.headless else _lines() as guidance:
            calibration = _collect(source, guide, guidance)
        if source.note not in (None, said):
            print_message(source.note)
    calibration = calibration or guide.calibration()
    console = TerminalConsole()
    try:
        path = write_json(options.out, calibration.to_json(), options.overwrite, beside=True)
    finally:  # the figures are not lost with the file
        _print_figures(console, calibration, guide.kept)
    print_answer(
        f"{path}: {calibration.rms_px:.2f} px off on average in {int(calibration.used.sum())} of {len(guide.kept)} "
        f"views; use it with --camera-file {path}"
    )
    return ExitStatus.ANSWERED


def _is_recorded(path: str) -> bool:
    return os.path.isfile(path) or os.path.isdir(path)  # noqa: PTH112, PTH113 - a name that is too long is none


def _opened(options: argparse.Namespace) -> Source:
    if options.camera.isdecimal():
        try:
            return WebcamSource(int(options.camera), options.size)
        except UserError:
            if connected():
                raise
            remedy = "connect one, or name a clip or a folder of photos of the board with --camera"
            raise UserError("there is no camera", remedy) from None
    path = Path(options.camera)
    if path.is_dir():
        return PhotoSeries(path)
    # A camera may be named by its device file.
    return WebcamSource(options.camera, options.size) if path.is_char_device() else open_source(path)


def _collect(source: Source, guide: CalibrationGuide, guidance: Guidance) -> CameraCalibration | None:
    """Reads until a live camera is calibrated; None at the end of a clip, and where the user ended it before."""
    board = CalibrationBoard()
    said: str | None = None
    try:
        for frame in _frames(source, guide, guidance):
            if frame.size != guide.size:
                raise UserError(f"the pictures change their size to {frame.size[0]}x{frame.size[1]}", "use one size")
            view = board.find(np.asarray(cv2.cvtColor(frame.image_bgr, cv2.COLOR_BGR2GRAY), dtype=np.uint8))
            is_new = guide.add(view, frame.index)
            if source.is_live and is_new and guide.wanted() is None:
                try:
                    return guide.calibration()
                except UserError as error:
                    said = str(error)
            if not guidance.show(frame, view, guide, said):
                return None
    except KeyboardInterrupt:  # without a window the way to say that it is enough
        if not guide.frames_with_board:
            raise
    return None


def _frames(source: Source, guide: CalibrationGuide, guidance: Guidance) -> Iterator[Frame]:
    """The frames of a clip, or of a camera, which is waited for where it was unplugged, until the user ends that."""
    frame: Frame | None = None
    while True:
        try:
            new = source.read()
        except SourceLost as lost:
            if frame is None or not guidance.show(frame, None, guide, str(lost)):
                return
            if not source.reopen():
                time.sleep(RECONNECT_EVERY_S)
            continue
        if new is None:
            return
        frame = new
        yield frame


class _Lines:
    """A progress bar that says what is wanted, redrawn in place on a terminal."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._task = progress.add_task("looking for the board", total=1.0, views=0)

    def show(self, frame: Frame, view: BoardView | None, guide: CalibrationGuide, said: str | None) -> bool:
        wanted = said or (
            guide.wanted() or "enough views, more make it more accurate" if view is not None else "no board in view"
        )
        self._progress.update(
            self._task, completed=guide.progress, views=len(guide.kept), description=f"frame {frame.index}: {wanted}"
        )
        return True


@contextlib.contextmanager
def _lines() -> Iterator[Guidance]:
    columns = (BarColumn(), TextColumn("views: {task.fields[views]}  {task.description}", markup=False))
    with Progress(*columns, console=TerminalConsole(stderr=True)) as progress:
        yield _Lines(progress)


@contextlib.contextmanager
def _window(source: Source) -> Iterator[Guidance]:
    """Guidance in a window, or in lines where there is no display."""
    from ashe_live.commands.viewing.setup import has_display
    from ashe_live.viewer.windows.calibration_window import CalibrationWindow

    with CalibrationWindow(source.name, source.size) if has_display() else _lines() as guidance:
        yield guidance


def _print_figures(console: TerminalConsole, calibration: CameraCalibration, kept: list[KeptView]) -> None:
    table = Table("view", "frame", "corners", "error, px", "")
    for number, (view, rms_px, used) in enumerate(
        zip(kept, calibration.view_rms_px, calibration.used, strict=True), start=1
    ):
        left_out = "" if used else "left out"
        table.add_row(str(number), str(view.frame_index), str(len(view.view.points)), f"{rms_px:.3f}", left_out)
    console.print(table)
    K, sigma_f, sigma_c = calibration.camera.K, calibration.sigma_f_px, calibration.sigma_c_px
    dist = ", ".join(
        f"{value:.4f} ± {sigma:.4f}" if value else "0"
        for value, sigma in zip(calibration.camera.dist, calibration.sigma_dist, strict=True)
    )
    console.print(
        f"f {K[0, 0]:.1f} ± {sigma_f[0]:.1f}, {K[1, 1]:.1f} ± {sigma_f[1]:.1f} px; "
        f"c {K[0, 2]:.1f} ± {sigma_c[0]:.1f}, {K[1, 2]:.1f} ± {sigma_c[1]:.1f} px; distortion {dist}",
        soft_wrap=True,
    )
