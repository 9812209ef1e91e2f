"""The shadows that a known body casts on the cells of its table's map, each stored within a window of it."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, fixed_point
from ashe_live.core.proxy import Proxy
from ashe_live.light.known_body.table import FINER, SIDE, cell_m
from ashe_live.light.shape.light_points import LOWEST_Z

BITS = 6  # a shadow is painted with fractions of the finer cells
FARTHEST_CELLS = 1e3  # of a shadow's corner: beyond, it is painted as if it were there
FIXED = FINER * 2**BITS  # units of a painted corner to a cell

Integers = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """k shadows that lie within one window of the map."""

    rows: slice
    columns: slice
    numbers: Integers  # (k,) among all shadows, ascending
    shares: Float32  # (k, cells of the window) part of each cell that is in shadow
    squares: Float32  # (k, cells of the window) of these parts


@dataclass(frozen=True, slots=True, eq=False)
class Shadows:
    """The shadows of a body in m lights, none where they are infinite."""

    count: int  # m
    blocks: tuple[Block, ...]

    def sums(self, values: Float32) -> Float:
        """(m, c) sums over each shadow of values (n, n, c) of the map's cells."""
        total = np.zeros((self.count, values.shape[2]))
        for block in self.blocks:
            total[block.numbers] = block.shares @ values[block.rows, block.columns].reshape(-1, values.shape[2])
        return total

    def squares(self, values: Float32) -> Float:
        """(m,) sums over each shadow of values (n, n) of the map's cells, times their squared parts in shadow."""
        total = np.zeros(self.count)
        for block in self.blocks:
            total[block.numbers] = block.squares @ values[block.rows, block.columns].reshape(-1)
        return total

    def whole(self) -> Float32:
        """(m, n, n) part of each cell of the map that is in shadow."""
        whole = np.zeros((self.count, SIDE, SIDE), np.float32)
        for block in self.blocks:
            window = whole[:, block.rows, block.columns]
            window[block.numbers] = block.shares.reshape(-1, *window.shape[1:])
        return whole

    def one(self, number: int) -> Float32:
        """(n, n) part of each cell of the map that is in the shadow of light `number`."""
        shadow = np.zeros((SIDE, SIDE), np.float32)
        for block in self.blocks:
            at = int(block.numbers.searchsorted(number))
            if at < len(block.numbers) and block.numbers[at] == number:
                window = shadow[block.rows, block.columns]
                window[:] = block.shares[at].reshape(window.shape)
        return shadow

    def joined(self, others: "Shadows") -> "Shadows":
        """These and the others after them, without a copy of either."""
        shifted = (replace(each, numbers=each.numbers + self.count) for each in others.blocks)
        return Shadows(self.count + others.count, (*self.blocks, *shifted))


def shadows_of(body: Proxy, lights: Float, groups: Integers | None = None) -> Shadows:
    """The body's shadows in lights (m, 4); those of one of the `groups` (m,) share a window of the map."""
    corners, is_finite = corners_of(body, lights)
    members = [is_finite] if groups is None else [is_finite & (groups == group) for group in np.unique(groups)]
    blocks = []
    for is_member in members:
        numbers = np.flatnonzero(is_member)
        if not len(numbers):
            continue
        rows, columns = (_window(corners[numbers, :, axis]) for axis in (1, 0))
        shares = _painted(corners[numbers], rows, columns)
        blocks.append(Block(rows, columns, numbers, shares, shares * shares))
    return Shadows(len(lights), tuple(blocks))


def _painted(corners: NDArray[np.int32], rows: slice, columns: slice) -> Float32:
    """(k, cells of the window) part of each cell in the hulls of corners (k, m, 2)."""
    height, width = rows.stop - rows.start, columns.stop - columns.start
    corners = corners - np.array((columns.start, rows.start), np.int32) * FIXED
    fine = np.zeros((len(corners), FINER * height, FINER * width), np.float32)
    for canvas, outline in zip(fine, corners, strict=True):
        cv2.fillConvexPoly(canvas, cv2.convexHull(outline), 1, shift=BITS)
    fine = fine.reshape(-1, FINER * width)
    painted = cv2.resize(fine, (width, len(corners) * height), interpolation=cv2.INTER_AREA)
    return np.asarray(painted, dtype=np.float32).reshape(len(corners), -1)


def _window(corners: NDArray[np.int32]) -> slice:
    """The cells along one axis that hold all corners, as far as they lie in the map, and the rim of their pixels."""
    first = int(corners.min()) // FIXED - 1
    last = int(corners.max()) // FIXED + 2
    return slice(min(max(first, 0), SIDE - 1), max(min(last + 1, SIDE), 1))


def corners_of(body: Proxy, lights: Float) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """(m, k, 2) the body's points cast by each light, in units of 1 / FIXED of a cell, and (m,) where it is finite."""
    cells, is_finite = cells_of(body, lights)
    return fixed_point((cells + 0.5) * FINER - 0.5, BITS), is_finite


def cells_of(body: Proxy, lights: Float) -> tuple[Float, NDArray[np.bool_]]:
    """(m, k, 2) columns and rows in the map of the body's points cast by each light, and (m,) where all are finite.

    Cells' centres are integers.
    """
    points = body.points_marker(12)
    is_above = lights[:, 2] > LOWEST_Z * np.linalg.norm(lights[:, :3], axis=1)
    by_height = lights[:, [0, 1, 3]] / np.where(is_above, lights[:, 2], 1.0)[:, None]
    left = 1 - by_height[:, 2:] * points[:, 2]
    is_finite = is_above & (left > 0).all(axis=1)
    cast = points[:, :2] - by_height[:, None, :2] * points[:, 2:]
    cast = cast / np.where(is_finite[:, None], left, 1.0)[..., None] - body.foot_marker[:2]
    cells = (cast / cell_m(body)).clip(-FARTHEST_CELLS, FARTHEST_CELLS)
    return cells + SIDE // 2, is_finite
