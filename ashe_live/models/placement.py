"""Where a model stands: over the marker's centre, on the ground, as large as the marker allows; then as it is moved."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, box_corners, directions_on_spiral, frozen_floats, set_frozen
from ashe_live.core.ranges import SCALE, SHIFT, TURN
from ashe_live.models.mesh import Float32, Model

FOOTPRINT_SIDES = 1.0  # largest horizontal extent, in sides of the marker
HEIGHT_SIDES = 1.2  # largest vertical extent, in sides of the marker
# Distance between the middles of neighbouring models, in sides of the marker: half of each (at most a side wide) and a
# gap.
BESIDE_SIDES = 1.25

# A larger cloud of points is replaced by its extreme points in this many directions, widened by the loss of a sphere.
MAX_OUTLINE_POINTS = 1000
WIDENED = 1.005
POINTS_AT_ONCE = 16384
CELLS = 12  # along each side of the grid that points are looked at in
ROUNDING = 1e-5  # of single precision, in sums of three products


@dataclass(frozen=True, slots=True, weakref_slot=True, eq=False)
class PlacedModel:
    """A model in the marker frame; compared by identity, so keep it as long as the model and the marker stay."""

    model: Model  # vertices in metres, marker frame, lowest at z = 0
    bounds: Float  # (2, 3) smallest and largest coordinates, metres, marker frame
    outline: Float = field(init=False)  # (n, 3) metres, marker frame; its convex hull encloses the model

    def __post_init__(self) -> None:
        set_frozen(self, outline=frozen_floats(_outline(self.model), (-1, 3), "outline"))


@dataclass(frozen=True, slots=True)
class Placement:
    """How a placed model was moved since: scaled and turned about the marker's centre, then shifted on its plane.

    scale: over the size at which the marker's side has it stand first.
    turn_rad: counter-clockwise, seen from above.
    shift_m: x, y; metres, marker frame.

    Raises ValueError for a scale that is not positive and for what is not finite, TypeError for what is no number.
    """

    scale: float = 1.0
    turn_rad: float = 0.0
    shift_m: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.shift_m, tuple) or len(self.shift_m) != 2:
            raise TypeError(f"shift_m must be (x, y), and is {self.shift_m!r:.40}")
        set_frozen(
            self,
            scale=SCALE.checked(self.scale, "scale"),
            turn_rad=TURN.checked(self.turn_rad, "turn_rad"),
            shift_m=tuple(SHIFT.checked(shift, "shift_m") for shift in self.shift_m),
        )

    def __matmul__(self, first: "Placement") -> "Placement":
        """`first`, then this one: the product of their matrices."""
        if self == UNMOVED:
            return first
        x, y = self.turned(first.shift_m)
        shift_m = (self.scale * x + self.shift_m[0], self.scale * y + self.shift_m[1])
        return Placement(self.scale * first.scale, (self.turn_rad + first.turn_rad) % math.tau, shift_m)

    def turned(self, vector: tuple[float, float], back: bool = False) -> tuple[float, float]:
        """A vector x, y of the plane, turned as the model is, or `back`."""
        cosine, sine = math.cos(self.turn_rad), math.sin(self.turn_rad) * (-1 if back else 1)
        x, y = vector
        return cosine * x - sine * y, sine * x + cosine * y

    @property
    def marker_from_placed(self) -> Float:
        """(4, 4) similarity that keeps the plane z = 0."""
        along, across = self.scale * math.cos(self.turn_rad), self.scale * math.sin(self.turn_rad)
        (x, y), up = self.shift_m, self.scale
        return np.array([(along, -across, 0, x), (across, along, 0, y), (0, 0, up, 0), (0, 0, 0, 1)])


UNMOVED = Placement()


def seat_beside(number: int, side_m: float) -> Placement:
    """Where one of several models stands on a marker of that side: in the middle, to the right, to the left, ..."""
    steps = (number + 1) // 2 * (1 if number % 2 else -1)
    return Placement(shift_m=(BESIDE_SIDES * steps * side_m, 0.0))


def placed_on_marker(model: Model, side_m: float) -> PlacedModel:
    """`model` scaled to a marker of `side_m`, centred over it and set on the plane z = 0."""
    if not side_m > 0:
        raise ValueError(f"a marker's side of {side_m} m is not positive")
    lower, upper = model.bounds
    width, depth, height = upper - lower
    scale = side_m / max(width / FOOTPRINT_SIDES, depth / FOOTPRINT_SIDES, height / HEIGHT_SIDES)
    offset = -scale * np.array([(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]])
    moved = replace(model, parts=tuple(part.moved(scale, offset) for part in model.parts))
    return PlacedModel(moved, moved.bounds)


def _outline(model: Model) -> Float:
    """(n, 3) metres, marker frame: points whose convex hull encloses the model in all of its poses."""
    if model.duration_s:
        return box_corners(model.bounds)
    points = np.concatenate([part.vertices for part in model.parts])
    if len(points) <= MAX_OUTLINE_POINTS:
        return points.astype(np.float64)
    # Across the extents, so that a flat model is looked at as closely as a ball.
    extents = np.ptp(points, axis=0).astype(np.float64)
    extents = np.maximum(extents, max(1e-6 * extents.max(), 1e-30))
    directions = (directions_on_spiral(MAX_OUTLINE_POINTS) / extents).astype(np.float32)
    reach = np.full(len(directions), -np.inf, np.float32)
    extreme = np.zeros(len(directions), np.int64)
    order, bounds = _in_cells(points, extents)
    lower, upper = (extremes.reduceat(points[order], bounds[:-1]) for extremes in (np.minimum, np.maximum))
    forwards, backwards = directions.clip(min=0), directions.clip(max=0)
    # Only cells whose box reaches as far as the whole of another cell's can hold what is extreme.
    reached = (forwards @ lower.T + backwards @ upper.T).max(axis=1)
    may_hold = forwards @ upper.T + backwards @ lower.T >= reached[:, None] - ROUNDING * np.abs(reached)[:, None]
    for cell, asked in enumerate(may_hold.T):
        inside, ways = order[bounds[cell] : bounds[cell + 1]], np.flatnonzero(asked)
        for first in range(0, len(inside), POINTS_AT_ONCE):
            some = inside[first : first + POINTS_AT_ONCE]
            along = directions[ways] @ points[some].T
            best = along.argmax(axis=1)
            farthest = along[np.arange(len(ways)), best]
            farther = farthest > reach[ways]
            reach[ways[farther]] = farthest[farther]
            extreme[ways[farther]] = some[best[farther]]
    found = points[np.unique(extreme)].astype(np.float64)
    centre = (found.min(axis=0) + found.max(axis=0)) / 2
    return np.asarray(centre + WIDENED * (found - centre))


def _in_cells(points: Float32, extents: Float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Points (n, 3) by their cells of a grid: their order (n,), and where in it each cell begins, with the end."""
    places = (points - points.min(axis=0)) * (CELLS / extents)
    cells = np.clip(places, 0, CELLS - 1).astype(np.int64) @ np.array((CELLS**2, CELLS, 1))
    order = np.argsort(cells, kind="stable")
    begins = np.flatnonzero(np.diff(cells[order], prepend=-1))
    return order, np.append(begins, len(points))
