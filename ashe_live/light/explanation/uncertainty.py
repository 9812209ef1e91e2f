"""How uncertain a direction is beyond its outlines: the pose, the focal length, what is never seen, and doubt."""

import math

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import tangent_basis
from ashe_live.core.types import TrackedFrame

FLOOR_RAD = math.radians(0.4)  # along each axis: the corners' bias, a curled sheet, the lens
ASSUMED_FOCAL_RAD = math.radians(0.6)  # the same, for a field of view that nobody measured
# Along each axis, of an answer in which there is no confidence at all. Measured: where confidence is low, errors are
# larger than outlines know.
DOUBT_RAD = math.radians(30)


def of_outlines(covariance_rad2: Float) -> Float:
    """(2, 2): a direction's covariance, given that of its outlines alone."""
    return np.asarray(covariance_rad2 + FLOOR_RAD**2 * np.eye(2))


def of_direction(covariance_rad2: Float, to_light_marker: Float, tracked: TrackedFrame) -> Float:
    """(2, 2) on the direction's tangent basis: the above, and what pose and camera add."""
    assert tracked.marker is not None
    total = of_outlines(covariance_rad2)
    if tracked.camera.source == "assumed":
        total = total + ASSUMED_FOCAL_RAD**2 * np.eye(2)
    if tracked.marker.covariance is not None:
        # A turn about the eastward axis moves a direction up, one about the upward axis moves it east.
        east, up = tangent_basis(to_light_marker) @ tracked.marker.T_cam_marker[:3, :3].T
        by_turn = np.array([up, -east])
        total = total + by_turn @ tracked.marker.covariance[:3, :3] @ by_turn.T
    return np.asarray(0.5 * (total + total.T))


def of_doubt(confidence: float) -> Float:
    """(2, 2): what it adds that the outlines may be those of something else."""
    return np.asarray((DOUBT_RAD * (1 - confidence) ** 3) ** 2 * np.eye(2))
