"""Points along the edge of a body's shadow in a picture, and how much a light's size blurs the edge there."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.light.shape.directions import direction_by_displacement
from ashe_live.light.shape.layout import nearness_of
from ashe_live.light.shape.light_points import cast_on_ground, relative_distances

# Distance between the points on a straight edge, in the marker's sides, as no picture shows how large its world is; and
# their largest number.
APART, MOST_POINTS = 0.05, 50
ACROSS = 0.0125  # sides: step on the ground by which the picture's scale across an edge is measured


@dataclass(frozen=True, slots=True, eq=False)
class EdgePoints:
    """Points along the predicted outline of a shadow in a picture."""

    points_px: Float  # (n, 2)
    normals_px: Float  # (n, 2) unit vectors out of the shadow
    spreads_px: Float  # (n,) standard deviation of the penumbra of a light of 1 rad


def edge_points(proxy: Proxy, light: Float, camera: Camera, T_cam_marker: Float, side_m: float) -> EdgePoints | None:
    """Points along the outline of the shadow in a light (4,); None where it is infinite or behind the camera.

    side_m: of the marker.
    """
    apart_m, across_m = APART * side_m, ACROSS * side_m
    points = proxy.points_marker()
    shadows = cast_on_ground(points, light)
    if shadows is None:
        return None
    border = _Border.around(shadows[:, :2], points)
    edge, part = border.places(apart_m)
    ends = np.zeros((len(edge), 2, 3))
    ends[:, :, :2] = (border.corners[edge] + part[:, None] * border.along[edge])[:, None]
    ends[:, 1, :2] += across_m * border.outward[edge]
    pixels = project(camera, T_cam_marker, ends.reshape(-1, 3)).reshape(-1, 2, 2)
    across = pixels[:, 1] - pixels[:, 0]
    scale = np.hypot(*across.T)
    seen = scale > 1e-6  # which is false for NaN, the projection of what lies behind the camera
    if not seen.any():
        return None
    points = border.casting_at(edge, part, light)
    spreads = points[:, 2] * _blur_per_height(light, points, border.outward[edge]) / 4 * scale / across_m
    return EdgePoints(pixels[seen, 0], across[seen] / scale[seen, None], spreads[seen])


@dataclass(frozen=True, slots=True, eq=False)
class _Border:
    """The convex border of a shadow on the ground: k corners, each with the edge to the next one, metres."""

    corners: Float  # (k, 2)
    casting: Float  # (k, 3) points of the body that cast them
    along: Float  # (k, 2) from a corner to the next one
    outward: Float  # (k, 2) unit normals of the edges

    @staticmethod
    def around(shadows: Float, points: Float) -> "_Border":
        """Of the shadows (n, 2) that points (n, 3) cast."""
        rim = cv2.convexHull(shadows.astype(np.float32), returnPoints=False)[:, 0]
        corners = shadows[rim]
        along = np.roll(corners, -1, axis=0) - corners
        outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        outward[((corners + 0.5 * along - corners.mean(axis=0)) * outward).sum(axis=1) < 0] *= -1
        return _Border(corners, points[rim], along, outward)

    def places(self, apart_m: float) -> tuple[NDArray[np.intp], Float]:
        """(n,) edges, and (n,) parts of the way along them, of places about `apart_m` apart."""
        length = np.hypot(*self.along.T)
        count = np.where(length < 1e-9, 0, np.clip(length / apart_m, 1, MOST_POINTS).astype(int))
        edge = np.repeat(np.arange(len(count)), count)
        return edge, (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[edge]

    def casting_at(self, edge: NDArray[np.intp], part: Float, light: Float) -> Float:
        """(n, 3) the points that cast such places in a light (4,).

        Points of the body's edge between two corners cast theirs in the ratio of the corners' homogeneous scales.
        """
        following = np.roll(self.casting, -1, axis=0)
        begin, end = (1 - each[edge, 2:] * nearness_of(light) for each in (self.casting, following))
        way = part[:, None] * begin / (part[:, None] * begin + (1 - part[:, None]) * end)
        return np.asarray(self.casting[edge] + way * (following - self.casting)[edge])


def _blur_per_height(light: Float, points: Float, normals: Float) -> Float:
    """(n,) how far the shadows on the ground of points (n, 3) move along normals (n, 2), over the points' heights, as
    the light moves by 1 rad, seen from the marker's centre.

    normals: unit vectors on the ground.
    """
    offsets = light[:3] - light[3] * points
    # All points see a light at infinity in one direction.
    several, which = np.unique(offsets[:, :2] / offsets[:, 2:], axis=0, return_inverse=True)
    moved = np.empty(len(points))
    for number, displacement in enumerate(several):
        seen_there = which.reshape(-1) == number
        by_direction = np.linalg.inv(direction_by_displacement(displacement))
        moved[seen_there] = np.linalg.norm(normals[seen_there] @ by_direction, axis=1)
    return moved / relative_distances(light, points, np.zeros(3))
