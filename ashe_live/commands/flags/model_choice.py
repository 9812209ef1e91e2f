"""Which models stand on the followed marker, and which on markers of their own, as --model says."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from ashe_live.commands.flags.values import marker_and_model
from ashe_live.errors import UserError
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.models.loading import SUFFIXES
from ashe_live.tracking.cube.faces import CUBE
from ashe_live.tracking.families.layout import the_marker
from ashe_live.tracking.families.markers import Marker, parse_marker


def names_of(options: argparse.Namespace) -> list[str]:
    """The names of the models as they were given."""
    return [name for _, name in _given(options)]


def marker_files(options: argparse.Namespace) -> list[Path]:
    """The files that the specs of markers name: of the one to follow, and of those with models of their own."""
    specs = (getattr(options, "marker", None), *(marker for marker, _ in _given(options)))
    kinds = (spec.removeprefix(f"{CUBE}+").partition(":") for spec in specs if spec is not None)
    return [Path(file) for kind, _, file in kinds if kind in ("pattern", "image")]


def refuse_model(path: Path) -> None:
    """Raises UserError for a model where a clip or a photo is wanted."""
    if path.suffix.lower() in SUFFIXES and path.is_file():
        raise UserError(f"{path} is a model, and no clip or photo", "see it by ashe-live demo --model FILE")


def with_markers_spelled(options: argparse.Namespace) -> argparse.Namespace:
    """`options` with the whole spec of the marker that each model stands on, before another one is followed.

    If nobody has named the marker to follow, and every model has one of its own, the first of these is followed. Raises
    UserError if the followed marker has no model, if there are too many models, and if a number names no marker.
    """
    given = _given(options)
    if len(given) > MOST_MODELS:
        raise UserError(f"{len(given)} models are too many", f"give at most {MOST_MODELS}")
    specs = [None if marker is None else _spec(marker, options.marker) for marker, _ in given]
    if not any(specs):
        return options
    spelled = argparse.Namespace(**vars(options))
    if all(specs) and options.takes_any_marker:
        spelled.marker, spelled.takes_any_marker = specs[0], False
    if not any(spec in (None, spelled.marker) for spec in specs):
        raise UserError(f"no model is for {the_marker(spelled.marker)}", "give one without a number: --model NAME")
    names = [name for _, name in given]
    spelled.model = tuple(name if spec is None else f"{spec}={name}" for spec, name in zip(specs, names, strict=True))
    return spelled


def without_model(options: argparse.Namespace, in_view: Sequence[str]) -> list[str]:
    """The markers `in_view` that have no model of their own; a number is one of any family."""
    own = [marker for marker, _ in _given(options) if marker is not None]
    numbers = [int(marker) for marker in own if marker.isdecimal()]
    return [spec for spec in in_view if spec not in own and spec.rpartition(":")[2] not in map(str, numbers)]


def chosen_models(options: argparse.Namespace) -> tuple[ChosenModel, ...]:
    """The models, beginning with those on the followed marker, of which there is at least one."""
    chosen = [ChosenModel(name, None if spec == options.marker else spec) for spec, name in _given(options)]
    return tuple(sorted(chosen, key=lambda each: each.marker is not None))


def other_markers(options: argparse.Namespace) -> list[Marker]:
    """The other markers on which models stand."""
    specs = dict.fromkeys(spec for spec, _ in _given(options) if spec not in (None, options.marker))
    return [parse_marker(spec) for spec in specs if spec is not None]


def _given(options: argparse.Namespace) -> list[tuple[str | None, str]]:
    return [marker_and_model(text) for text in getattr(options, "model", ())]  # not every command shows models


def _spec(marker: str, followed: str) -> str:
    """The spec of a marker that is given by its number in the followed one's family, or by a spec. Raises UserError."""
    spec = marker
    if marker.isdecimal():
        family, _, number = followed.rpartition(":")
        if family.partition(":")[0] not in ("aruco", "apriltag") or not number.isdecimal():
            raise UserError(f"{followed} has no family of numbers: {marker}= names no marker", "write aruco:4x4_50:7=")
        spec = f"{family}:{int(marker)}"
    return parse_marker(spec).spec
