"""Polygons in space as triangles: fans where they are convex, else earcut's, or along a quad's other diagonal."""

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, cross_2d

Indices = NDArray[np.int64]
OTHER_DIAGONAL = np.array([(0, 1, 3), (1, 2, 3)])
CROSSES_ITSELF = 1e-6  # share of its area by which the ears of a polygon that does so may be off, as others are not


def triangulated(places: Float, corners: Indices, counts: Indices) -> Indices:
    """(m, 3) indices into `corners` (k,), which name `places` (n, 3), polygon after polygon of `counts` corners each.

    What has fewer than three corners is left out. Triangles run as their polygon does.
    """
    begins = np.cumsum(counts) - counts
    found, order = [], []
    for count in np.unique(counts[counts >= 3]):
        polygons = np.flatnonzero(counts == count)
        rows = begins[polygons, None] + np.arange(count)
        hubs = np.broadcast_to(rows[:, :1], (len(rows), count - 2))
        fans = np.stack([hubs, rows[:, 1:-1], rows[:, 2:]], axis=2)
        if count == 4:
            is_folded = _fold(places[corners[rows]])
            fans[is_folded] = rows[is_folded][:, OTHER_DIAGONAL]
        elif count > 4:
            for number in np.flatnonzero(~_are_convex(places[corners[rows]])):
                cut = _ears(places[corners[rows[number]]])
                if cut is not None:
                    fans[number] = rows[number][cut]
        found.append(fans.reshape(-1, 3))
        order.append(np.repeat(polygons, count - 2))
    if not found:
        return np.empty((0, 3), np.int64)
    # In the file's order, as triangles at the same place may follow one another on purpose.
    return np.concatenate(found)[np.argsort(np.concatenate(order), kind="stable")]


def _fold(quads: Float) -> NDArray[np.bool_]:
    """(p,) whether both other corners of a quad (p, 4, 3) lie on one side of the diagonal from its first to its third.

    Then the other diagonal is within it; of one that crosses itself it is the one that Blender takes as well.
    """
    a, diagonal, b = np.moveaxis(quads[:, 1:] - quads[:, :1], 1, 0)
    return np.asarray((np.cross(a, diagonal) * np.cross(b, diagonal)).sum(axis=1) > 0)


def _are_convex(polygons: Float) -> NDArray[np.bool_]:
    """(p,) whether every corner of a polygon (p, k, 3) turns the way that the whole of it does."""
    edges = np.roll(polygons, -1, axis=1) - polygons
    turns = np.cross(edges, np.roll(edges, -1, axis=1))
    along = np.einsum("pki,pi->pk", turns, _area_vectors(polygons))
    return np.asarray((along >= -1e-9 * np.abs(along).max(axis=1, keepdims=True)).all(axis=1))


def _area_vectors(polygons: Float) -> Float:
    """(p, 3) by Newell's method."""
    centred = polygons - polygons[:, :1]
    return np.asarray(np.cross(centred, np.roll(centred, -1, axis=1)).sum(axis=1))


def _ears(polygon: Float) -> Indices | None:
    """(k - 2, 3) corners of a polygon (k, 3), seen along its normal; None where it crosses itself or is nowhere."""
    (normal,) = _area_vectors(polygon[None])
    if not np.isfinite(normal).all():  # nor zero, as what has no area counts as convex
        return None
    dropped = int(np.abs(normal).argmax())
    flat = np.ascontiguousarray(np.delete(polygon - polygon[0], dropped, axis=1))
    if (normal[dropped] < 0) != (dropped == 1):
        flat = np.ascontiguousarray(flat[:, ::-1])  # counter-clockwise as the polygon runs
    cut = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32)).reshape(-1, 3).astype(np.int64)
    a, b, c = np.moveaxis(flat[cut], 1, 0)
    areas = cross_2d(b - a, c - a)
    whole = abs(float(normal[dropped]))
    if abs(float(np.abs(areas).sum()) - whole) > CROSSES_ITSELF * whole:
        return None
    # Of a corner that stands twice, or at the end of a spike, earcut makes no triangle; here it has one without area.
    return np.pad(cut, ((0, len(polygon) - 2 - len(cut)), (0, 0)))
