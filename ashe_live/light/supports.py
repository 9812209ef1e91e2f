"""Support functions of a convex body's outline in the image, and of its shadow's, with their derivatives.

A body is the convex hull of upright spheroids: a point, a horizontal disc and a ball are special cases, so that boxes,
cups, bottles and balls share one formula (docs/maths.md, "Support of a spheroid"). A line that touches the image of a
spheroid solves a quadratic; so does one that touches its shadow, the spheroid flattened onto the ground.
"""

from dataclasses import dataclass

import numpy as np

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
    by_parts: Float  # (n, 1 + l, d, 5 k) derivative by every spheroid's x, y, z, radius, half height
    by_slant: Float  # (n, l, d, 2) derivative of a shadow's reach by its s


def outline_supports(P: Float, parts: Float, slants: Float, directions: Float) -> Supports:
    """Supports of the images of n bodies and of the shadows they cast on the plane z = 0.

    P: (3, 4) pixels from the parts' frame, with positive depth at its origin. parts: (n, k, 5) centre x, y, z,
    horizontal radius, half height of spheroids. slants: (n, l, 2) displacements s. directions: (d, 2) unit vectors.
    """
    (n, k), lights, d = parts.shape[:2], slants.shape[1], len(directions)
    centres = np.empty((n, 1 + lights, k, 3))
    centres[:, 0] = parts[..., :3]
    centres[:, 1:, :, :2] = parts[:, None, :, :2] - slants[:, :, None] * parts[:, None, :, 2:3]
    centres[:, 1:, :, 2] = 0.0
    axes = np.empty((n, 1 + lights, 3, 3))  # rows: homogeneous images of the unit vectors x, y, z
    axes[:, :, :2] = P[:, :2].T
    axes[:, 0, 2] = P[:, 2]
    axes[:, 1:, 2] = -slants @ P[:, :2].T  # z, flattened along the light
    images = centres @ P[:, :3].T + P[:, 3]
    conic, radii = _dual_conics(images, axes, parts[:, None, :, 3:] ** 2, NEAREST_DEPTH * P[2, 3])

    ux, uy = directions.T
    across = conic[..., :3] @ np.array([ux * ux, 2 * ux * uy, uy * uy])
    mixed = conic[..., 3:5] @ directions.T
    depth = conic[..., 5:]
    # A point's root is 0; rounding would make it 1e-6 px, too coarse for derivatives by differences.
    blunt = radii.max(axis=-1, keepdims=True) > 0
    reach = (mixed + blunt * np.sqrt(np.maximum(mixed * mixed - depth * across, 0.0))) / depth
    part = reach.argmax(axis=2)
    reach_px = reach.max(axis=2)

    # The touching line as a form on the axes; by the envelope theorem its slopes there are all that is needed.
    slopes = directions @ axes[..., :2].swapaxes(2, 3) - reach_px[..., None] * axes[:, :, None, :, 2]
    body = np.arange(n)[:, None, None]
    touched = body, np.arange(1 + lights)[:, None], part
    squares = radii[touched]
    flat = slopes[..., 0] ** 2 + slopes[..., 1] ** 2
    tall = slopes[..., 2] ** 2
    lean = np.maximum(np.sqrt(squares[..., 0] * flat + squares[..., 1] * tall), 1e-30)
    lift = squares[..., 1] * slopes[..., 2] / lean
    depth_touched = images[..., 2][touched] + lift * axes[..., 2, 2, None]
    depth_touched += squares[..., 0] / lean * (slopes[..., :2] @ axes[..., :2, 2, None])[..., 0]
    depth_touched = np.maximum(depth_touched, NEAREST_DEPTH * P[2, 3])
    slopes /= depth_touched[..., None]
    own = parts[body, part]
    growth = np.sign(own[..., 3:]) * np.sqrt(squares) * np.stack([flat, tall], axis=-1)
    growth /= (lean * depth_touched)[..., None]
    by_parts = np.zeros((part.size * k, 5))
    by_parts[np.arange(part.size) * k + part.ravel()] = np.concatenate([slopes, growth], axis=-1).reshape(-1, 5)
    by_slant = -slopes[:, 1:, :, :2] * (own[:, 1:, :, 2] + lift[:, 1:])[..., None]
    return Supports(reach_px, by_parts.reshape(n, 1 + lights, d, 5 * k), by_slant)


def _dual_conics(images: Float, axes: Float, radii: Float, nearest: float) -> tuple[Float, Float]:
    """(n, 1 + l, k, 6) entries xx, xy, yy, xw, yw, ww of the dual conics, and the squared radii that count.

    `images` (n, 1 + l, k, 3) of the centres are mended in place where they lie behind the camera.
    """
    first, second = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
    squares = axes[..., first] * axes[..., second]
    spread = radii @ np.stack([squares[:, :, 0] + squares[:, :, 1], squares[:, :, 2]], axis=2)
    radii = np.broadcast_to(radii, (*images.shape[:3], 2))
    depth = images[..., 2]
    behind = (depth < nearest) | (depth**2 - spread[..., 5] < nearest**2)
    if behind.any():
        images[..., 2] = np.where(behind, np.maximum(depth, nearest), depth)
        radii = np.where(behind[..., None], 0.0, radii)
        spread[behind] = 0.0
    return images[..., first] * images[..., second] - spread, radii
