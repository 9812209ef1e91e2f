"""The marker's pose from its four corners: both solutions of IPPE, and which of them is meant.

Collins and Bartoli, "Infinitesimal plane-based pose estimation", IJCV 2014.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.corners import is_front_of_square

# The smaller error alone decides when the other is so much larger, in ratio and beyond what noisy corners explain.
DECISIVE_RATIO = 2.0
DECISIVE_PX = 0.7


@dataclass(frozen=True, slots=True)
class _Solution:
    rvec: Float  # (3,) axis times angle, camera from marker
    tvec: Float  # (3,) metres
    rms_px: float

    @property
    def R(self) -> Float:
        return np.asarray(cv2.Rodrigues(self.rvec)[0], dtype=np.float64)


def square_corners(side_m: float) -> Float:
    """(4, 3) top-left, top-right, bottom-right, bottom-left of the black square, in the marker frame."""
    half = side_m / 2
    return np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])


def estimate_pose(
    corners_px: Float, camera: Camera, side_m: float, previous: MarkerPose | None = None, refines: bool = True
) -> MarkerPose | None:
    """The pose that explains `corners_px` (4, 2), or None when no square seen from its front can.

    A square seen nearly frontally or from far has two poses that explain it about as well: `previous` then decides.
    """
    if not is_front_of_square(corners_px):
        return None
    solutions = _solutions(corners_px, camera, side_m)
    if not solutions:
        return None
    chosen, *others = solutions
    if others and previous is not None and not _is_decisive(chosen.rms_px, others[0].rms_px):
        chosen, *others = sorted(solutions, key=lambda solution: _turn(solution.R, previous.T_cam_marker[:3, :3]))
    if refines:
        chosen = _refined(chosen, corners_px, camera, side_m)
    return MarkerPose(
        T_cam_marker=rigid(chosen.R, chosen.tvec),
        corners_px=corners_px,
        side_m=side_m,
        reprojection_rms_px=chosen.rms_px,
        other_rms_px=others[0].rms_px if others else None,
    )


def _solutions(corners_px: Float, camera: Camera, side_m: float) -> list[_Solution]:
    """At most two, the smaller error first."""
    _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
        square_corners(side_m), corners_px, camera.K, camera.dist, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    candidates = [_measured(rvec, tvec, corners_px, camera, side_m) for rvec, tvec in zip(rvecs, tvecs, strict=True)]
    return sorted((one for one in candidates if one is not None), key=lambda solution: solution.rms_px)


def _measured(rvec: ArrayLike, tvec: ArrayLike, corners_px: Float, camera: Camera, side_m: float) -> _Solution | None:
    """The solution with its error (root mean square distance of the corners); None behind the camera."""
    rvec, tvec = (np.asarray(vector, dtype=np.float64).reshape(3) for vector in (rvec, tvec))
    if not (np.isfinite(rvec).all() and np.isfinite(tvec).all() and tvec[2] > 0):
        return None
    projected, _ = cv2.projectPoints(square_corners(side_m), rvec, tvec, camera.K, camera.dist)
    squared = ((projected.reshape(4, 2) - corners_px) ** 2).sum(axis=1)
    return _Solution(rvec, tvec, math.sqrt(float(squared.mean())))


def _refined(solution: _Solution, corners_px: Float, camera: Camera, side_m: float) -> _Solution:
    """Levenberg and Marquardt from `solution`; kept only if the error shrinks."""
    rvec, tvec = cv2.solvePnPRefineLM(
        square_corners(side_m), corners_px, camera.K, camera.dist, solution.rvec.copy(), solution.tvec.copy()
    )
    refined = _measured(rvec, tvec, corners_px, camera, side_m)
    return refined if refined is not None and refined.rms_px < solution.rms_px else solution


def _is_decisive(smaller_px: float, larger_px: float) -> bool:
    return larger_px > DECISIVE_RATIO * smaller_px and larger_px > math.hypot(smaller_px, DECISIVE_PX)


def _turn(R_a: Float, R_b: Float) -> float:
    """Grows with the angle between two rotations."""
    return float(np.linalg.norm(R_a - R_b))
