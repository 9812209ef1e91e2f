"""The surface of voxels as a closed mesh, by surface nets (Gibson, "Constrained elastic surface nets", 1998)."""

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask

POOLED = 2  # voxels along each side of a cell: half as fine a grid has a quarter of the triangles
LEVEL = 0.5  # share of a cell's voxels at its surface


def surface_of(occupied: Mask, low: Float, voxel_m: float) -> tuple[Float, NDArray[np.uint32]]:
    """(n, 3) points and (m, 3) triangles, counter-clockwise from outside, around the occupied voxels (x, y, z).

    low: (3,) corner of the grid. Each cell of the dual grid that the surface crosses has one point, the mean of where
    it crosses the cell's edges. No points where nothing is occupied.
    """
    share = np.pad(_pooled(occupied), 1)
    inside = share > LEVEL
    index, points = _points(share, inside)
    quads = np.concatenate([_quads(index, inside, axis) for axis in range(3)])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint32)
    # The centre of a cell with index i, the padding's first, lies at i - 1/2 cells from the corner.
    return low + (points - 0.5) * voxel_m * POOLED, triangles


def _pooled(occupied: Mask) -> Float:
    """The share of occupied voxels in cells of POOLED voxels along each side."""
    padded = np.pad(occupied, [(0, -side % POOLED) for side in occupied.shape]).astype(np.float64)
    x, y, z = (side // POOLED for side in padded.shape)
    return np.asarray(padded.reshape(x, POOLED, y, POOLED, z, POOLED).mean(axis=(1, 3, 5)))


def _points(share: Float, inside: Mask) -> tuple[NDArray[np.intp], Float]:
    """The index of each dual cell's point, -1 for none, and the points (n, 3) in cells of `share`."""
    dual = tuple(side - 1 for side in share.shape)
    total, count = np.zeros((*dual, 3)), np.zeros(dual)
    for axis in range(3):
        one, other = _shifted(share, axis, 0), _shifted(share, axis, 1)
        crosses = _shifted(inside, axis, 0) != _shifted(inside, axis, 1)
        along = np.where(crosses, (LEVEL - one) / np.where(crosses, other - one, 1.0), 0.0)
        across = [each for each in range(3) if each != axis]
        for corner in product((0, 1), repeat=2):
            window: list[slice] = [slice(None)] * 3
            for each, step in zip(across, corner, strict=True):
                window[each] = slice(step, step + dual[each])
            hit, at = crosses[tuple(window)], along[tuple(window)]
            offset = np.zeros((*dual, 3))
            offset[..., axis] = at
            for each, step in zip(across, corner, strict=True):
                offset[..., each] = step
            total += offset * hit[..., None]
            count += hit
    crossed = count > 0
    index = np.full(dual, -1, np.intp)
    index[crossed] = np.arange(np.count_nonzero(crossed))
    return index, np.argwhere(crossed) + total[crossed] / count[crossed][:, None]


def _quads(index: NDArray[np.intp], inside: Mask, axis: int) -> NDArray[np.intp]:
    """(m, 4) the points around each edge along `axis` that the surface crosses."""
    starts, ends = _shifted(inside, axis, 0), _shifted(inside, axis, 1)
    edges = np.argwhere(starts != ends)
    leaves = starts[tuple(edges.T)]
    one, other = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for back_one, back_other in ((1, 1), (0, 1), (0, 0), (1, 0)):
        cell = edges.copy()
        cell[:, one] -= back_one
        cell[:, other] -= back_other
        corners.append(index[tuple(cell.T)])
    quads = np.stack(corners, axis=1)
    return np.where(leaves[:, None], quads, quads[:, ::-1])


def _shifted(grid: NDArray[Any], axis: int, by: int) -> NDArray[Any]:
    """The grid without its last, or for `by` = 1 its first, layer along the axis."""
    window: list[slice] = [slice(None)] * 3
    window[axis] = slice(by, grid.shape[axis] - 1 + by)
    return grid[tuple(window)]
