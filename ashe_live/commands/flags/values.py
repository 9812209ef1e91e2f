"""Parsers of the values on the command line, which refuse wrong ones in words that a user understands."""

import argparse
import re
from collections.abc import Callable
from pathlib import Path

from ashe_live.core.ranges import (
    CAMERA_NUMBER,
    COUNT,
    DRAWN,
    FIELD_OF_VIEW,
    FOCAL,
    INDEX,
    PRINTED_MM,
    PRINTED_SIDE,
    SIDE,
    VIEWS,
    Range,
)

LENGTH = re.compile(r"(?P<number>\d*[.,]?\d+) ?(?P<unit>mm|cm|m|)", re.IGNORECASE | re.ASCII)
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


def _length_in(allowed: Range) -> Callable[[str], float]:
    """As `_number_in`; says what to write for a length with its unit, or as in the unit that it is usually taken in."""
    number = _number_in(allowed)

    def length(text: str) -> float:
        try:
            return number(text)
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentTypeError(f"{error}{_as_meant(text, allowed)}") from None

    return length


def _as_meant(text: str, allowed: Range) -> str:
    """What to write in the unit of `allowed` for a length in another one; empty where that is no length either."""
    if (read := LENGTH.fullmatch(text)) is None:
        return ""
    plain = read["number"].replace(",", ".")
    other = "mm" if allowed.unit == "m" else "m"
    for unit in [read["unit"].lower()] if read["unit"] else [allowed.unit, other]:
        meant = float(plain) * METRES[unit] / METRES[allowed.unit]
        if meant in allowed:
            return f": for {plain} {unit} write {meant:g}"
    return ""


def _number_in(allowed: Range) -> Callable[[str], float]:
    def number(text: str) -> float:
        try:
            return allowed.checked(float(text), "it")
        except ValueError:
            # Argparse's own message would name this function.
            raise argparse.ArgumentTypeError(f"{text!r} is not a number {allowed}") from None

    return number


def _whole_number_in(allowed: Range) -> Callable[[str], int]:
    def number(text: str) -> int:
        try:
            return int(allowed.checked(int(text), "it"))
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number {allowed}") from None

    return number


side_m, millimetres = _length_in(PRINTED_SIDE), _length_in(PRINTED_MM)
focal_px, angle_deg = _number_in(FOCAL), _number_in(FIELD_OF_VIEW)
count, index, views = (_whole_number_in(allowed) for allowed in (COUNT, INDEX, VIEWS))


def path(text: str) -> Path:
    """The path of a file or folder."""
    _check_not_empty(text, "file")
    return Path(text)


def _check_not_empty(text: str, what: str) -> None:
    if not text:  # from an unset shell variable, for example; pathlib would take it for the current folder
        raise argparse.ArgumentTypeError(f"it is empty and names no {what}")


MARKER_KINDS = ("aruco", "apriltag", "pattern", "image")


def model(text: str) -> str:
    """[MARKER=]MODEL."""
    _check_not_empty(text, "model")
    marker, name = marker_and_model(text)
    if not name:
        raise argparse.ArgumentTypeError(f"{text!r} names no model: write {marker}=NAME or {marker}=FILE")
    return text


def marker_and_model(text: str) -> tuple[str | None, str]:
    """The marker that a model is to stand on, a number or a spec, if one is named, and the model's name or file."""
    marker, equals, name = text.partition("=")
    is_marker = marker.isdecimal() or marker.partition(":")[0] in MARKER_KINDS
    return (marker, name) if equals and is_marker else (None, text)


def size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT."""
    width, _, height = text.lower().partition("x")
    if not all(side.isascii() and side.isdecimal() and len(side) < 9 and int(side) in SIDE for side in (width, height)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size like 1280x720, with sides {SIDE}")
    if int(width) * int(height) not in DRAWN:
        raise argparse.ArgumentTypeError(f"{text!r} has more pixels than can be drawn: give at most 4096x4096")
    return int(width), int(height)


def frame_range(text: str) -> tuple[int, int | None]:
    """FIRST:LAST, both included; either may be missing."""
    first, colon, last = text.partition(":")
    try:
        bounds = index(first or "0"), index(last) if last else None
    except argparse.ArgumentTypeError:
        bounds = 1, 0
    if not colon or (bounds[1] is not None and bounds[0] > bounds[1]):
        raise argparse.ArgumentTypeError(f"{text!r} is not a range of frames like 30:90, 30: or :90")
    return bounds


def camera(text: str) -> str:
    """A number, or what may be a path."""
    _check_not_empty(text, "camera")
    if text.isdecimal() and not (len(text) < 9 and int(text) in CAMERA_NUMBER):
        raise argparse.ArgumentTypeError(f"{text!r} is not a camera's number {CAMERA_NUMBER}")
    return text
