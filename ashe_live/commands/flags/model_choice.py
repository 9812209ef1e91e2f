"""Which models stand on the followed marker, and which on markers of their own, as --model says."""

import argparse

from ashe_live.commands.flags.values import marker_and_model
from ashe_live.errors import UserError
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.tracking.families.markers import Marker, parse_marker


def names_of(options: argparse.Namespace) -> list[str]:
    """Of the models, as they were given."""
    return [name for _, name in _given(options)]


def follow_named_marker(options: argparse.Namespace) -> None:
    """A marker that carries a model is named: the first of these is followed, if nobody has said which one is.

    Raises UserError where the followed marker has no model, or a number names no marker.
    """
    markers = [marker for marker, _ in _given(options)]
    if not any(markers):
        return
    if all(markers) and options.takes_any_marker:
        first = markers[0]
        assert first is not None
        options.marker = _spec(first, options.marker)
    options.takes_any_marker = False
    chosen_models(options)


def chosen_models(options: argparse.Namespace) -> tuple[ChosenModel, ...]:
    """The first stands on the followed marker. Raises UserError where none does, for too many, and for no marker."""
    chosen = []
    for marker, name in _given(options):
        spec = None if marker is None else _spec(marker, options.marker)
        chosen.append(ChosenModel(name, None if spec == options.marker else spec))
    if len(chosen) > MOST_MODELS:
        raise UserError(f"{len(chosen)} models are too many", f"give at most {MOST_MODELS}")
    first = next((each for each in chosen if each.marker is None), None)
    if first is None:
        raise UserError(f"no model is for the marker {options.marker}", "give one without a number: --model NAME")
    chosen.remove(first)
    return first, *chosen


def other_markers(options: argparse.Namespace) -> list[Marker]:
    """Those that models of their own stand on."""
    if not hasattr(options, "model"):  # of a command that shows none
        return []
    return [parse_marker(spec) for spec in dict.fromkeys(each.marker for each in chosen_models(options)) if spec]


def _given(options: argparse.Namespace) -> list[tuple[str | None, str]]:
    return [marker_and_model(text) for text in options.model]


def _spec(marker: str, followed: str) -> str:
    """Of a marker given by its number in the followed one's family, or by its spec. Raises UserError for neither."""
    spec = marker
    if marker.isdecimal():
        family, _, number = followed.rpartition(":")
        if family.partition(":")[0] not in ("aruco", "apriltag") or not number.isdecimal():
            raise UserError(f"{followed} has no family of numbers: {marker}= names no marker", "write aruco:4x4_50:7=")
        spec = f"{family}:{int(marker)}"
    return parse_marker(spec).spec
