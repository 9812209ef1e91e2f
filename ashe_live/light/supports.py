"""Support functions of a convex body's outline in the image, and of its shadow's, with their derivatives.

A body is the convex hull of upright spheroids: a point, a horizontal disc and a ball are special cases, so that boxes,
cups, bottles and balls share one formula (docs/maths.md, "Support of a spheroid"). A line that touches the image of a
spheroid solves a quadratic; so does one that touches its shadow, the spheroid flattened onto the ground.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float

# What lies nearer to the camera's plane than this share of the body's depth counts as this near: it is far outside the
# frame, and only the direction in which it lies matters.
NEAREST_DEPTH = 0.02


@dataclass(frozen=True, slots=True)
class Supports:
    """How far outlines reach, and how that changes with the body and the shadow's displacement.

    The second axis counts the outlines: first the body's own, then that of its shadow in each of l lights.
    """

    reach_px: Float  # (n, 1 + l, d) max of u . p over the outline of body n, for direction u
    part: NDArray[np.intp]  # (n, 1 + l, d) the spheroid that reaches so far
    by_part: Float  # (n, 1 + l, d, 5) derivative by that spheroid's x, y, z, radius, half height
    by_slant: Float  # (n, l, d, 2) derivative of a shadow's reach by its s


def outline_supports(
    P: Float, parts: Float, slants: Float, directions: Float, touching: Float | None = None
) -> Supports:
    """Supports of the images of n bodies and of the shadows they cast on the plane z = 0.

    P: (n, 3, 4) pixels from the parts' frame, with positive depth at its origin. parts: (n, k, 5) centre x, y, z,
    horizontal radius, half height of spheroids. slants: (n, l, 2) displacements s. directions: (n, d, 2) unit vectors.
    touching: (n, d, 2) other directions, whose farthest parts alone count.
    """
    (n, k), outlines = parts.shape[:2], 1 + slants.shape[1]
    nearest = NEAREST_DEPTH * P[:, 2, 3, None, None]
    axes = np.repeat(P.swapaxes(1, 2)[:, None], outlines, axis=1)  # rows: homogeneous images of x, y, z, the origin
    axes[:, 1:, 2] = -slants @ axes[:, 0, :2]  # z, flattened along the light
    axes, origin = axes[:, :, :3], axes[:, :, 3:]
    images = parts[:, None, :, :3] @ axes + origin
    radii = np.repeat(parts[:, None, :, 3:], outlines, axis=1)
    reach = _reaches(images, axes, radii, directions, nearest)
    others = reach if touching is None else _reaches(images, axes, radii, touching, nearest)
    part = others.argmax(axis=2)
    reach_px = np.take_along_axis(reach, part[:, :, None], axis=2)[:, :, 0]

    # The touching line as a form on the axes; by the envelope theorem its slopes there are all that is needed.
    slopes = directions[:, None] @ axes[..., :2].swapaxes(2, 3) - reach_px[..., None] * axes[:, :, None, :, 2]
    touched = part + k * np.arange(n * outlines).reshape(n, outlines, 1)
    radius, half, depth = (each.reshape(-1).take(touched) for each in (radii[..., 0], radii[..., 1], images[..., 2]))
    height = parts[..., 2].reshape(-1).take(part + k * np.arange(n)[:, None, None])
    flat = slopes[..., 0] ** 2 + slopes[..., 1] ** 2
    tall = slopes[..., 2] ** 2
    lean = np.maximum(np.sqrt(radius**2 * flat + half**2 * tall), 1e-30)
    lift = half**2 / lean * slopes[..., 2]
    sideways = (slopes[..., :2] @ axes[..., :2, 2:])[..., 0]
    depth += radius**2 / lean * sideways + lift * axes[:, :, 2:, 2]
    by_part = np.empty((*part.shape, 5))
    by_part[..., :3] = slopes
    by_part[..., 3] = radius * flat / lean
    by_part[..., 4] = half * tall / lean
    by_part /= np.maximum(depth, nearest)[..., None]
    by_slant = -by_part[:, 1:, :, :2] * (height + lift)[:, 1:, :, None]
    return Supports(reach_px, part, by_part, by_slant)


def _reaches(images: Float, axes: Float, radii: Float, directions: Float, nearest: Float) -> Float:
    """(n, 1 + l, k, d) reach of every spheroid's outline.

    `images` (n, 1 + l, k, 3) of the centres and `radii` (n, 1 + l, k, 2) are mended in place where they lie behind the
    camera.
    """
    across = directions.swapaxes(1, 2)[:, None]
    depth = images[..., 2]
    if not radii.any():
        np.maximum(depth, nearest, out=depth)
        return np.asarray((images[..., :2] / images[..., 2:]) @ across)
    squares = axes[..., :, None] * axes[..., None, :]
    squares[:, :, 1] += squares[:, :, 0]
    spread = (radii**2 @ squares[:, :, 1:].reshape(*axes.shape[:2], 2, 9)).reshape(*images.shape, 3)
    behind = (depth < nearest) | (depth**2 - spread[..., 2, 2] < nearest**2)
    if behind.any():
        np.maximum(depth, nearest, out=depth, where=behind)
        radii[behind] = 0.0
        spread[behind] = 0.0
    conic = images[..., :, None] * images[..., None, :] - spread
    conic /= conic[..., 2:, 2:].copy()
    middle = conic[..., :2, 2] @ across
    pairs = (directions[..., :, None] * directions[..., None, :]).reshape(len(directions), 1, -1, 4).swapaxes(2, 3)
    # A point's root is 0; rounding would make it 1e-6 px, too coarse for derivatives by differences.
    blunt = np.abs(radii).max(axis=3, keepdims=True) > 0
    squared = middle**2 - conic[..., :2, :2].reshape(*depth.shape, 4) @ pairs
    return np.asarray(middle + blunt * np.sqrt(np.maximum(squared, 0.0)))
