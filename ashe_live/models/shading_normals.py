"""Normals for meshes that bring none: smooth where the surface is, sharp where it has an edge."""

import math

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Float32, Indices

CREASE_RAD = math.radians(40)
CLOSED_WITHIN = 1e-4  # of the area


def face_normals(vertices: Float32, triangles: Indices) -> Float:
    """(m, 3) normals of twice the triangles' area in length, right-handed."""
    a, b, c = np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)
    return np.asarray(np.cross(b - a, c - a))


def unit_rows(vectors: Float) -> Float:
    """(n, 3) at length 1; z where there is no direction, so that a degenerate triangle stays finite."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0, vectors / np.where(lengths > 0, lengths, 1.0), (0.0, 0.0, 1.0))


def corner_normals(vertices: Float32, triangles: Indices) -> Float32:
    """(3 m, 3) unit normals, one for each triangle's corner in the order of `triangles.ravel()`.

    A corner averages, by area, the triangles at the same place whose planes differ by less than CREASE_RAD.
    """
    faces = face_normals(vertices, triangles)
    units = unit_rows(faces)
    place = row_keys(vertices)[triangles.ravel()]
    order = np.argsort(place, kind="stable")
    place, face = place[order], order // 3
    total = faces[face].copy()
    smooth = math.cos(CREASE_RAD)
    _, crowds = np.unique(place, return_counts=True)
    for step in range(1, int(crowds.max())):
        first, second = np.arange(len(place) - step), np.arange(step, len(place))
        meet = place[first] == place[second]
        first, second = first[meet], second[meet]
        alike = np.einsum("ij,ij->i", units[face[first]], units[face[second]]) > smooth
        first, second = first[alike], second[alike]
        total[first] += faces[face[second]]
        total[second] += faces[face[first]]
    normals = np.empty_like(total)
    normals[order] = total
    return unit_rows(normals).astype(np.float32)


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
