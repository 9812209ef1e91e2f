"""Printed markers: what all kinds have in common, and the spec that names one on the command line."""

from pathlib import Path
from typing import Protocol

from ashe_live.core.arrays import Float, Image
from ashe_live.errors import UserError
from ashe_live.tracking.edges.print_alignment import PrintAlignment
from ashe_live.tracking.edges.quads import MIN_SIDE_PX
from ashe_live.tracking.families.dictionary_marker import (
    APRILTAG_FAMILIES,
    DICTIONARIES,
    DictionaryMarker,
    marker_count,
)
from ashe_live.tracking.families.pattern_files import read_marker_picture, read_pattern_file
from ashe_live.tracking.families.pattern_marker import PatternMarker

SPEC_FORMS = "write aruco:4x4_50:0, apriltag:36h11:0, pattern:FILE.patt or image:FILE.png"


class Marker(Protocol):
    """A black square on white that can be told from others and from itself turned."""

    @property
    def spec(self) -> str:
        """The text from which `parse_marker` makes it."""

    @property
    def alignment(self) -> PrintAlignment:
        """Decides whether a square in the picture is this print, and locates its corners by its inside."""

    def find(self, grey: Image, min_side_px: float = MIN_SIDE_PX, thorough: bool = True) -> list[Float]:
        """Corners (4, 2) in pixels of `grey` (h, w), good to a pixel or two, of every one in it, the likeliest first.

        Order: top-left, top-right, bottom-right, bottom-left of the upright print. What is smaller than `min_side_px`
        is passed over: most of the time goes into telling small things apart. `thorough` takes a few times as long and
        finds also what blur or shadows half hide.
        """

    def bitmap(self, side_px: int) -> Image:
        """(side_px, side_px) grey picture of the black square as printed. Raises ValueError when too small."""


def parse_marker(spec: str, forms: str = SPEC_FORMS) -> Marker:
    """The marker that `spec` names, as in SPEC_FORMS. Raises UserError, which says `forms`, when it names none."""
    kind, _, rest = spec.partition(":")
    match kind:
        case "aruco" | "apriltag":
            family, _, marker_id = rest.rpartition(":")
            return _dictionary_marker(spec, kind, family.lower(), marker_id)
        case "pattern" if rest:
            # Its content is a picture that someone took, cropped by eye.
            return _pattern_marker(spec, read_pattern_file(Path(rest)), is_exact=False)
        case "image" if rest:
            return _pattern_marker(spec, read_marker_picture(Path(rest)))
    raise UserError(f"there is no marker {spec!r}", forms)


def _dictionary_marker(spec: str, kind: str, family: str, marker_id: str) -> DictionaryMarker:
    families = APRILTAG_FAMILIES if kind == "apriltag" else DICTIONARIES
    if not (family and marker_id.isascii() and marker_id.isdigit()):
        raise UserError(f"the marker {spec!r} needs a dictionary and a number", SPEC_FORMS)
    if family not in families:
        raise UserError(f"{kind} knows no dictionary {family!r}", f"choose one of {', '.join(families)}")
    dictionary = families[family]
    count = marker_count(dictionary)
    if len(marker_id) > 9 or int(marker_id) >= count:  # a number may have more digits than Python converts
        raise UserError(f"{kind}:{family} has no marker {marker_id}", f"choose a number from 0 to {count - 1}")
    return DictionaryMarker(spec, dictionary, int(marker_id))


def _pattern_marker(spec: str, print_grey: Image, is_exact: bool = True) -> PatternMarker:
    try:
        return PatternMarker(spec, print_grey, is_exact)
    except ValueError as error:
        remedy = "it must be a black square, cropped to its edge, with a bright asymmetric picture inside"
        raise UserError(f"the marker {spec!r} cannot be tracked: {error}", remedy) from error
