"""The focal length from the squareness of one marker in many views: a bundle adjustment with all that may be wrong.

A square seen in perspective tells the focal length (Zhang, PAMI 2000, equations 3 and 4), but so weakly that a lens
that is off-centre, bent paper or bloomed edges are taken for it. So these are unknowns too (see `focal_model`), held by
priors that say how wrong such things are as a rule, and the posterior's sigma of the focal length contains them.
"""

import math
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size
from ashe_live.tracking.focal.focal_model import SQUARE, UNKNOWNS, FocalModel, FocalState, Q, prior_information

# Least noise assumed of corners, however well a few views happen to fit.
MIN_NOISE_PX = 0.04
# Degrees of freedom of Student's t-distribution, by which views that fit badly count less.
FREEDOM = 4.0
ITERATIONS = 12
# Number of parts of the time that the jackknife leaves out, one after the other. It reveals errors that last for a
# while (a stabiliser that shifts the picture, a rolling shutter, a lens that focuses).
BLOCKS = 6
JACKKNIFE_ITERATIONS = 4
# Start values of q. Poses that were tracked with a much shorter focal length may be mirrored, and hold the fit in a
# wrong minimum.
STARTS = (1.0, 0.2)
COMPARED_AT_PX = 0.1
HALVINGS = 6
MOST_TURN_RAD = 0.5  # in a step
MIN_DEPTH = 0.1  # of a corner, over the marker's own
FLIP_GAIN = 9.0  # in squared sigmas: by how much a view must prefer the mirrored pose


class FocalFit(NamedTuple):
    """The focal length by all views."""

    focal_px: float  # infinite when no perspective was seen
    relative_sigma: float  # systematic errors included


class _Step(NamedTuple):
    """Gauss and Newton's, and what is known where it starts."""

    g: Float  # (10,)
    poses: Float  # (n, 6) turns in radians, then t
    noise_px: float
    covariance: Float  # (10, 10) of the globals


class _Solution(NamedTuple):
    """The most probable state, and how sure its globals are."""

    state: FocalState
    noise_px: float  # of a corner's coordinate
    covariance: Float  # (10, 10) of the globals


def fit_focal(corners_px: Float, R_cam_marker: Float, focal_px: float, size: Size) -> FocalFit:
    """From `corners_px` (n, 4, 2) and where to start: rotations (n, 3, 3) and a focal length, right within a factor.

    The views are in the order of their times; the pictures are `size` (width, height) large.
    """
    middle = (np.array(size) - 1) / 2
    problem = _Problem(corners_px - middle, size)
    best = min(
        (problem.fitted(R_cam_marker, factor / focal_px) for factor in STARTS),
        key=lambda found: problem.misfit(found.state),
    )
    # With all poses mirrored in depth, and the paper's curl, -q predicts the very same corners: where the fit began
    # from mirrored poses, the size of q is the answer.
    q = abs(float(best.state.g[Q]))
    if q == 0:
        return FocalFit(math.inf, math.inf)
    sigma_q = max(math.sqrt(float(best.covariance[Q, Q])), _jackknife(corners_px - middle, size, best.state))
    return FocalFit(1 / q, sigma_q / q)


def _jackknife(measured_px: Float, size: Size, state: FocalState) -> float:
    """The standard deviation of q from leaving out one stretch of time after another."""
    count = len(measured_px)
    blocks = min(BLOCKS, count)
    if blocks < 2:
        return math.inf
    found = []
    for block in range(blocks):
        kept = np.arange(count) * blocks // count != block
        part = FocalState(state.g, state.R[kept], state.t[kept])
        found.append(_Problem(measured_px[kept], size).solve(part, JACKKNIFE_ITERATIONS).state.g[Q])
    return math.sqrt((blocks - 1) / blocks * float(np.square(found - np.mean(found)).sum()))


class _Problem:
    """Some views' corners, to be explained together."""

    def __init__(self, measured_px: Float, size: Size) -> None:
        self._model = FocalModel(measured_px, size)
        self._information = prior_information(size)

    def _start(self, R: Float, q: float) -> FocalState:
        g = np.zeros(UNKNOWNS)
        g[Q] = q
        # Weak perspective: the ratio of sizes gives the depth, the middle the place.
        turned = SQUARE @ np.swapaxes(R, 1, 2)
        spread_px = self._model.measured_px - self._model.measured_px.mean(axis=1, keepdims=True)
        zeta = np.sqrt((turned[..., :2] ** 2).sum(axis=(1, 2)) / (spread_px**2).sum(axis=(1, 2)))
        t = np.column_stack([self._model.measured_px.mean(axis=1) * zeta[:, None], zeta])
        state = FocalState(g, R.copy(), t)
        for _ in range(4):
            state = self._pose_step(state)
        return state

    def fitted(self, R: Float, q: float) -> _Solution:
        """As `solve`, from these poses and from those of them mirrored that then fit better."""
        found = self.solve(self._start(R, q))
        flipped = self._better_flipped(found.state, found.noise_px)
        return found if flipped is None else self.solve(flipped)

    def misfit(self, state: FocalState) -> float:
        """The measure by which solutions are compared."""
        return self._cost(state, COMPARED_AT_PX)

    def solve(self, state: FocalState, iterations: int = ITERATIONS) -> _Solution:
        """From `state` downhill."""
        for _ in range(iterations):
            step = self._step(state)
            state, is_better = self._walked(state, step)
            if not is_better or abs(step.g[Q]) < 1e-3 * math.sqrt(step.covariance[Q, Q]):
                break
        return _Solution(state, step.noise_px, step.covariance)

    def _walked(self, state: FocalState, step: _Step) -> tuple[FocalState, bool]:
        """As much of the step as lowers the cost; False when nothing of it does."""
        cost = self._cost(state, step.noise_px)
        for halvings in range(HALVINGS):
            part = 0.5**halvings
            walked = _moved(state, part * step.g, part * step.poses)
            if self._cost(walked, step.noise_px) <= cost:
                return walked, True
        return state, False

    def _cost(self, state: FocalState, noise_px: float) -> float:
        """Twice the negative log of the posterior; infinite where a corner would lie behind the camera."""
        residuals, depth = self._model.residuals(state)
        if not (depth > MIN_DEPTH * state.t[:, None, 2]).all():
            return math.inf
        squared = np.square(residuals).sum(axis=(1, 2)) / noise_px**2
        likelihood = (FREEDOM + 2) * np.log1p(squared / FREEDOM).sum()
        return float(likelihood + (self._information * state.g**2).sum())

    def _better_flipped(self, state: FocalState, noise_px: float) -> FocalState | None:
        """`state` with those views mirrored that fit better so, or None when there are none."""
        sight = np.column_stack([state.t[:, :2] / state.t[:, 2:] * state.g[Q], np.ones(len(state.t))])
        sight /= np.linalg.norm(sight, axis=1, keepdims=True)
        # The normal mirrored at the line of sight, by the shortest turn.
        normals = state.R[:, :, 2]
        along = (normals * sight).sum(axis=1, keepdims=True)
        mirrored = 2 * along * sight - normals
        axis = np.cross(normals, mirrored)
        sine = np.linalg.norm(axis, axis=1, keepdims=True)
        angle = np.arctan2(sine, (normals * mirrored).sum(axis=1, keepdims=True))
        turns = _rotations(axis / np.maximum(sine, 1e-12) * angle)
        other = FocalState(state.g, turns @ state.R, state.t)
        for _ in range(6):
            other = self._pose_step(other)
        (before, _), (after, depth) = self._model.residuals(state), self._model.residuals(other)
        gain = np.square(before).sum(axis=(1, 2)) - np.square(after).sum(axis=(1, 2))
        swaps = (gain > FLIP_GAIN * noise_px**2) & (depth > 0).all(axis=1)
        if not swaps.any():
            return None
        return FocalState(
            state.g,
            np.where(swaps[:, None, None], other.R, state.R),
            np.where(swaps[:, None], other.t, state.t),
        )

    def _pose_step(self, state: FocalState) -> FocalState:
        """Gauss and Newton on every pose by itself."""
        residuals, _ = self._model.residuals(state)
        J_pose, _ = self._model.derivatives(state)
        steps = -np.linalg.pinv(J_pose) @ residuals.reshape(len(residuals), 8, 1)
        return _moved(state, np.zeros(UNKNOWNS), steps[..., 0])

    def _step(self, state: FocalState) -> _Step:
        """Gauss and Newton on everything; the poses are eliminated, as each belongs to one view alone."""
        residuals, _ = self._model.residuals(state)
        J_pose, J_globals = self._model.derivatives(state)
        count = len(residuals)
        r = residuals.reshape(count, 8, 1)
        # What no change of the pose can explain: two of the eight numbers of each view.
        orthogonal, triangular = np.linalg.qr(J_pose, mode="complete")
        explained, rest = orthogonal[:, :, :6], orthogonal[:, :, 6:]
        r_rest = (np.swapaxes(rest, 1, 2) @ r)[..., 0]
        A_rest = np.swapaxes(rest, 1, 2) @ J_globals
        squared = (r_rest**2).sum(axis=1)
        noise_px = _noise(squared)
        weights = (FREEDOM + 2) / (FREEDOM + squared / noise_px**2) / noise_px**2
        information = np.einsum("n,nki,nkj->ij", weights, A_rest, A_rest) + np.diag(self._information)
        gradient = np.einsum("n,nki,nk->i", weights, A_rest, r_rest) + self._information * state.g
        scale = np.sqrt(np.diag(information))
        covariance = np.linalg.pinv(information / np.outer(scale, scale), hermitian=True) / np.outer(scale, scale)
        step = -covariance @ gradient
        left = np.swapaxes(explained, 1, 2) @ (r + J_globals @ step[:, None])
        pose_steps = -np.linalg.solve(triangular[:, :6] + 1e-12 * np.eye(6), left)[..., 0]
        return _Step(step, pose_steps, noise_px, covariance)


def _moved(state: FocalState, step: Float, pose_steps: Float) -> FocalState:
    turns = pose_steps[:, :3]
    turns = turns * np.minimum(1.0, MOST_TURN_RAD / np.maximum(np.linalg.norm(turns, axis=1, keepdims=True), 1e-12))
    t = state.t + pose_steps[:, 3:]
    # A marker does not come through the camera, nor grow tenfold, in a step.
    t[:, 2] = np.clip(t[:, 2], 0.3 * state.t[:, 2], 3 * state.t[:, 2])
    return FocalState(state.g + step, _rotations(turns) @ state.R, t)


def _noise(squared: Float) -> float:
    """The corners' noise in pixels from squared sums of two normal numbers each, by their median."""
    return max(MIN_NOISE_PX, math.sqrt(float(np.median(squared)) / (2 * math.log(2))))


def _rotations(vectors: Float) -> Float:
    """(n, 3, 3) of rotation vectors (n, 3)."""
    return np.array([cv2.Rodrigues(vector)[0] for vector in vectors])
