"""Sample points on the outlines of bodies and of their shadows, and how they move with the bodies' parameters."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, cross_2d
from ashe_live.light.shape.body import LitBody, members_of
from ashe_live.light.shape.sight import Sight
from ashe_live.light.shape.supports import outline_reaches

POINTS_PER_OUTLINE = 48  # points of an outline at which its border is searched
BORDERS_PER_SAMPLE = 2.3  # such borders over their effective sample size, as neighbours' errors are correlated
EXPECTED_SHARE = 0.6  # sigma of the prior on a border's distance from the outline, as a fraction of what is searched
BENT_PX = 0.01  # a corner that stands out less than this from an edge is taken to lie on it
FARTHEST_PX = 5e3  # of an outline from the picture's corner
TURN_RAD = 0.03  # by which a supporting line is rotated to touch one end of a straight edge or the other


def are_in_view(hulls_px: Sequence[Float | None]) -> bool:
    """Whether outlines (m, 2) in pixels can all be projected, none of them unreasonably far out."""
    return all(hull is not None and np.abs(hull).max() <= FARTHEST_PX for hull in hulls_px)


@dataclass(frozen=True, slots=True, eq=False)
class OutlinePoints:
    """Sample points spread evenly over n closed outlines, the same number p on each."""

    points: Float  # (n, p, 2) pixels
    normals: Float  # (n, p, 2) outward
    along_edge: Float  # (n, p) position between the ends of the point's straight edge, 0 to 1, in the sense from x to y


def evenly_spaced(hulls_px: Sequence[Float]) -> OutlinePoints:
    """Points on the outline of each of n convex hulls (m, 2), pixels."""
    hulls = [cv2.approxPolyDP(hull.astype(np.float32), BENT_PX, True)[:, 0] for hull in hulls_px]
    most = max(len(hull) for hull in hulls)
    # Hulls with fewer corners are padded with copies of their last one.
    corners = np.array(
        [np.concatenate([hull, hull[-1:].repeat(most - len(hull), axis=0)]) for hull in hulls], np.float64
    )
    edges = np.concatenate([corners[:, 1:], corners[:, :1]], axis=1) - corners
    lengths = np.hypot(edges[..., 0], edges[..., 1])
    ends = lengths.cumsum(axis=1)
    at = (np.arange(POINTS_PER_OUTLINE) + 0.5) / POINTS_PER_OUTLINE * ends[:, -1:]
    edge = np.minimum((ends[:, None] <= at[..., None]).sum(axis=2), most - 1)
    row = np.arange(len(hulls))[:, None]
    length = np.maximum(lengths[row, edge], 1e-9)
    along_edge = 1 - (ends[row, edge] - at) / length
    along = edges[row, edge]
    points = corners[row, edge] + along_edge[..., None] * along
    twice_area = cross_2d(corners, edges).sum(axis=1)
    sense = np.where(twice_area > 0, 1.0, -1.0)[:, None]  # of the corners' order: from x to y, or the other way
    normals = along[..., ::-1] * (1, -1) * (sense / length)[..., None]
    return OutlinePoints(points, normals, np.where(sense > 0, along_edge, 1 - along_edge))


def derivatives_by_theta(
    several: Sequence[LitBody], sights: Sequence[Sight], points: OutlinePoints, with_nearness: bool = False
) -> Float:
    """(n, split + q, (1 + l) p) derivatives by theta of the outward movement of points on n bodies' outlines.

    A point on a straight edge moves by interpolation between the edge's two ends, which may belong to different
    spheroids: those that the edge's line touches when it is rotated slightly one way and the other.
    """
    n, bodies = len(several), [lit.body for lit in several]
    c, s = math.cos(TURN_RAD), math.sin(TURN_RAD)
    normals = points.normals.reshape(n, -1, POINTS_PER_OUTLINE, 2).swapaxes(2, 3)
    along_edge = points.along_edge.reshape(n, -1, POINTS_PER_OUTLINE)
    aside = s * normals[:, :, ::-1] * [[-1], [1]]
    outward = np.concatenate([normals, normals], axis=3)
    turned = np.concatenate([c * normals - aside, c * normals + aside], axis=3)
    P = np.array([sight.P(body.frame) for sight, body in zip(sights, bodies, strict=True)])
    lights = np.array([lit.lights_in_body_frame for lit in several])
    _, by_theta = outline_reaches(members_of(bodies), P, lights, outward, turned, with_nearness)
    ends = by_theta[..., :POINTS_PER_OUTLINE], by_theta[..., POINTS_PER_OUTLINE:]
    return np.asarray(
        ((1 - along_edge)[:, None] * ends[0] + along_edge[:, None] * ends[1]).reshape(n, by_theta.shape[1], -1)
    )


def sizes_px(outlines: Float) -> Float:
    """(n,) square roots of the areas of closed outlines (n, p, 2)."""
    x, y = outlines[..., 0], outlines[..., 1]
    twice = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    return np.asarray(np.sqrt(0.5 * np.abs(twice)))
