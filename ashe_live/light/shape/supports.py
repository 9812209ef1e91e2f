"""Support functions of the outlines, in the image, of a convex body and of its shadows, with their derivatives.

A body is the convex hull of upright spheroids: a point, a horizontal disc and a ball are special cases, so that boxes,
cups, bottles and balls share one formula (docs/maths, "Support of a spheroid"). The tangent lines of a spheroid's
image satisfy a quadratic equation, that of its dual conic; so do those of its shadow, which is another image of the
spheroid, through the light's projection onto the ground.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.light.shape.family import Members
from ashe_live.light.shape.layout import ParameterLayout
from ashe_live.light.shape.light_points import shadow_projection

# Least depth, as a fraction of the body's. Points that are nearer to the camera's plane are moved there: they are far
# outside the frame, and only the direction in which they lie matters.
NEAREST_DEPTH = 0.02


NARROWEST_PX = 1e-3  # narrower ellipses are drawn as lines
# The upper half of a symmetric 3x3 matrix: rows and columns of xx, xy, yy, xw, yw, ww.
ROW, COLUMN = np.array([0, 0, 1, 0, 1, 2]), np.array([0, 1, 1, 2, 2, 2])


@dataclass(frozen=True, slots=True)
class Supports:
    """The support functions of outlines, and their derivatives by the body and the lights.

    The second axis counts the outlines: first the body's, then that of its shadow in each of l lights.
    """

    reach_px: Float  # (n, 1 + l, d) max of u . p over the outline of body n, for direction u
    part: NDArray[np.intp]  # (n, 1 + l, d) index of the spheroid that reaches farthest
    # (n, 1 + l, 5, d) derivative by that spheroid's x, y, z, radius, half height; of points (n, 1 + l, 3, d)
    by_part: Float
    by_light: Float  # (n, l, 3, d) derivative of a shadow's reach by its light's displacement s and nearness w / z

    def by_theta(self, by_shape: Float, with_nearness: bool = False) -> Float:
        """(n, split + q, 1 + l, d) derivatives by theta.

        by_shape: (n, k, 5, q) those of the spheroids by the shape. with_nearness: as in the ParameterLayout of theta.
        """
        (n, outlines, d), fields = self.part.shape, self.by_part.shape[2]
        k, q = by_shape.shape[1::2]
        layout = ParameterLayout(outlines - 1, with_nearness)
        is_touched = self.part[:, :, None] == np.arange(k)[:, None]
        by_parts = (is_touched[:, :, :, None] * self.by_part[:, :, None]).reshape(n, outlines, k * fields, d)
        slopes = np.zeros((n, layout.split + q, outlines, d))
        by_fields = by_shape[:, :, :fields].reshape(n, 1, k * fields, q).swapaxes(2, 3)
        slopes[:, layout.split :] = (by_fields @ by_parts).swapaxes(1, 2)
        for light in range(layout.lights):
            slopes[:, layout.light(light), 1 + light] = self.by_light[:, light, : layout.per_light]
        return slopes


def outline_reaches(
    members: Members,
    P: Float,
    lights: Float,
    directions: Float,
    touching: Float | None = None,
    with_nearness: bool = False,
) -> tuple[Float, Float]:
    """(n, 1 + l, d) support functions of n bodies and their shadows; (n, split + q, 1 + l, d) derivatives by theta.

    with_nearness: as in the ParameterLayout of theta. All else as in `outline_supports`.
    """
    (n, q), (_, count, _), d = members.shapes.shape, lights.shape, directions.shape[-1]
    split = ParameterLayout(count, with_nearness).split
    reach_px, by_theta = np.empty((n, 1 + count, d)), np.zeros((n, split + q, 1 + count, d))
    for batch in members.batches():
        rows = batch.rows
        turned = None if touching is None else touching[rows]
        supports = outline_supports(P[rows], batch.parts, lights[rows], directions[rows], turned)
        reach_px[rows] = supports.reach_px
        by_theta[rows, : split + batch.by_shape.shape[3]] = supports.by_theta(batch.by_shape, with_nearness)
    return reach_px, by_theta


def outline_supports(
    P: Float, parts: Float, lights: Float, directions: Float, touching: Float | None = None
) -> Supports:
    """The support functions of the images of n bodies and of the shadows they cast on the plane z = 0.

    P: (n, 3, 4) pixels from the parts' frame, with positive depth at its origin. parts: (n, k, 5) centre x, y, z,
    horizontal radius, half height of spheroids. lights: (n, l, 4) homogeneous points in that frame, above the parts.
    directions: (n, 2, d) unit vectors, or (n, 1 + l, 2, d) if each outline has others. touching: directions of the same
    shape, by which the farthest spheroids are selected whose supports along `directions` are returned.
    """
    if directions.ndim == 3:
        directions = directions[:, None]
    k = parts.shape[1]
    nearest = NEAREST_DEPTH * P[:, 2, 3, None, None]
    axes, origin = _axes(P, lights)
    seen = _Images.of(parts, axes, origin, nearest)
    reach = seen.reaches(directions)
    if touching is None:
        part, reach_px = reach.argmax(axis=2), reach.max(axis=2)
    else:
        part = seen.reaches(touching).argmax(axis=2)
        reach_px = np.take_along_axis(reach, part[:, :, None], axis=2)[:, :, 0]

    # By the envelope theorem, the derivatives follow from the tangent line alone, evaluated on the axes' images.
    slopes = axes[..., :2] @ directions - axes[..., 2:] * reach_px[:, :, None]
    touched = part + k * np.arange(part.shape[0] * part.shape[1]).reshape(*part.shape[:2], 1)
    depth = seen.centres[..., 2].reshape(-1).take(touched)
    height = np.repeat(parts[:, None, :, 2], part.shape[1], axis=1).reshape(-1).take(touched)
    by_part = slopes
    if seen.conics is not None:
        radius, half = (seen.radii[..., i].reshape(-1).take(touched) for i in (0, 1))
        flat = radius * (slopes[:, :, 0] ** 2 + slopes[:, :, 1] ** 2)
        tall = half * slopes[:, :, 2] ** 2
        lean = np.maximum(np.sqrt(radius * flat + half * tall), 1e-30)
        by_part = np.concatenate([slopes, (flat / lean)[:, :, None], (tall / lean)[:, :, None]], axis=2)
        lift = half**2 / lean * slopes[:, :, 2]
        sideways = (slopes[:, :, :2] * axes[..., :2, 2:]).sum(axis=2)
        depth += radius**2 / lean * sideways + lift * axes[..., 2, 2:]
        height += lift
    depth = np.maximum(depth, nearest)[:, :, None]
    by_part = by_part / depth
    from_origin = (origin[..., :2] @ directions - origin[..., 2:] * reach_px[:, :, None]) / depth
    by_light = -np.concatenate([by_part[:, 1:, :2], from_origin[:, 1:]], axis=2) * height[:, 1:, None]
    return Supports(reach_px, part, by_part, by_light)


def outline_points(P: Float, parts: Float, lights: Float, around: int) -> Float:
    """(n, 1 + l, k, around, 2) pixels on the ellipses of spheroids and of their shadows; (n, 1 + l, k, 1, 2) of points.

    P, parts, lights: as in `outline_supports`. around: points on each ellipse.
    """
    axes, origin = _axes(P, lights)
    seen = _Images.of(parts, axes, origin, NEAREST_DEPTH * P[:, 2, 3, None, None])
    if seen.conics is None:
        return np.asarray((seen.centres[..., :2] / seen.centres[..., 2:])[..., None, :])
    xx, xy, yy, x, y, _ = np.moveaxis(seen.conics, -1, 0)
    # The ellipse is the image of the unit circle under the Cholesky factor of its symmetric matrix.
    wide = np.sqrt(np.maximum(x * x - xx, 0.0))
    skew = (x * y - xy) / np.maximum(wide, NARROWEST_PX)
    high = np.sqrt(np.maximum(y * y - yy - skew**2, 0.0))
    angles = np.arange(around) * (2 * math.pi / around)
    c, s = np.cos(angles), np.sin(angles)
    across = x[..., None] + wide[..., None] * c
    return np.stack([across, y[..., None] + skew[..., None] * c + high[..., None] * s], axis=-1)


def _axes(P: Float, lights: Float) -> tuple[Float, Float]:
    """(n, 1 + l, 3, 3) rows: homogeneous images of the x, y, z axes for each outline; (n, 1 + l, 1, 3) the origin's."""
    images = np.concatenate([P[:, None], P[:, None] @ shadow_projection(lights)], axis=1)
    axes = np.ascontiguousarray(images.swapaxes(2, 3))
    return axes[:, :, :3], axes[:, :, 3:]


@dataclass(frozen=True, slots=True, eq=False)
class _Images:
    """The images of spheroids and of their shadows; those that extend behind the camera are replaced by points."""

    centres: Float  # (n, 1 + l, k, 3) homogeneous
    radii: Float  # (n, 1 + l, k, 2)
    conics: Float | None  # (n, 1 + l, k, 6) upper halves of the dual conics, over their last element; None of points

    @staticmethod
    def of(parts: Float, axes: Float, origin: Float, nearest: Float) -> "_Images":
        centres = parts[:, None, :, :3] @ axes + origin
        radii = np.repeat(parts[:, None, :, 3:], len(axes[0]), axis=1)
        if not radii.any():
            np.maximum(centres[..., 2], nearest, out=centres[..., 2])
            return _Images(centres, radii, None)
        depth = centres[..., 2]
        squares = axes[..., ROW] * axes[..., COLUMN]
        squares[:, :, 1] += squares[:, :, 0]
        spread = radii**2 @ squares[:, :, 1:]
        behind = (depth < nearest) | (depth**2 - spread[..., 5] < nearest**2)
        if behind.any():
            np.maximum(depth, nearest, out=depth, where=behind)
            radii[behind] = 0.0
            spread[behind] = 0.0
        conics = centres[..., ROW] * centres[..., COLUMN] - spread
        return _Images(centres, radii, conics / conics[..., 5:])

    def reaches(self, directions: Float) -> Float:
        """(n, 1 + l, k, d) support function of every spheroid's outline."""
        if self.conics is None:
            return np.asarray((self.centres[..., :2] / self.centres[..., 2:]) @ directions)
        across, along = directions[:, :, 0], directions[:, :, 1]
        middle = self.conics[..., 3:5] @ directions
        squared = middle**2 - self.conics[..., :3] @ np.stack([across**2, 2 * across * along, along**2], axis=2)
        # For a point the root is 0; rounding would make it 1e-6 px, too coarse for tests by finite differences.
        blunt = self.radii.any(axis=3, keepdims=True)
        return np.asarray(middle + blunt * np.sqrt(np.maximum(squared, 0.0)))
