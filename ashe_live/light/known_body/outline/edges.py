"""The edges of a known body's shadow: where they are predicted, and how they move with the light."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import PoseShapeErrors, Proxy
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import LOWEST_Z

POINTS = 105  # of an outline, spread evenly along it in the picture
EVENLY: Float = (np.arange(POINTS) + 0.5) / POINTS
EVENLY.flags.writeable = False
PLANE = [0, 1, 3]  # of homogeneous coordinates, those that places on the plane have


@dataclass(frozen=True, slots=True, eq=False)
class OutlineCorners:
    """The m corners of a shadow's outline, and the straight sides from each to the next."""

    rim: NDArray[np.intp]  # (m,) numbers of the body's points that cast them
    scales: Float  # (m,) homogeneous ones of their pixels as images of these points: depth times light's height left
    places: Float  # (2, m) metres on the plane, marker frame, over their depths
    lines: Float  # (4, m) pixels along a side's normal by metres of a place on it, times its depth; and what makes up 0


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
    share: Float  # (n,) how far along its side each is
    inverse_depth: Float  # (n,)
    drop: Float  # (n,) metres by s: the height of what casts each, over what is left of the light's above that
    corners: OutlineCorners

    def on_plane(self) -> tuple[Float, Float]:
        """(n, 2) metres on the plane, marker frame, and (n, 3) pixels along the normal by metres of such a place."""
        places = _along(self.corners.places, self.side, self.share) / self.inverse_depth
        return places.T, (self.corners.lines[:3, self.side] * self.inverse_depth).T

    def by_errors(self, errors: PoseShapeErrors, light: Float) -> Float:
        """(n, r) pixels along the normal by each cause of a body's and its frame's errors, in the light (4,)."""
        places, by_place = self.on_plane()
        turned = np.cross(np.column_stack([places, np.zeros(len(places))]), by_place)
        by_pose = np.concatenate([turned, by_place], axis=1) @ errors.pose
        # Evenly in the picture is not evenly along the body's edge that casts a side.
        after, scales = (self.side + 1) % len(self.corners.rim), self.corners.scales
        to_first, to_last = (1 - self.share) / scales[self.side], self.share / scales[after]
        way = (to_last / (to_first + to_last))[:, None, None]
        at_corners = errors.points[self.corners.rim]
        moved = at_corners[self.side] + way * (at_corners[after] - at_corners[self.side])
        s, nearness = light[:2] / light[2], float(light[3] / light[2])
        # A point at the height z casts its shadow at (x, y) - s z over 1 - z w.
        across = by_place[:, :2]
        down = -(across * (s - nearness * places)).sum(axis=1)
        by_point = np.column_stack([across, down]) * (1 + nearness * self.drop)[:, None]
        return np.asarray(by_pose + (by_point[:, :, None] * moved).sum(axis=1))


def shadow_edges(body: Proxy, light: Float, view: View) -> ShadowEdges | None:
    """The outline of the body's shadow in a light (4,), marker frame; None where it has none in the picture."""
    x, y, z, w = light.tolist()
    up = z / math.sqrt(x * x + y * y + z * z)
    if up <= LOWEST_Z:
        return None
    points, in_image = body.points_marker().T, view.camera.K @ view.T_cam_marker[:3]
    # The shadow of what is at the height h is there without it, less s h, over 1 - h w / z.
    s, nearness = light[:2] / z, w / z
    by_height = np.array([(x / z,), (y / z,), (nearness,)])
    cast = -by_height * points[2]
    cast[:2] += points[:2]
    cast[2] += 1
    image = in_image[:, PLANE] @ cast
    if not (cast[2].min() > 0 and image[2].min() > 0):
        return None
    rim = cv2.convexHull((cast[:2] / cast[2]).T.astype(np.float32), returnPoints=False)[:, 0].astype(np.intp)
    cast, scales = cast[:, rim], image[2, rim]
    pixels = image[:2, rim] / scales
    if len(rim) < 3 or not np.isfinite(pixels).all():
        return None
    lengths_px, normals = _sides(pixels)
    # A place's pixel moves along the side's normal by this over its depth, as that line's homogeneous vector says: the
    # product with places on it, (x, y, 0, 1), is 0.
    lines = in_image[:2].T @ normals - in_image[2, :, None] * (normals * pixels).sum(axis=0)
    # With pixels a by metres and s that of the light from what casts the edge, at the height h: a move of the light by
    # its own distance moves the edge by the root of a'a + (a's)^2, times h / (1 - h w / z) over the unit vector's z. A
    # disc's standard deviation is a quarter of its width.
    by_size = np.sqrt((lines[:2] ** 2).sum(axis=0) + (s @ lines[:2] + nearness * lines[3]) ** 2) / (4 * up)

    side, along_px = _evenly_along(lengths_px)
    # One look-up for all that is the same along a side.
    of_sides = np.concatenate([normals, -lines[PLANE], by_size[None], lengths_px[None]])[:, side]
    normal, by_light, by_size, length_px = of_sides[:2], of_sides[2:5], of_sides[5], of_sides[6]
    share = along_px / np.maximum(length_px, 1e-9)
    # What is projective along the body's edge is linear along its picture, if it is over the homogeneous scale.
    over_scale = _along(np.concatenate([pixels, points[2:, rim] / scales, cast[2:] / scales]), side, share)
    drop_over_depth, inverse_depth = over_scale[2:]
    return ShadowEdges(
        points_px=over_scale[:2].T,
        corners_px=pixels.T,
        normals_px=normal.T,
        side=side,
        to_corner_px=np.minimum(along_px, length_px - along_px),
        by_light=(by_light * drop_over_depth).T,
        by_size=by_size * drop_over_depth,
        share=share,
        inverse_depth=inverse_depth,
        drop=drop_over_depth / inverse_depth,
        corners=OutlineCorners(rim, scales, cast[:2] / scales, lines),
    )


def _along(of_corners: Float, side: NDArray[np.intp], share: Float) -> Float:
    """(k, n) what is given at corners (k, m), at points that lie on the sides from there, linear along these."""
    to_next = np.concatenate([of_corners[:, 1:], of_corners[:, :1]], axis=1) - of_corners
    return np.asarray(of_corners[:, side] + share * to_next[:, side])


def _evenly_along(lengths: Float) -> tuple[NDArray[np.intp], Float]:
    """(p,) the sides, of these lengths (n,), on which the POINTS of an outline lie, and how far along each."""
    ends = lengths.cumsum()
    at = EVENLY * ends[-1]
    side = np.minimum(ends.searchsorted(at, side="right"), len(lengths) - 1)
    return side, at - (ends - lengths)[side]


def _sides(pixels: Float) -> tuple[Float, Float]:
    """(m,) lengths and (2, m) outward unit normals of the sides of a convex outline (2, m), whichever way around."""
    x, y = np.concatenate([pixels[:, 1:], pixels[:, :1]], axis=1) - pixels
    lengths = np.hypot(x, y)
    outwards = np.array([y, -x] if float(pixels[0] @ y - pixels[1] @ x) > 0 else [-y, x])
    return lengths, outwards / np.maximum(lengths, 1e-12)
