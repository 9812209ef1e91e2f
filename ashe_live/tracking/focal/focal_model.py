"""How one marker's corners come about in many views: its square, which may be misprinted, poses, and a lens.

With q = 1/f and depth in units of f, a point (x, y, z) of the marker turned into the camera frame projects to
m = (x + t_x, y + t_y) / (zeta + q z): linear in q near q = 0, where perspective vanishes. So q, and not f, has a nearly
normal posterior, and "infinitely far" is no special case.
"""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, cross_2d
from ashe_live.core.camera import Size
from ashe_live.core.square import square_corners

SQUARE = square_corners(1.0)  # in sides
# Deformations of a printed square, other than motions and scalings: (mode, corner, xyz).
SADDLE = np.array([1.0, -1.0, 1.0, -1.0])
SHAPE_MODES = np.array(
    [
        SQUARE * (0.5, -0.5, 0.0),  # wider than high
        SQUARE[:, (1, 0, 2)] * 0.5,  # a rhombus
        np.outer(SADDLE, (0.5, 0.0, 0.0)),  # the two keystones
        np.outer(SADDLE, (0.0, 0.5, 0.0)),
        np.outer(SADDLE, (0.0, 0.0, 0.5)),  # curled: two opposite corners up, two down
    ]
)
SHAPE_SIGMA = np.array([0.006, 0.006, 0.004, 0.004, 0.05])
# Principal point off the picture's middle, over its width; displacement at the picture's corner, over its distance;
# and how far bright paper eats into the black square.
CENTRE_SIGMA = 0.02
DISTORTION_SIGMA = 0.03
BLOOM_SIGMA_PX = 0.15

Q, CX, CY, KAPPA, BLOOM, SHAPE = 0, 1, 2, 3, 4, slice(5, 10)
UNKNOWNS = 10


@dataclass(frozen=True, slots=True)
class FocalState:
    """Globals (see Q, CX...) and the poses of all views."""

    g: Float  # (10,) q in 1/px; cx, cy, bloom in px from the picture's middle; the rest has no unit
    R: Float  # (n, 3, 3)
    t: Float  # (n, 3) t_x, t_y in sides; zeta in sides a pixel


class FocalModel:
    """The corners measured in all views, and what a state predicts of them."""

    def __init__(self, measured_px: Float, size: Size) -> None:
        """`measured_px` (n, 4, 2) from the picture's middle; pictures are `size` (width, height) large."""
        self.measured_px = measured_px
        self._half_diagonal_px = math.hypot(*size) / 2
        self._inward = _inward(measured_px)

    def residuals(self, state: FocalState) -> tuple[Float, Float]:
        """Pixels (n, 4, 2), and the corners' depths (n, 4) in units of f."""
        g = state.g
        _, depth, ideal = _projected(state)
        radius2 = (ideal**2).sum(axis=-1, keepdims=True) / self._half_diagonal_px**2
        predicted = ideal * (1 + g[KAPPA] * radius2) + g[CX : CY + 1] + g[BLOOM] * self._inward
        return predicted - self.measured_px, depth

    def derivatives(self, state: FocalState) -> tuple[Float, Float]:
        """Derivatives of the residuals by the poses (n, 8, 6) and by the globals (n, 8, 10)."""
        g, count = state.g, len(state.R)
        turned, depth, ideal = _projected(state)
        radius2 = (ideal**2).sum(axis=-1) / self._half_diagonal_px**2
        # By the ideal place (n, 4, 2, 2), and from there on by the chain rule.
        outer = ideal[..., :, None] * ideal[..., None, :] * (2 * g[KAPPA] / self._half_diagonal_px**2)
        bending = outer + (1 + g[KAPPA] * radius2)[..., None, None] * np.eye(2)

        def chained(of_numerator: Float, of_depth: Float) -> Float:
            change = (of_numerator - ideal * of_depth[..., None]) / depth[..., None]
            return np.asarray((bending @ change[..., None])[..., 0].reshape(count, 8))

        J_pose = np.empty((count, 8, 6))
        none, one = np.zeros((count, 4)), np.ones((count, 4))
        x, y, z = np.moveaxis(turned, -1, 0)
        for at, (dx, dy, dz) in enumerate(((none, -z, y), (z, none, -x), (-y, x, none))):  # a turn about each axis
            J_pose[:, :, at] = chained(np.stack([dx, dy], axis=-1), g[Q] * dz)
        J_pose[:, :, 3] = chained(np.stack([one, none], axis=-1), none)
        J_pose[:, :, 4] = chained(np.stack([none, one], axis=-1), none)
        J_pose[:, :, 5] = chained(np.zeros((count, 4, 2)), one)
        J_globals = np.zeros((count, 8, UNKNOWNS))
        J_globals[:, :, Q] = chained(np.zeros((count, 4, 2)), turned[..., 2])
        J_globals[:, 0::2, CX] = J_globals[:, 1::2, CY] = 1
        J_globals[:, :, KAPPA] = (ideal * radius2[..., None]).reshape(count, 8)
        J_globals[:, :, BLOOM] = self._inward.reshape(count, 8)
        for at, mode in enumerate(SHAPE_MODES):
            moved = mode @ np.swapaxes(state.R, 1, 2)
            J_globals[:, :, SHAPE.start + at] = chained(moved[..., :2], g[Q] * moved[..., 2])
        return J_pose, J_globals


def prior_information(size: Size) -> Float:
    """(10,) inverse variances of the globals, about zero, in pictures of `size`; nothing is known of q."""
    sigma = np.empty(UNKNOWNS)
    sigma[Q] = math.inf
    sigma[[CX, CY]] = CENTRE_SIGMA * size[0]
    sigma[KAPPA], sigma[BLOOM], sigma[SHAPE] = DISTORTION_SIGMA, BLOOM_SIGMA_PX, SHAPE_SIGMA
    return np.asarray(1 / sigma**2)


def _projected(state: FocalState) -> tuple[Float, Float, Float]:
    """The corners turned (n, 4, 3) in sides, their depths (n, 4), and their places (n, 4, 2) through a perfect lens."""
    shape = SQUARE + np.tensordot(state.g[SHAPE], SHAPE_MODES, axes=1)
    turned = shape @ np.swapaxes(state.R, 1, 2)
    depth = state.t[:, None, 2] + state.g[Q] * turned[..., 2]
    return turned, depth, (turned[..., :2] + state.t[:, None, :2]) / depth[..., None]


def _inward(corners: Float) -> Float:
    """(n, 4, 2) how the corners (n, 4, 2) move when every side moves inwards by one pixel."""
    after, before = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    after /= np.linalg.norm(after, axis=-1, keepdims=True)
    before /= np.linalg.norm(before, axis=-1, keepdims=True)
    sine = np.abs(cross_2d(after, before))
    return np.asarray((after + before) / np.maximum(sine, 1e-6)[..., None])
