"""What is played and how, and its preparation, which is the same with a window and without one."""

import argparse
import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ashe_live.capture.recording.cut_short import rescue_recordings
from ashe_live.capture.recording.last_picture import PICTURE_SUFFIX
from ashe_live.capture.sources import Source
from ashe_live.commands.flags.model_choice import chosen_models, marker_files, names_of
from ashe_live.commands.flags.settings_file import settings_path
from ashe_live.commands.flags.setup import light_preset
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size, drawn_size
from ashe_live.errors import UserError
from ashe_live.files import writing as files
from ashe_live.light.live.worker import LightWorker
from ashe_live.models.catalogue import model_names
from ashe_live.models.memory import ModelMemory
from ashe_live.process.messages import print_message
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.cores import leave_cores_to_renderer
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.session import Session
from ashe_live.viewer.table.shelf import Shelf

# Options that a window refuses: what is said of each, and what helps.
WITHOUT_WINDOW = {
    "layers": ("--layers are written without a window", "give --headless --out FILE.mov too; Shift+S saves one"),
    "as_shown": ("--as-shown is shown without a window only", "give --headless --out FILE.mp4 too"),
    "report": ("--report is written without a window only", "give --headless too"),
}


@dataclass(frozen=True, slots=True)
class ViewerSetup:
    """A source, and how it is to be shown."""

    source: Source
    tracker: MarkerTracker
    options: argparse.Namespace
    true_to_light_marker: Float | None = None  # (3,) unit, where it is known
    shows_light: bool = False
    # Makes a tracker for another marker's spec, or another field of view in degrees; None: neither can be changed.
    tracker_for: Callable[[str | None, float | None], MarkerTracker] | None = None
    notes: tuple[str, ...] = ()  # printed once all can be shown, as an error is printed alone

    @property
    def size(self) -> Size:
        size: Size = self.options.size or drawn_size(self.source.size)
        return size


def check_outputs(options: argparse.Namespace, *played: Path) -> None:
    """Raises UserError, before anything is opened, if an output must not or cannot be written.

    played: what is read although no option names it.
    """
    models = [Path(name) for name in names_of(options) if name not in model_names()]
    caster = None if options.caster is None else Path(options.caster)  # it may be a model's file
    inputs = [getattr(options, "file", None), options.camera_file, options.as_shown, caster]
    inputs += [*models, *marker_files(options), *played, settings_path()]
    files.check_outputs((options.out, options.report), inputs, options.overwrite)
    for name, refusal in WITHOUT_WINDOW.items():
        if getattr(options, name) is not None and not options.headless:
            raise UserError(*refusal)
    if options.headless and options.loop and options.frames is None:
        raise UserError("--loop without a window never ends", "give --frames N too")
    if options.layers is not None and options.out is None:
        raise UserError(*WITHOUT_WINDOW["layers"])
    if options.out is not None:
        _check_suffix(options.out, options)


def check_outputs_and_models(options: argparse.Namespace, shelf: Shelf) -> None:
    """Raises UserError if an output would replace what a model is read from: its file, or what that names."""
    if options.overwrite:  # else nothing is replaced
        own = [name for name in shelf.names if name not in model_names()]
        read = [path for name in own for path in (Path(name), *shelf.loaded(name).model.read_beside)]
        files.check_outputs((options.out, options.report), read, options.overwrite)


def _check_suffix(out: Path, options: argparse.Namespace) -> None:
    suffix = out.suffix.lower()
    if suffix == PICTURE_SUFFIX and not options.headless:
        raise UserError("--out FILE.png is written without a window only", "give --headless too; S saves a picture")
    kinds = {".mp4": "a clip"} if options.layers is None else {".mov": "ProRes 4444", ".webm": "VP9"}
    kinds[PICTURE_SUFFIX] = "the last picture alone"
    if suffix not in kinds:
        ends = ", ".join(f"{suffix} ({what})" for suffix, what in kinds.items())
        raise UserError(f"{out} is of no kind that is recorded", f"let its name end in {ends}")


def has_display() -> bool:
    """Whether a window may be possible; only X11 and Wayland name their display in the environment."""
    return not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextlib.contextmanager
def opened_session(setup: ViewerSetup) -> Iterator[Session]:
    """The session of `setup` with its light process, which ends with it."""
    options = setup.options
    leave_cores_to_renderer()
    first_estimate = FirstEstimate(Steadiness.of(setup.source.is_photo), not setup.source.is_live, options.estimate_at)
    first, *others = chosen_models(options)
    side_m, names = setup.tracker.side_m, [other.name for other in others]
    preset = light_preset(options)
    shelf = Shelf(first.name, side_m, options.up, ModelMemory(has_places=not options.headless), names)
    check_outputs_and_models(options, shelf)
    with LightWorker(options.estimator) as worker:
        session = Session(shelf, worker, first_estimate, setup.true_to_light_marker, others, options.auto)
        session.arrangement.followed = setup.tracker.marker.spec
        session.has_named_marker = not options.takes_any_marker
        session.view.shows_light = setup.shows_light
        session.view.wants_cover = options.hide_marker
        session.view.is_mirrored = options.mirror
        session.watch.preset = preset
        for line in (*setup.notes, *(shelf.take_notes() if options.headless else ())):
            print_message(line)
        yield session


def report_recordings_cut_short(out: Path | None) -> None:
    """Tells of recordings that an earlier run, which was killed, has left behind, and that were saved."""
    for folder in {Path.cwd(), *([] if out is None else [out.absolute().parent])}:
        for path in rescue_recordings(folder):
            print_message(f"a recording that was cut short is now {path}")
