"""The pose that explains weighted points best: Levenberg and Marquardt with the exact Jacobian, and its covariance.

A step turns the points about the marker's origin and moves them, along the camera's axes: R' = exp(w) R, t' = t + v.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float, cross_3d
from ashe_live.core.transforms import pixels_by_pose

STEPS = 8
# A step that moves no point by more than this many standard deviations ends it.
SMALL_STEP = 1e-3
# How far off the last pose may leave the corners to be as good a start as a square's own; and how far out of one
# square's plane, over its side, others lie of which only one pose remains possible.
FOLLOWED_PX, LEAST_DEPTH = 2.0, 0.3
FIRST_DAMPING, EASED, TIGHTENED = 1e-4, 0.1, 10.0


@dataclass(frozen=True, slots=True)
class PoseSolution:
    """A pose with what it leaves unexplained."""

    R: Float  # (3, 3) camera from marker
    t: Float  # (3,) metres
    rms_px: float  # root mean square distance of the points
    cost: float  # squared distance in standard deviations, summed


@dataclass(frozen=True, slots=True)
class PoseCovariances:
    """(6, 6) each, of (w, v), rad and metres, see the module."""

    whole: Float  # by all that the information of the pixels allows for
    noise: Float  # by the noise that was given
    by_log_focal: Float  # by a focal length whose logarithm has a standard deviation of one


@dataclass(frozen=True, slots=True, eq=False)
class Correspondences:
    """Points of the marker's frame, and where they are in the picture of a camera with intrinsics K (3, 3)."""

    points: Float  # (n, 3) metres
    pixels: Float  # (n, 2) ideal pixels
    information: Float  # (2n, 2n) inverse covariance of the pixels

    def solution(self, R: ArrayLike, t: ArrayLike, K: Float) -> PoseSolution | None:
        """A pose with its errors; None where it has points behind the camera."""
        R, t = np.asarray(R, dtype=np.float64), np.asarray(t, dtype=np.float64).reshape(3)
        in_camera = self.points @ R.T + t
        if not in_camera[:, 2].min() > 0:
            return None
        error = self._error(in_camera, K)
        cost = float(error @ self.information @ error)
        return (
            PoseSolution(R, t, math.sqrt(float(error @ error) / len(self.points)), cost)
            if math.isfinite(cost)
            else None
        )

    def refined(self, start: PoseSolution, K: Float) -> PoseSolution:
        """The solution with the least cost near `start`."""
        best, damping = start, FIRST_DAMPING
        for _ in range(STEPS):
            turned = self.points @ best.R.T
            in_camera = turned + best.t
            jacobian = pixels_by_pose(turned, in_camera, K).reshape(-1, 6)
            weighted = jacobian.T @ self.information
            hessian = weighted @ jacobian
            try:
                step = np.linalg.solve(
                    hessian + damping * np.diag(np.diag(hessian)), -weighted @ self._error(in_camera, K)
                )
            except np.linalg.LinAlgError:
                return best
            tried = self.solution(cv2.Rodrigues(step[:3])[0] @ best.R, best.t + step[3:], K)
            if tried is None or not tried.cost <= best.cost:
                damping *= TIGHTENED
                continue
            best, damping = tried, damping * EASED
            if step @ hessian @ step < SMALL_STEP**2:
                break
        return best

    def followed(self, T_previous: Float, K: Float) -> PoseSolution | None:
        """The solution with the least cost near the last pose (4, 4), of points that are the corners of squares.

        None where that is no start, as too far off, or where all lie in one plane, of which a second pose has to be
        asked.
        """
        points = self.points
        x, y = points[1] - points[0], points[0] - points[3]
        if np.abs((points - points[0]) @ cross_3d(x, y)).max() < LEAST_DEPTH * float(x @ x) ** 1.5:
            return None
        start = self.solution(T_previous[:3, :3], T_previous[:3, 3], K)
        return None if start is None or start.rms_px > FOLLOWED_PX else self.refined(start, K)

    def covariances(self, solution: PoseSolution, K: Float, noise: Float) -> PoseCovariances:
        """`noise` (2n, 2n) is the part of the pixels' covariance, the inverse of `information`, that is noise."""
        turned = self.points @ solution.R.T
        in_camera = turned + solution.t
        jacobian = pixels_by_pose(turned, in_camera, K).reshape(-1, 6)
        weighted = jacobian.T @ self.information
        covariance = _inverse(weighted @ jacobian)
        by_pixels = covariance @ weighted
        # A longer focal length moves pixels away from the principal point, and the pose makes up for it.
        from_centre = (in_camera[:, :2] / in_camera[:, 2:]) @ K[:2, :2].T
        by_focal = by_pixels @ from_centre.ravel()
        return PoseCovariances(covariance, by_pixels @ noise @ by_pixels.T, np.outer(by_focal, by_focal))

    def _error(self, in_camera: Float, K: Float) -> Float:
        """(2n,) by which the points, camera frame, are beside their pixels."""
        return np.asarray(((in_camera / in_camera[:, 2:]) @ K[:2].T - self.pixels).ravel())


def _inverse(hessian: Float) -> Float:
    """Scaled to a unit diagonal first, as radians and metres may lie far apart."""
    scale = 1 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled = scale[:, None] * hessian * scale
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(scaled, hermitian=True)
    return np.asarray(scale[:, None] * inverse * scale)
