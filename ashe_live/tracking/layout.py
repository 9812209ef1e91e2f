"""Several markers printed on one rigid sheet, tracked as one: seen by any of them, and surer than by each alone."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.tracking.markers import Marker

# White between two neighbours of a grid, over the side of a square.
GRID_GAP = 0.25


@dataclass(frozen=True, slots=True)
class Member:
    """A marker and where it lies."""

    marker: Marker
    corners: Float  # (4, 3) in units of a square's side, the layout's frame: top-left, top-right, bottom-right, ...


@dataclass(frozen=True, slots=True)
class Layout:
    """Markers in one plane; its frame has its origin in their middle, x right and y up as printed."""

    spec: str
    members: tuple[Member, ...]


def unit_square(centre: tuple[float, float] = (0.0, 0.0)) -> Float:
    """(4, 3) corners of a square with side 1: top-left, top-right, bottom-right, bottom-left as printed."""
    x, y = centre
    return np.array([(x - 0.5, y + 0.5, 0), (x + 0.5, y + 0.5, 0), (x + 0.5, y - 0.5, 0), (x - 0.5, y - 0.5, 0)])


def grid_layout(spec: str, markers: list[Marker], columns: int) -> Layout:
    """`markers` in rows of `columns`, from the top left."""
    pitch = 1 + GRID_GAP
    rows = -(-len(markers) // columns)
    members = []
    for number, marker in enumerate(markers):
        row, column = divmod(number, columns)
        centre = (column - (columns - 1) / 2) * pitch, ((rows - 1) / 2 - row) * pitch
        members.append(Member(marker, unit_square(centre)))
    return Layout(spec, tuple(members))


def members_of(target: Marker | Layout) -> tuple[Member, ...]:
    """The markers that `target` consists of."""
    return target.members if isinstance(target, Layout) else (Member(target, unit_square()),)
