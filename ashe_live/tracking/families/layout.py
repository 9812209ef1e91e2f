"""Several markers on one rigid thing, a sheet or a cube, tracked as one: seen by any, and surer than by each alone."""

from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.square import square_corners
from ashe_live.errors import UserError
from ashe_live.tracking.cube.faces import CUBE, CUBE_SPECS, FACES, TAG_SHARE, USUAL_EDGE_M
from ashe_live.tracking.families.markers import SPEC_FORMS, Marker, parse_marker

# White between two neighbours of a grid, over the side of a square.
GRID_GAP = 0.25
# Each costs time in every frame.
MOST_MEMBERS = 24
USUAL_SIDE_M = 0.08
TARGET_FORMS = f"{SPEC_FORMS}, grid:4x4_50:3x2, or cube"


@dataclass(frozen=True, slots=True)
class Member:
    """A marker and where it lies."""

    marker: Marker
    corners: Float  # (4, 3) in the layout's units and frame: top-left, top-right, bottom-right, bottom-left


@dataclass(frozen=True, slots=True)
class Layout:
    """Markers on one rigid thing.

    On a sheet: the unit is a square's side, and the frame has its origin in their middle, x right and y up as printed.
    On the cube that stands on the table: the unit is its edge, and the plane z = 0 is the table's.
    """

    spec: str
    members: tuple[Member, ...]
    is_cube: bool = False  # printed on the faces of the folded cube; else on a sheet
    beside: Marker | None = None  # flat on the table beside the cube, wherever that is: one board with it

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height in units of a square's side."""
        corners = np.concatenate([member.corners for member in self.members])
        width, height, _ = np.ptp(corners, axis=0)
        return float(width), float(height)


def parse_target(spec: str) -> Marker | Layout:
    """The marker that `spec` names, or the layout: grid:DICT:COLSxROWS[:FIRST], numbered row by row from FIRST (0), or
    the folded cube, alone or as cube+SPEC with a flat marker beside it.

    Raises UserError when it names neither.
    """
    kind, _, rest = spec.partition(":")
    if is_of_cube(spec):
        _, plus, beside = spec.partition("+")
        return replace(cube_layout(), spec=spec, beside=_flat_beside(beside) if plus else None)
    if kind != "grid":
        return parse_marker(spec, TARGET_FORMS)
    family, _, numbers = rest.partition(":")
    size, _, first = numbers.partition(":")
    columns, _, rows = size.partition("x")
    if not (family and columns.isdecimal() and rows.isdecimal() and (first or "0").isdecimal()):
        raise UserError(f"there is no grid {spec!r}", "write grid:DICT:COLSxROWS[:FIRST], as grid:4x4_50:3x2")
    count = int(columns[:4]) * int(rows[:4])
    if not 2 <= count <= MOST_MEMBERS:
        raise UserError(f"a grid of {columns} x {rows} markers cannot be tracked", f"take from 2 to {MOST_MEMBERS}")
    start = int((first or "0")[:9])
    markers = [parse_marker(f"aruco:{family}:{start + number}") for number in range(count)]
    return grid_layout(spec, markers, int(columns))


def grid_layout(spec: str, markers: list[Marker], columns: int) -> Layout:
    """`markers` in rows of `columns`, from the top left."""
    pitch = 1 + GRID_GAP
    rows = -(-len(markers) // columns)
    members = []
    for number, marker in enumerate(markers):
        row, column = divmod(number, columns)
        centre = (column - (columns - 1) / 2) * pitch, ((rows - 1) / 2 - row) * pitch, 0.0
        members.append(Member(marker, square_corners(1.0) + centre))
    return Layout(spec, tuple(members))


def cube_layout() -> Layout:
    """The markers of the folded cube's faces; its unit is the cube's edge."""
    named = zip(CUBE_SPECS, FACES, strict=True)
    members = tuple(Member(parse_marker(spec), face.corners(TAG_SHARE)) for spec, face in named)
    return Layout(CUBE, members, is_cube=True)


def _flat_beside(spec: str) -> Marker:
    if spec in CUBE_SPECS:
        raise UserError(f"{spec} is on the cube already", "name a flat marker that is none of its faces")
    return parse_marker(spec)


def is_of_cube(spec: str) -> bool:
    """Whether `spec` names the folded cube, alone or with a flat marker beside it."""
    return spec == CUBE or spec.startswith(f"{CUBE}+")


def in_words(spec: str) -> str:
    """`spec` in a sentence, where "cube" alone would be taken for the model of that name."""
    _, _, beside = spec.partition("+")
    if not is_of_cube(spec):
        return spec
    return f"the paper cube with {beside} beside it" if beside else "the paper cube"


def the_marker(spec: str) -> str:
    """`in_words`, with its article: the paper cube has one already."""
    return in_words(spec) if is_of_cube(spec) else f"the marker {spec}"


def usual_side_m(spec: str) -> float:
    """The size in metres of what `spec` names where nobody gave one: a square's side, the cube's edge."""
    return USUAL_EDGE_M if is_of_cube(spec) else USUAL_SIDE_M


def members_of(target: Marker | Layout) -> tuple[Member, ...]:
    """The markers that `target` consists of."""
    return target.members if isinstance(target, Layout) else (Member(target, square_corners(1.0)),)
