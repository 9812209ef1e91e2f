"""Detects surfaces that coincide but look different: which of them is seen is left to chance, here as elsewhere.

Two triangles that share an edge, lie in one plane and on one side of the edge overlap for certain. So copies are found
even if their polygons were cut along other diagonals.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.assembly.shading_normals import row_keys, unit_rows
from ashe_live.models.mesh import Mesh

WORDS = "surfaces that look different lie in one another, and which of them is seen is left to chance"
MOST_TRIANGLES = 200_000  # more are not looked through, as that takes a second
ONE_PLACE = 1e-5  # of the model's size
ONE_PLANE = 0.9999  # the cosine between two directions in it
ALIKE = 0.1  # difference of colours, normals, or texture coordinates that is hard to see
LEAST_SHARE = 0.01  # of the model's surface
NEXT = 3  # number of others that a triangle is compared with, of those at the same edge


def overlap_visibly(parts: Sequence[Mesh]) -> bool:
    """Whether more than LEAST_SHARE of the surface lies in another one that looks otherwise."""
    if sum(len(part.triangles) for part in parts) > MOST_TRIANGLES:
        return False
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    triangles = np.concatenate([part.triangles.astype(int) + first for part, first in zip(parts, firsts, strict=True)])
    vertices = np.concatenate([part.vertices for part in parts]).astype(np.float64)
    looks = np.concatenate([_looks(part) for part in parts])
    both_sides = np.repeat([part.material.double_sided for part in parts], [len(part.triangles) for part in parts])
    normals = np.concatenate([part.normals for part in parts]).astype(np.float64)
    found = _overlapping(vertices, triangles, looks, normals, both_sides)
    areas = np.concatenate([part.areas for part in parts])
    return bool(areas[found].sum() > LEAST_SHARE * areas.sum())


def _looks(part: Mesh) -> Float:
    """(n, 7) of the vertices: colour, metal, roughness, and where they lie on the picture."""
    count, material = len(part.vertices), part.material
    looks = np.zeros((count, 7))
    looks[:, :3] = np.array(material.base_colour[:3]) * (1.0 if part.colours is None else part.colours[:, :3])
    looks[:, 3:5] = material.metallic, material.roughness
    if material.base_map is not None and part.uvs is not None:
        looks[:, 5:] = part.uvs
    return looks


def _overlapping(
    vertices: Float, triangles: NDArray[np.int64], looks: Float, normals: Float, both_sides: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Triangles that overlap one that looks otherwise where they share an edge."""
    grain = ONE_PLACE * max(float(np.ptp(vertices, axis=0).max()), 1e-30)
    _, place = np.unique(row_keys(np.round(vertices / grain).astype(np.float32)), return_inverse=True)
    begins, ends, others = (np.roll(triangles, -turn, axis=1).ravel() for turn in range(3))
    swapped = place[begins] > place[ends]
    begins, ends = np.where(swapped, ends, begins), np.where(swapped, begins, ends)
    along = unit_rows(vertices[ends] - vertices[begins])
    aside = vertices[others] - vertices[begins]
    aside = unit_rows(aside - (aside * along).sum(axis=1, keepdims=True) * along)
    keys = place[begins] * len(vertices) + place[ends]
    order = np.argsort(keys, kind="stable")
    found: list[NDArray[np.int64]] = []
    for step in range(1, NEXT + 1):
        one, other = order[:-step], order[step:]
        is_pair = (keys[one] == keys[other]) & ((aside[one] * aside[other]).sum(axis=1) > ONE_PLANE)
        one, other = one[is_pair], other[is_pair]
        # Those that run along the edge in opposite directions are back to back, each seen from its own side.
        is_same_way = swapped[one] == swapped[other]
        # Of what is seen from behind the normal is turned round.
        turned = np.where(is_same_way, 1.0, -1.0)[:, None]
        differ = np.zeros(len(one))
        for corners in (begins, ends):
            for values, sense in ((looks, 1.0), (normals, turned)):
                apart = np.abs(values[corners[one]] - sense * values[corners[other]])
                differ = np.maximum(differ, apart.max(axis=1, initial=0))
        is_seen = is_same_way | both_sides[one // 3] | both_sides[other // 3]
        pairs = (differ > ALIKE) & is_seen
        found += [one[pairs] // 3, other[pairs] // 3]
    return np.unique(np.concatenate(found))
