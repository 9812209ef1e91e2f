"""The marker's pose from its four corners: both solutions of IPPE, and which of them is meant.

Collins and Bartoli, "Infinitesimal plane-based pose estimation", IJCV 2014.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.corners import is_front_of_square, side_lengths_px

# The smaller error alone decides when the other is so much larger: in ratio, and beyond what explains itself by noise
# and by curled paper. On a real clip, paper that curls by 2 % of its side gives the wrong pose an eighth of the error.
DECISIVE_RATIO = 2.0
NOISE_PX = 0.7
CURL = 0.03


@dataclass(frozen=True, slots=True)
class _Solution:
    R: Float  # (3, 3) camera from marker
    t: Float  # (3,) metres
    rms_px: float


def square_corners(side_m: float) -> Float:
    """(4, 3) top-left, top-right, bottom-right, bottom-left of the black square, in the marker frame."""
    half = side_m / 2
    return np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])


def estimate_pose(
    corners_px: Float, camera: Camera, side_m: float, previous: MarkerPose | None = None, refines: bool = True
) -> MarkerPose | None:
    """The pose that explains `corners_px` (4, 2), or None when no square seen from its front can.

    A square seen nearly frontally or from far has two poses that explain it about as well. `previous` then decides;
    without one, a pose that shows the surface from above is taken, as by a camera held upright over a table.
    """
    if not is_front_of_square(corners_px):
        return None
    solutions = _solutions(corners_px, camera, side_m)
    if not solutions:
        return None
    if not _is_decisive(solutions, float(side_lengths_px(corners_px).mean())):
        solutions.sort(key=_is_from_below if previous is None else _turn_from(previous.T_cam_marker[:3, :3]))
    chosen, *others = solutions
    if refines:
        chosen = _refined(chosen, corners_px, camera, side_m)
    return MarkerPose(
        T_cam_marker=rigid(chosen.R, chosen.t),
        corners_px=corners_px,
        side_m=side_m,
        reprojection_rms_px=chosen.rms_px,
        other_rms_px=others[0].rms_px if others else None,
    )


def _solutions(corners_px: Float, camera: Camera, side_m: float) -> list[_Solution]:
    """At most two, the smaller error first."""
    # OpenCV's IPPE returns nonsense for a half turn, as of a print seen upside down or exactly from above. So it is
    # asked for a frame that lies near the camera's: from the corner that is upper left in the picture, y down, z away.
    quarters = int(np.argmin(corners_px.sum(axis=1)))
    lower_left_first = np.roll(corners_px, -quarters, axis=0)[::-1].copy()
    R_asked_marker = np.diag((1.0, -1.0, -1.0)) @ _turned_about_z(quarters)
    _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
        square_corners(side_m), lower_left_first, camera.K, camera.dist, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    candidates = [
        _measured(cv2.Rodrigues(rvec)[0] @ R_asked_marker, tvec, corners_px, camera, side_m)
        for rvec, tvec in zip(rvecs, tvecs, strict=True)
    ]
    return sorted((one for one in candidates if one is not None), key=lambda solution: solution.rms_px)


def _turned_about_z(quarters: int) -> Float:
    """(3, 3) exact quarter turns, from x towards y."""
    return np.asarray(np.linalg.matrix_power(np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)]), quarters), dtype=np.float64)


def _measured(R: ArrayLike, t: ArrayLike, corners_px: Float, camera: Camera, side_m: float) -> _Solution | None:
    """The solution with its error (root mean square distance of the corners); None behind the camera."""
    R, t = np.asarray(R, dtype=np.float64), np.asarray(t, dtype=np.float64).reshape(3)
    if not (np.isfinite(R).all() and np.isfinite(t).all() and t[2] > 0):
        return None
    projected, _ = cv2.projectPoints(square_corners(side_m), cv2.Rodrigues(R)[0], t, camera.K, camera.dist)
    squared = ((projected.reshape(4, 2) - corners_px) ** 2).sum(axis=1)
    return _Solution(R, t, math.sqrt(float(squared.mean())))


def _refined(solution: _Solution, corners_px: Float, camera: Camera, side_m: float) -> _Solution:
    """Levenberg and Marquardt from `solution`; kept only if the error shrinks."""
    rvec, tvec = cv2.solvePnPRefineLM(
        square_corners(side_m), corners_px, camera.K, camera.dist, cv2.Rodrigues(solution.R)[0], solution.t.copy()
    )
    refined = _measured(cv2.Rodrigues(rvec)[0], tvec, corners_px, camera, side_m)
    return refined if refined is not None and refined.rms_px < solution.rms_px else solution


def _is_decisive(solutions: list[_Solution], side_px: float) -> bool:
    if len(solutions) < 2:
        return True
    smaller, larger = (solution.rms_px for solution in solutions)
    return larger > DECISIVE_RATIO * smaller and larger > math.hypot(smaller, max(NOISE_PX, CURL * side_px))


def _is_from_below(solution: _Solution) -> bool:
    """Whether the surface's normal points down in the picture."""
    return bool(solution.R[1, 2] > 0)


def _turn_from(R_previous: Float) -> Callable[[_Solution], float]:
    """What grows with the angle between a solution's rotation and the previous one."""
    return lambda solution: float(np.linalg.norm(solution.R - R_previous))
