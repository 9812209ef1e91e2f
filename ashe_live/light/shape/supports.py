"""Support functions of a convex body's outline in the image, and of its shadow's, with their derivatives.

A body is the convex hull of upright spheroids: a point, a horizontal disc and a ball are special cases, so that boxes,
cups, bottles and balls share one formula (docs/maths.md, "Support of a spheroid"). A line that touches the image of a
spheroid solves a quadratic; so does one that touches its shadow, the spheroid flattened onto the ground.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float

# What lies nearer to the camera's plane than this share of the body's depth counts as this near: it is far outside the
# frame, and only the direction in which it lies matters.
NEAREST_DEPTH = 0.02


NARROWEST_PX = 1e-3  # what is narrower is drawn as a line
# The upper half of a symmetric 3x3 matrix: rows and columns of xx, xy, yy, xw, yw, ww.
ROW, COLUMN = np.array([0, 0, 1, 0, 1, 2]), np.array([0, 1, 1, 2, 2, 2])


@dataclass(frozen=True, slots=True)
class Supports:
    """How far outlines reach, and how that changes with the body and the shadow's displacement.

    The second axis counts the outlines: first the body's own, then that of its shadow in each of l lights.
    """

    reach_px: Float  # (n, 1 + l, d) max of u . p over the outline of body n, for direction u
    part: NDArray[np.intp]  # (n, 1 + l, d) the spheroid that reaches so far
    by_part: Float  # (n, 1 + l, 5, d) derivative by that spheroid's x, y, z, radius, half height
    by_slant: Float  # (n, l, 2, d) derivative of a shadow's reach by its s

    def by_theta(self, by_shape: Float) -> Float:
        """(n, 2 l + q, 1 + l, d) derivatives by slants and shape; by_shape: (n, k, 5, q) those of the spheroids."""
        (n, outlines, d), (k, q) = self.part.shape, by_shape.shape[1::2]
        split = 2 * (outlines - 1)
        is_touched = self.part[:, :, None] == np.arange(k)[:, None]
        by_parts = (is_touched[:, :, :, None] * self.by_part[:, :, None]).reshape(n, outlines, 5 * k, d)
        slopes = np.zeros((n, split + q, outlines, d))
        slopes[:, split:] = (by_shape.reshape(n, 1, 5 * k, q).swapaxes(2, 3) @ by_parts).swapaxes(1, 2)
        for light in range(outlines - 1):
            slopes[:, 2 * light : 2 * light + 2, 1 + light] = self.by_slant[:, light]
        return slopes


def outline_supports(
    P: Float, parts: Float, slants: Float, directions: Float, touching: Float | None = None
) -> Supports:
    """Supports of the images of n bodies and of the shadows they cast on the plane z = 0.

    P: (n, 3, 4) pixels from the parts' frame, with positive depth at its origin. parts: (n, k, 5) centre x, y, z,
    horizontal radius, half height of spheroids. slants: (n, l, 2) displacements s. directions: (n, 2, d) unit vectors,
    or (n, 1 + l, 2, d) for each outline its own. touching: other such directions, whose farthest parts alone count.
    """
    if directions.ndim == 3:
        directions = directions[:, None]
    k = parts.shape[1]
    nearest = NEAREST_DEPTH * P[:, 2, 3, None, None]
    axes, origin = _axes(P, slants)
    images = parts[:, None, :, :3] @ axes + origin
    radii = np.repeat(parts[:, None, :, 3:], len(axes[0]), axis=1)
    reach = _reaches(images, axes, radii, directions, nearest)
    if touching is None:
        part, reach_px = reach.argmax(axis=2), reach.max(axis=2)
    else:
        part = _reaches(images, axes, radii, touching, nearest).argmax(axis=2)
        reach_px = np.take_along_axis(reach, part[:, :, None], axis=2)[:, :, 0]

    # The touching line as a form on the axes; by the envelope theorem its slopes there are all that is needed.
    slopes = axes[..., :2] @ directions - axes[..., 2:] * reach_px[:, :, None]
    touched = part + k * np.arange(part.shape[0] * part.shape[1]).reshape(*part.shape[:2], 1)
    depth = images[..., 2].reshape(-1).take(touched)
    height = np.repeat(parts[:, None, :, 2], part.shape[1], axis=1).reshape(-1).take(touched)
    by_part = np.zeros((*part.shape[:2], 5, part.shape[2]))
    by_part[:, :, :3] = slopes
    if radii.any():
        radius, half = (radii[..., i].reshape(-1).take(touched) for i in (0, 1))
        flat = radius * (slopes[:, :, 0] ** 2 + slopes[:, :, 1] ** 2)
        tall = half * slopes[:, :, 2] ** 2
        lean = np.maximum(np.sqrt(radius * flat + half * tall), 1e-30)
        by_part[:, :, 3], by_part[:, :, 4] = flat / lean, tall / lean
        lift = half**2 / lean * slopes[:, :, 2]
        sideways = (slopes[:, :, :2] * axes[..., :2, 2:]).sum(axis=2)
        depth += radius**2 / lean * sideways + lift * axes[..., 2, 2:]
        height += lift
    by_part /= np.maximum(depth, nearest)[:, :, None]
    by_slant = -by_part[:, 1:, :2] * height[:, 1:, None]
    return Supports(reach_px, part, by_part, by_slant)


def outline_points(P: Float, parts: Float, slants: Float, around: int) -> Float:
    """(n, 1 + l, k, around, 2) pixels around the images of spheroids and of their shadows; as in `outline_supports`."""
    axes, origin = _axes(P, slants)
    images = parts[:, None, :, :3] @ axes + origin
    radii = np.repeat(parts[:, None, :, 3:], len(axes[0]), axis=1)
    xx, xy, yy, x, y, _ = np.moveaxis(_conics(images, axes, radii, NEAREST_DEPTH * P[:, 2, 3, None, None]), -1, 0)
    # The image's shape is a symmetric matrix; its Cholesky factor makes an ellipse of a circle.
    wide = np.sqrt(np.maximum(x * x - xx, 0.0))
    skew = (x * y - xy) / np.maximum(wide, NARROWEST_PX)
    high = np.sqrt(np.maximum(y * y - yy - skew**2, 0.0))
    angles = np.arange(around) * (2 * math.pi / around)
    c, s = np.cos(angles), np.sin(angles)
    across = x[..., None] + wide[..., None] * c
    return np.stack([across, y[..., None] + skew[..., None] * c + high[..., None] * s], axis=-1)


def _axes(P: Float, slants: Float) -> tuple[Float, Float]:
    """(n, 1 + l, 3, 3) rows: the homogeneous images of x, y, z, for each outline; (n, 1 + l, 1, 3) the origin's."""
    axes = np.repeat(P.swapaxes(1, 2)[:, None], 1 + slants.shape[1], axis=1)
    axes[:, 1:, 2] = -slants @ axes[:, 0, :2]  # z, flattened along the light
    return axes[:, :, :3], axes[:, :, 3:]


def _reaches(images: Float, axes: Float, radii: Float, directions: Float, nearest: Float) -> Float:
    """(n, 1 + l, k, d) reach of every spheroid's outline; `images` and `radii` are mended as by `_conics`."""
    if not radii.any():
        np.maximum(images[..., 2], nearest, out=images[..., 2])
        return np.asarray((images[..., :2] / images[..., 2:]) @ directions)
    conics = _conics(images, axes, radii, nearest)
    across, along = directions[:, :, 0], directions[:, :, 1]
    middle = conics[..., 3:5] @ directions
    squared = middle**2 - conics[..., :3] @ np.stack([across**2, 2 * across * along, along**2], axis=2)
    # A point's root is 0; rounding would make it 1e-6 px, too coarse for derivatives by differences.
    blunt = radii.any(axis=3, keepdims=True)
    return np.asarray(middle + blunt * np.sqrt(np.maximum(squared, 0.0)))


def _conics(images: Float, axes: Float, radii: Float, nearest: Float) -> Float:
    """(n, 1 + l, k, 6) upper halves of the images' dual conics, over their last element.

    `images` (n, 1 + l, k, 3) of the centres and `radii` (n, 1 + l, k, 2) are mended in place where they lie behind the
    camera.
    """
    depth = images[..., 2]
    squares = axes[..., ROW] * axes[..., COLUMN]
    squares[:, :, 1] += squares[:, :, 0]
    spread = radii**2 @ squares[:, :, 1:]
    behind = (depth < nearest) | (depth**2 - spread[..., 5] < nearest**2)
    if behind.any():
        np.maximum(depth, nearest, out=depth, where=behind)
        radii[behind] = 0.0
        spread[behind] = 0.0
    conics = images[..., ROW] * images[..., COLUMN] - spread
    return np.asarray(conics / conics[..., 5:])
