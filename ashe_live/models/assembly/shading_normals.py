"""Normals for meshes that bring none: smooth where the surface is, sharp where it has an edge."""

import math

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Float32, Indices, face_normals

CREASE_RAD = math.radians(40)
MAX_CROWD = 32
WAYS = 32  # steps of each coordinate of a unit vector, 4 to 6 degrees
CLOSED_WITHIN = 1e-4  # of the area


def vertex_normals(vertices: Float32, triangles: Indices) -> Float:
    """(n, 3) sums of the triangles that share each vertex, by area."""
    return _sums_by(triangles.ravel(), np.repeat(face_normals(vertices, triangles), 3, axis=0), len(vertices))


def completed_normals(normals: Float32, vertices: Float32, triangles: Indices) -> Float32:
    """(n, 3) the unit normals, and in place of those that are 0 the mean, by area, of the triangles at the vertex."""
    is_known = has_direction(normals)
    if is_known.all():
        return normals
    return np.where(is_known[:, None], normals, unit_rows(vertex_normals(vertices, triangles))).astype(np.float32)


def has_direction(vectors: Float | Float32) -> NDArray[np.bool_]:
    """(...) whether vectors (..., 3) can be made unit vectors: no zeros, and nothing that is not finite."""
    lengths = np.linalg.norm(vectors, axis=-1)
    return np.asarray(np.isfinite(lengths) & (lengths > 0))


def unit_rows(vectors: Float) -> Float:
    """(n, 3) at length 1; z where there is no direction, so that a degenerate triangle stays finite."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0, vectors / np.where(lengths > 0, lengths, 1.0), (0.0, 0.0, 1.0))


def flat_normals(vertices: Float32, triangles: Indices) -> Float32:
    """(3 m, 3) unit normals of the triangles' corners, in the order of `triangles.ravel()`: those of their planes."""
    return unit_rows(face_normals(vertices, triangles)).astype(np.float32).repeat(3, axis=0)


def corner_normals(vertices: Float32, triangles: Indices) -> Float32:
    """(3 m, 3) unit normals, one for each triangle's corner in the order of `triangles.ravel()`.

    A corner averages, by area, the triangles at the same place whose planes differ by less than CREASE_RAD. Where more
    than MAX_CROWD triangles meet, as at the tip of a cone, those that face the same way count as one.
    """
    faces = face_normals(vertices, triangles)
    face = np.arange(triangles.size) // 3
    _, place = np.unique(row_keys(vertices), return_inverse=True)
    place = place[triangles.ravel()]
    together, is_smooth = _totals(place, faces[face])
    if is_smooth.all():
        return unit_rows(together).astype(np.float32)[place]
    normals = np.empty((triangles.size, 3), np.float32)
    smooth = is_smooth[place]
    normals[smooth] = unit_rows(together).astype(np.float32)[place[smooth]]
    creased = np.flatnonzero(~smooth)
    normals[creased] = _creased(place[creased], faces[face[creased]])
    return normals


def _totals(place: NDArray[np.int64], areas: Float) -> tuple[Float, NDArray[np.bool_]]:
    """(places, 3) sums of the area vectors (n, 3) at each, and (places,) whether all that meet there are smooth.

    What is within half of CREASE_RAD of the sum is within all of it of one another.
    """
    totals = _sums_by(place, areas)
    along = np.einsum("ij,ij->i", unit_rows(areas), unit_rows(totals)[place])
    is_smooth = np.ones(len(totals), np.bool_)
    is_smooth[place[along <= math.cos(CREASE_RAD / 2)]] = False
    return totals, is_smooth


def _creased(place: NDArray[np.int64], areas: Float) -> Float32:
    """(n, 3) unit normals of corners where an edge may be, from the area vectors (n, 3) of their triangles."""
    _, place, crowds = np.unique(place, return_inverse=True, return_counts=True)
    crowded = np.flatnonzero((crowds > MAX_CROWD)[place])
    if len(crowded) == 0:
        return unit_rows(_sums_of_alike(place, areas)).astype(np.float32)
    normals = np.empty((len(place), 3))
    others = np.flatnonzero((crowds <= MAX_CROWD)[place])
    normals[others] = _sums_of_alike(place[others], areas[others])
    areas = areas[crowded]
    keys = place[crowded] * WAYS**3 + _facing(areas)
    _, one_of, way = np.unique(keys, return_index=True, return_inverse=True)
    normals[crowded] = _sums_of_alike(place[crowded][one_of], _sums_by(way, areas))[way]
    return unit_rows(normals).astype(np.float32)


def _sums_of_alike(place: NDArray[np.int64], areas: Float) -> Float:
    """(n, 3) for each area vector (n, 3) the sum of those at the same place that are within CREASE_RAD of it."""
    order = np.argsort(place, kind="stable")
    place, areas = place[order], areas[order]
    units, total = unit_rows(areas), areas.copy()
    bounds = np.append(np.flatnonzero(np.diff(place, prepend=-1)), len(place))
    lasts = np.repeat(bounds[1:] - 1, np.diff(bounds))
    first, step = np.arange(len(place)), 1
    while True:
        first = first[first + step <= lasts[first]]
        if len(first) == 0:
            break
        alike = first[np.einsum("ij,ij->i", units[first], units[first + step]) > math.cos(CREASE_RAD)]
        total[alike] += areas[alike + step]
        total[alike + step] += areas[alike]
        step += 1
    sums = np.empty_like(total)
    sums[order] = total
    return sums


def _sums_by(numbers: NDArray[np.integer], vectors: Float, count: int = 0) -> Float:
    """(at least `count`, 3) the sum of the vectors (n, 3) with each of `numbers` (n,), from 0 on."""
    return np.column_stack([np.bincount(numbers, weights=column, minlength=count) for column in vectors.T])


def _facing(areas: Float) -> NDArray[np.int64]:
    """(n,) one number below WAYS ** 3 for all directions (n, 3) that differ by a few degrees."""
    steps = np.minimum(((unit_rows(areas) + 1) * (WAYS / 2)).astype(np.int64), WAYS - 1)
    return np.asarray(steps @ (WAYS**2, WAYS, 1), dtype=np.int64)


def row_keys(rows: Float32) -> NDArray[np.uint64]:
    """(n,) one number for each row (n, k): the same for the same row, another for another, but for odds of 2^-64.

    Rows would be sorted without letting other threads run; numbers are not.
    """
    bits = (rows + np.float32(0.0)).view(np.uint32).astype(np.uint64)  # there are two zeros
    key = np.zeros(len(bits), np.uint64)
    for column in bits.T:  # splitmix64: Steele, Lea, Flood, OOPSLA 2014
        key = (key ^ column) + np.uint64(0x9E3779B97F4A7C15)
        key = (key ^ (key >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        key = (key ^ (key >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        key ^= key >> np.uint64(31)
    return key


def is_inside_out(vertices: Float32, triangles: Indices) -> bool:
    """True for a closed surface whose triangles face inwards; never for one that is open.

    By Gauss's theorem a closed surface's area vectors add up to nothing, and their flux of p / 3 is its volume.
    """
    faces = face_normals(vertices, triangles)
    area = np.linalg.norm(faces, axis=1).sum()
    is_closed = np.linalg.norm(faces.sum(axis=0)) < CLOSED_WITHIN * area
    corner = vertices[triangles[:, 0]].astype(np.float64)
    return bool(is_closed and np.einsum("ij,ij->", faces, corner - corner.mean(axis=0)) < 0)
