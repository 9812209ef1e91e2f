"""Shapes made by formula: what the overlays are built of, and what tests measure."""

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import unit_circle
from ashe_live.models.assembly.shading_normals import corner_normals
from ashe_live.models.material import WHITE, LinearRGBA, Material
from ashe_live.models.mesh import Mesh


def box(size: ArrayLike, colour: LinearRGBA = WHITE) -> Mesh:
    """A box of `size` (3,) metres on the plane z = 0, centred over the origin, with flat faces."""
    corners = np.array([(x, y, z) for z in (0, 1) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]) * np.asarray(size)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return _faceted(corners, [(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads], colour)


def revolved(profile: ArrayLike, segments: int = 32, colour: LinearRGBA = WHITE) -> Mesh:
    """The surface that a profile (n, 2) of radius and height, in metres, sweeps around z.

    The profile runs so that its left side is inside: upwards for an outer wall.
    """
    rings = np.asarray(profile, dtype=np.float64)
    around = unit_circle(segments)
    vertices = np.concatenate([np.column_stack([radius * around, np.full(segments, z)]) for radius, z in rings])
    triangles = []
    for ring in range(len(rings) - 1):
        for here in range(segments):
            after = (here + 1) % segments
            a, b = ring * segments + here, ring * segments + after
            c, d = b + segments, a + segments
            if rings[ring, 0] > 0:
                triangles.append((a, b, c))
            if rings[ring + 1, 0] > 0:
                triangles.append((a, c, d))
    return _faceted(vertices, triangles, colour)


def _faceted(vertices: ArrayLike, triangles: list[tuple[int, int, int]], colour: LinearRGBA) -> Mesh:
    points, indices = np.asarray(vertices, dtype=np.float32), np.array(triangles, dtype=np.uint32)
    return Mesh(
        vertices=points[indices.ravel()],
        normals=corner_normals(points, indices),
        triangles=np.arange(indices.size, dtype=np.uint32).reshape(-1, 3),
        material=Material(base_colour=colour, double_sided=False),
    )
