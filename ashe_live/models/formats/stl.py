"""STL: three corners a triangle, in binary or as text."""

import re
from collections.abc import Iterator

import numpy as np

from ashe_live.models.assembly.geometry import RawMesh
from ashe_live.models.formats.words import numbers_in
from ashe_live.models.material import UNKNOWN
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import Notes

HEADER_BYTES, TRIANGLE_BYTES = 84, 50
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VERTEX = re.compile(rb"\bvertex\s", re.IGNORECASE)
FIRST_BYTES = 1000


def read_stl(content: bytes, _folder: Folder, _notes: Notes) -> Iterator[RawMesh]:
    """One mesh of all solids. Raises MalformedError for what is neither text STL nor binary STL."""
    corners = _of_text(content) if is_text(content) else _of_binary(content)
    places = corners.reshape(-1, 3)
    yield RawMesh(places, np.arange(len(places)).reshape(-1, 3), UNKNOWN)


def is_text(content: bytes) -> bool:
    """Binary files may begin with "solid" as well; only text goes on with its first facet."""
    return content.lstrip()[:5].lower() == b"solid" and b"facet" in content[:FIRST_BYTES].lower()


def _of_binary(content: bytes) -> np.ndarray:
    if len(content) < HEADER_BYTES:
        raise MalformedError("it is neither text STL nor binary STL")
    count = int.from_bytes(content[HEADER_BYTES - 4 : HEADER_BYTES], "little")
    there = (len(content) - HEADER_BYTES) // TRIANGLE_BYTES
    if count > there:
        raise MalformedError(f"its header says {count:,} triangles, and there are {there:,}")
    return np.frombuffer(content, TRIANGLE, count, HEADER_BYTES)["corners"]


def _of_text(content: bytes) -> np.ndarray:
    """What stands between the word vertex and the next line's end."""
    lines = [piece.split(b"\n", 1)[0] for piece in VERTEX.split(content)[1:]]
    numbers = numbers_in(b" ".join(lines))
    if numbers.size != 3 * len(lines) or len(lines) % 3:
        raise MalformedError(f"{len(lines)} vertices of {numbers.size} numbers are no triangles")
    return numbers.reshape(-1, 3, 3)
