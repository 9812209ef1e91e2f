"""A simple body that stands for the real object: it occludes, casts shadows and receives them in its place."""

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from ashe_live.core import arguments
from ashe_live.core.arrays import Float, frozen_floats, frozen_view, read_only_copies, set_frozen, unit_circle

TILTS = np.linspace(-math.pi / 2, math.pi / 2, 9)  # from a spheroid's lowest point to its highest


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class ProxyMesh:
    """A closed surface of any shape."""

    points_marker: Float  # (n, 3) metres, marker frame
    triangles: NDArray[np.uint32]  # (m, 3) indices of points, counter-clockwise from outside

    def __post_init__(self) -> None:
        points = frozen_floats(self.points_marker, (-1, 3), "points_marker")
        given = np.asarray(self.triangles)
        is_right = given.ndim == 2 and given.shape[1] == 3 and given.size > 0 and given.dtype.kind in "iu"
        if not is_right or int(given.min()) < 0 or int(given.max()) >= len(points):
            raise ValueError(f"triangles must be (m, 3) indices of the {len(points)} points")
        triangles = given.astype(np.uint32, copy=False)
        set_frozen(self, points_marker=points, triangles=frozen_view(triangles))


@read_only_copies
@dataclass(frozen=True, eq=False)
class Proxy:
    """The real object's stand-in: the convex hull of upright spheroids (a point, a disc, a ball are special cases)."""

    family: str  # the kind of body that was fitted, e.g. box; "silhouettes": their hull, in several views
    spheroids_marker: Float  # (k, 5) centre x, y, z, horizontal radius, half height; metres, marker frame
    mesh: ProxyMesh | None = None  # the surface itself where it is not convex

    def __post_init__(self) -> None:
        set_frozen(self, spheroids_marker=frozen_floats(self.spheroids_marker, (-1, 5), "spheroids_marker"))
        if not len(self.spheroids_marker):
            raise ValueError("spheroids_marker has none, and so no body")
        if self.mesh is not None:
            arguments.instance(self.mesh, ProxyMesh, "mesh")

    @cached_property
    def foot_marker(self) -> Float:
        """(3,) the point on the ground below the middle of the spheroids' centres, marker frame, metres."""
        return frozen_view(np.array([*self.spheroids_marker[:, :2].mean(axis=0), 0.0]))

    @cached_property
    def height_m(self) -> float:
        """Metres of its highest point above the marker's plane."""
        return float((self.spheroids_marker[:, 2] + self.spheroids_marker[:, 4]).max())

    def points_marker(self, around: int = 24) -> Float:
        """(m, 3) points of the spheroids' surfaces, marker frame, metres; the body is about their convex hull.

        That is exact for corners. What is round has `around` points to the turn, and its hull lies within the body.
        """
        if not self.spheroids_marker[:, 3:].any():
            return self.spheroids_marker[:, :3]
        circle = unit_circle(around)
        clouds = []
        for x, y, z, radius, half in self.spheroids_marker:
            tilts = TILTS if half else TILTS[4:5]
            ring = circle if radius else circle[:1]
            cloud = np.empty((len(tilts), len(ring), 3))
            cloud[..., :2] = radius * np.cos(tilts)[:, None, None] * ring + (x, y)
            cloud[..., 2] = z + half * np.sin(tilts)[:, None]
            clouds.append(cloud.reshape(-1, 3))
        return np.concatenate(clouds)

    def surface(self, around: int = 48, upwards: int = 25) -> tuple[Float, NDArray[np.uint32]]:
        """(n, 3) points and (m, 3) triangles, counter-clockwise from outside; marker frame, metres.

        The mesh if there is one. Otherwise a grid on the unit sphere, with each direction moved to the hull's farthest
        point along it: exact where the hull is round; at a corner all directions meet in which it is the farthest.
        """
        if self.mesh is not None:
            return self.mesh.points_marker, self.mesh.triangles
        directions, triangles = _grid(around, upwards)
        centre, radius, half = np.split(self.spheroids_marker, (3, 4), axis=1)
        axes = np.concatenate([radius, radius, half], axis=1)
        reach = np.linalg.norm(axes * directions[:, None], axis=2)
        farthest = (directions @ centre.T + reach).argmax(axis=1)
        at = np.arange(len(directions))
        length = np.maximum(reach[at, farthest], np.finfo(np.float64).tiny)[:, None]
        points = centre[farthest] + axes[farthest] ** 2 * directions / length
        return points, triangles


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class PoseShapeErrors:
    """How a body and the frame in which it stands on its plane may be off together: independent causes, r of them.

    Each as far as it goes in one standard deviation.
    """

    pose: Float  # (6, r) of the frame, marker's axes: its turn about its origin, rad, and its shift, metres
    points: Float  # (m, 3, r) of the body's points in it, metres

    def __post_init__(self) -> None:
        causes = np.shape(self.pose)[-1]
        set_frozen(
            self,
            pose=frozen_floats(self.pose, (6, causes), "pose"),
            points=frozen_floats(self.points, (-1, 3, causes), "points"),
        )


@cache
def _grid(around: int, upwards: int) -> tuple[Float, NDArray[np.uint32]]:
    """(n, 3) directions of a grid on the unit sphere, and (m, 3) its triangles; shared by all, and so read-only."""
    # Half a step off the axes, in which boxes have their faces.
    azimuth = (np.arange(around) + 0.5) * (2 * math.pi / around)
    sine = np.sin(np.linspace(-math.pi / 2, math.pi / 2, upwards))[:, None]
    flat = np.sqrt(1 - np.minimum(sine**2, 1.0))
    grid = [flat * np.cos(azimuth), flat * np.sin(azimuth), sine + 0 * azimuth]
    directions, triangles = np.stack(grid, axis=-1).reshape(-1, 3), grid_triangles(around, upwards)
    directions.flags.writeable = triangles.flags.writeable = False
    return directions, triangles


def grid_triangles(around: int, upwards: int) -> NDArray[np.uint32]:
    """(m, 3) indices into rings of `around` points each, the lowest first: counter-clockwise from outside."""
    corner = np.arange((upwards - 1) * around).reshape(-1, around)
    right = np.roll(corner, -1, axis=1)
    quads = np.stack([corner, right, right + around, corner, right + around, corner + around], axis=-1)
    return quads.reshape(-1, 3).astype(np.uint32)
