"""Points spread over a mesh, and the values of vertices that come nearest to what was found at these points.

A vertex's own place says little about large triangles: it may lie within another part, or in a corner. Kavan, Bargteil
and Sloan, "Least squares vertex baking", EGSR 2011.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.mesh import Float32, Mesh, spread_over_triangle

LEAST_AREA = 1e-12  # square metres, of a model by which points are spread over it
STEADINESS = 0.1  # weight of the mean around a vertex, against the errors at the points
ROUNDS = 6  # of conjugate gradients, after which hardly anything changes
# Points a vertex from which on the mean around a vertex is improved upon: fewer tell no more than that.
ENOUGH = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceSamples:
    """n points on a mesh's triangles, at least one on each."""

    mesh: Mesh
    corners: NDArray[np.uint32]  # (n, 3) vertices of the point's triangle
    shares: Float32  # (n, 3) what each of them counts there: barycentric coordinates
    areas: Float  # (n,) of the surface that a point stands for, square metres

    def places_and_normals(self, time_s: float = 0.0) -> tuple[Float32, Float32]:
        """(n, 3) metres and (n, 3) unit normals of the flat triangles there, in the mesh's pose at that time."""
        vertices = self.mesh.vertices if self.mesh.motion is None else self.mesh.motion.at(time_s)[0]
        a, b, c = (vertices[self.corners[:, corner]] for corner in range(3))
        normals = np.cross(b - a, c - a)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(lengths > 0, normals / np.maximum(lengths, np.finfo(np.float32).tiny), (0.0, 0.0, 1.0))
        places = a * self.shares[:, :1] + b * self.shares[:, 1:2] + c * self.shares[:, 2:]
        return places.astype(np.float32), normals.astype(np.float32)

    def fitted(self, values: Float, weights: Float) -> Float:
        """(m,) values of the mesh's vertices whose interpolation has the least squares of errors at the points.

        values, weights: (n,). Vertices at whose triangles nothing has a weight get 1.
        """
        total = self._gathered(weights)
        mean = np.where(total > 0, self._gathered(weights * values) / np.maximum(total, 1e-30), 1.0)

        if len(values) < ENOUGH * len(total):
            return mean

        def applied(vertices: Float) -> Float:
            at_points = (vertices[self.corners] * self.shares).sum(axis=1)
            return np.asarray(self._gathered(weights * at_points) + STEADINESS * total * vertices)

        found = mean
        left = self._gathered(weights * values) + STEADINESS * total * mean - applied(found)
        # Preconditioned by the diagonal.
        inverse = np.where(total > 0, 1 / np.maximum(total, 1e-30), 0.0)
        towards = inverse * left
        for _ in range(ROUNDS):
            along = applied(towards)
            slope = float(left @ (inverse * left))
            bend = float(towards @ along)
            if bend <= 0 or slope <= 0:
                break
            step = slope / bend
            found = found + step * towards
            left = left - step * along
            towards = inverse * left + float(left @ (inverse * left)) / slope * towards
        return np.clip(found, 0.0, 1.0)

    def _gathered(self, values: Float) -> Float:
        """(m,) sums over the points by the share that each vertex has in them."""
        count = len(self.mesh.vertices)
        each = (np.bincount(self.corners[:, k], values * self.shares[:, k], minlength=count) for k in range(3))
        return np.asarray(sum(each))


def samples_on(mesh: Mesh, per_area: float) -> SurfaceSamples:
    """So many points a square metre, and one for each of the mesh's triangles."""
    areas = mesh.areas
    counts = 1 + (areas * per_area).astype(int)
    triangle = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(triangle)) - np.repeat(np.cumsum(counts) - counts, counts)
    shares = spread_over_triangle(number).astype(np.float32)
    return SurfaceSamples(mesh, mesh.triangles[triangle], shares, (areas / counts)[triangle])
