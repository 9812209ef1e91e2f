"""The edges of a known body's shadow: where they are predicted, and how they move with the light."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy, Wobble
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import nearness_of
from ashe_live.light.shape.light_points import cast_on_ground

POINTS = 105  # of an outline, spread evenly along it in the picture
EVENLY: Float = (np.arange(POINTS) + 0.5) / POINTS
EVENLY.flags.writeable = False


@dataclass(frozen=True, slots=True, eq=False)
class ShadowEdges:
    """Points on a shadow's outline in a picture."""

    points_px: Float  # (n, 2)
    corners_px: Float  # (m, 2) those of the outline, which is convex
    normals_px: Float  # (n, 2) unit vectors out of the shadow
    side: NDArray[np.intp]  # (n,) number of the point's straight side, among the outline's corners
    to_corner_px: Float  # (n,) distance from the nearer end of that side
    by_light: Float  # (n, 3) pixels along the normal by s_x, s_y and by w / z, 1/m
    by_size: Float  # (n,) standard deviation, pixels, of the penumbra of a light of 1 rad
    places: Float  # (n, 2) metres on the plane, marker frame
    by_place: Float  # (n, 3) pixels along the normal by metres of such a place
    rim: NDArray[np.intp]  # (m,) numbers of the body's points that cast the corners
    way: Float  # (n,) how far what casts each point is from that of its side's first corner to that of the next
    height_left: Float  # (n,) of the light's height, above what casts each: 1 of a sun

    def by_wobble(self, wobble: Wobble, light: Float) -> Float:
        """(n, r) pixels along the normal by each cause of a body's and its frame's errors, in the light (4,)."""
        turned = np.cross(np.column_stack([self.places, np.zeros(len(self.places))]), self.by_place)
        by_pose = np.concatenate([turned, self.by_place], axis=1) @ wobble.pose
        at_corners = wobble.points[self.rim]
        first, second = at_corners[self.side], at_corners[(self.side + 1) % len(self.rim)]
        moved = first + self.way[:, None, None] * (second - first)
        s, nearness = light[:2] / light[2], float(nearness_of(light))
        # A point at the height z casts its shadow at (x, y) - s z over 1 - z w.
        across = self.by_place[:, :2]
        down = -(across * (s - nearness * self.places)).sum(axis=1)
        by_point = np.column_stack([across, down]) / self.height_left[:, None]
        return np.asarray(by_pose + (by_point[:, :, None] * moved).sum(axis=1))


def shadow_edges(body: Proxy, light: Float, view: View) -> ShadowEdges | None:
    """The outline of the body's shadow in a light (4,), marker frame; None where it has none in the picture."""
    points = body.points_marker()
    cast = cast_on_ground(points, light)
    if cast is None:
        return None
    rim = cv2.convexHull(cast[:, :2].astype(np.float32), returnPoints=False)[:, 0].astype(np.intp)
    corners, casting = cast[rim, :2], points[rim]
    in_image = view.camera.K @ view.T_cam_marker[:3]
    depths, pixels = _projected(in_image, corners)
    if len(rim) < 3 or not (depths.min() > 0 and np.isfinite(pixels).all()):
        return None
    after = np.arange(1, len(rim) + 1) % len(rim)
    sides, lengths_px, outwards = _sides(pixels, after)
    # A place's pixel moves along the side's normal by this over its depth, as that line's homogeneous vector says.
    across_depth = outwards @ in_image[:2, :3] - (outwards * pixels).sum(axis=1)[:, None] * in_image[2, :3]

    side, along_px = _evenly_along(lengths_px)
    stop, length_px = after[side], lengths_px[side]
    share = along_px / np.maximum(length_px, 1e-9)
    points_px = pixels[side] + share[:, None] * sides[side]
    # Evenly in the picture is not evenly on the table: a side's points are those of its line's homogeneous points.
    part = _homogeneous(share, depths[side], depths[stop])
    places = corners[side] + part[:, None] * (corners[stop] - corners[side])
    depth = depths[side] + part * (depths[stop] - depths[side])
    # And those of the body's edge are in the ratio of their homogeneous scales.
    nearness = float(nearness_of(light))
    left = 1 - casting[:, 2] * nearness
    way = _homogeneous(part, left[side], left[stop])
    origin = casting[side] + way[:, None] * (casting[stop] - casting[side])

    by_place = across_depth[side] / depth[:, None]
    across = by_place[:, :2]
    height_left = 1 - origin[:, 2] * nearness
    lower = origin[:, 2] / height_left
    by_light = np.column_stack([-across * lower[:, None], (across * places).sum(axis=1) * lower])
    offsets = (light[:3] - light[3] * origin) / np.linalg.norm(light[:3])
    by_size = _penumbra(across, lower, offsets)
    to_corner_px = np.minimum(along_px, length_px - along_px)
    return ShadowEdges(
        points_px,
        pixels,
        outwards[side],
        side,
        to_corner_px,
        by_light,
        by_size,
        places,
        by_place,
        rim,
        way,
        height_left,
    )


def _projected(in_image: Float, places: Float) -> tuple[Float, Float]:
    """(n,) depths and (n, 2) pixels of places (n, 2) on the plane; pixels are not finite where the depth is 0.

    in_image: (3, 4) homogeneous pixels from the marker frame.
    """
    image = places @ in_image[:, :2].T + in_image[:, 3]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return image[:, 2], image[:, :2] / image[:, 2:]


def _evenly_along(lengths: Float) -> tuple[NDArray[np.intp], Float]:
    """(p,) the sides, of these lengths (n,), on which the POINTS of an outline lie, and how far along each."""
    ends = lengths.cumsum()
    at = EVENLY * ends[-1]
    side = np.minimum(np.searchsorted(ends, at, side="right"), len(lengths) - 1)
    return side, at - ends[side] + lengths[side]


def _sides(pixels: Float, after: NDArray[np.intp]) -> tuple[Float, Float, Float]:
    """Of a polygon's straight sides, which are lines in the picture as well: (n, 2) ways, (n,) lengths, (n, 2) normals.

    pixels: (n, 2) its corners. after: (n,) each one's next. Normals are unit and point outwards.
    """
    ways = pixels[after] - pixels
    lengths = np.hypot(ways[:, 0], ways[:, 1])
    normals = np.column_stack([ways[:, 1], -ways[:, 0]]) / np.maximum(lengths, 1e-12)[:, None]
    is_clockwise = (pixels[:, 0] * ways[:, 1] - pixels[:, 1] * ways[:, 0]).sum() > 0
    return ways, lengths, normals if is_clockwise else -normals


def _homogeneous(share: Float, first: Float, last: Float) -> Float:
    """(n,) the part of a segment at a `share` of its projection, whose ends have the homogeneous scales."""
    return np.asarray(share * first / np.maximum(share * first + (1 - share) * last, 1e-12))


def _penumbra(across: Float, lower: Float, offsets: Float) -> Float:
    """(n,) standard deviation by the light's angular diameter, seen from the marker's centre: a disc's is a quarter.

    offsets: (n, 3) from what casts each point to the light, over the light's distance from the marker's centre.
    """
    s = offsets[:, :2] / offsets[:, 2:]
    # A turn of the direction by 1 moves s, and with it the edge along `across`, by no more than this: with the metric
    # (I - s s' / (1 + s's)) / (1 + s's) of directions in s, whose inverse is (1 + s's) (I + s s').
    squared = (1 + (s * s).sum(axis=1)) * ((across * across).sum(axis=1) + (across * s).sum(axis=1) ** 2)
    return np.asarray(np.sqrt(squared / (offsets * offsets).sum(axis=1)) * lower / 4)
