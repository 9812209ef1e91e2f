"""STL: three corners a triangle, in binary or as text.

Two programs' ways to colour binary files are in use, in the two bytes that the format leaves to each triangle:
VisCAM's, and that of Materialise Magics, whose header has the colour of all that have none of their own
(https://en.wikipedia.org/wiki/STL_(file_format)#Color_in_binary_STL).
"""

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.assembly.geometry import RawMesh
from ashe_live.models.formats.words import numbers_in
from ashe_live.models.material import UNKNOWN
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.limits import STL_HEADER_BYTES, STL_TRIANGLE_BYTES, is_text_stl
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import Notes

TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VERTEX = re.compile(rb"\bvertex\s", re.IGNORECASE)
LOOP_END = re.compile(rb"\bendloop\b", re.IGNORECASE)
# Lines that hold any words; a facet may follow on the same line.
NAMES = re.compile(rb"^[ \t]*+(?:end)?solid\b(?:(?!\bfacet\s+normal\b)[^\n])*+", re.IGNORECASE | re.MULTILINE)
MAGICS = b"COLOR="  # red, green, blue and alpha follow, a byte each


def read_stl(content: bytes, _folder: Folder, _notes: Notes) -> Iterator[RawMesh]:
    """One mesh of all solids. Raises MalformedError for what is neither text STL nor binary STL."""
    if is_text_stl(content):
        corners, colours = _of_text(content), None
    else:
        facets = _of_binary(content)
        corners, colours = facets["corners"], _colours(content[: STL_HEADER_BYTES - 4], facets["attribute"])
    places = corners.reshape(-1, 3)
    each = None if colours is None else np.repeat(colours, 3, axis=0)
    yield RawMesh(places, np.arange(len(places)).reshape(-1, 3), UNKNOWN, colours=each)


def _of_binary(content: bytes) -> np.ndarray:
    if len(content) < STL_HEADER_BYTES:
        raise MalformedError("it is neither text STL nor binary STL")
    count = int.from_bytes(content[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    there = (len(content) - STL_HEADER_BYTES) // STL_TRIANGLE_BYTES
    if count > there:
        raise MalformedError(f"its header says {count:,} triangles, and there are {there:,}")
    return np.frombuffer(content, TRIANGLE, count, STL_HEADER_BYTES)


def _colours(header: bytes, attributes: NDArray[np.uint16]) -> Float | None:
    """(n, 4) linear of the triangles; None where the file has none."""
    is_marked = attributes >> 15 == 1
    at = header.find(MAGICS)
    if at < 0 and (not is_marked.any() or attributes[~is_marked].any()):
        return None  # bits that mean something else, or nothing
    fives = np.stack([attributes >> shift & 31 for shift in (0, 5, 10)], axis=1) / 31
    if at >= 0:
        own = header[at + len(MAGICS) :][:4].ljust(4, b"\xff")
        whole = np.frombuffer(own, np.uint8) / 255
        encoded = np.where(is_marked[:, None], whole[:3], fives)
    else:
        encoded = np.where(is_marked[:, None], fives[:, ::-1], 1.0)
    return np.column_stack([linear_from_srgb(encoded), np.ones(len(encoded))])


def _of_text(content: bytes) -> np.ndarray:
    """The corners, which stand between the word vertex and the end of the line or of the loop."""
    content = LOOP_END.sub(b"\n", NAMES.sub(b"", content.replace(b"\r", b"\n")))
    lines = [piece.split(b"\n", 1)[0] for piece in VERTEX.split(content)[1:]]
    numbers = numbers_in(b" ".join(lines))
    if numbers.size != 3 * len(lines) or len(lines) % 3:
        raise MalformedError(f"{len(lines)} vertices of {numbers.size} numbers are no triangles")
    return numbers.reshape(-1, 3, 3)
