"""The uncertainty of a direction beyond its outlines': pose, focal length, systematic errors, and low confidence."""

import math

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import tangent_basis
from ashe_live.core.types import TrackedFrame

FLOOR_RAD = math.radians(0.4)  # sigma along each axis of systematic errors: corner bias, a curled sheet, the lens
ASSUMED_FOCAL_RAD = math.radians(0.6)  # the same, for a field of view that nobody measured
# Sigma along each axis added to an answer of confidence 0. Calibrated: where confidence is low, errors are larger than
# the covariance of the outlines states.
DOUBT_RAD = math.radians(30)


def covariance_of_outlines(covariance_rad2: Float) -> Float:
    """(2, 2) rad^2: a direction's covariance from that of its outlines alone, with the floor of systematic errors."""
    return np.asarray(covariance_rad2 + FLOOR_RAD**2 * np.eye(2))


def covariance_of_direction(covariance_rad2: Float, to_light_marker: Float, tracked: TrackedFrame) -> Float:
    """(2, 2) rad^2 on the direction's tangent basis: as `covariance_of_outlines`, plus pose and focal length."""
    assert tracked.marker is not None
    total = covariance_of_outlines(covariance_rad2)
    if tracked.camera.source == "assumed":
        total = total + ASSUMED_FOCAL_RAD**2 * np.eye(2)
    if tracked.marker.covariance is not None:
        # A turn about the eastward axis moves a direction up, one about the upward axis moves it east.
        east, up = tangent_basis(to_light_marker) @ tracked.marker.T_cam_marker[:3, :3].T
        by_turn = np.array([up, -east])
        total = total + by_turn @ tracked.marker.covariance[:3, :3] @ by_turn.T
    return np.asarray(0.5 * (total + total.T))


def covariance_of_doubt(confidence: float) -> Float:
    """(2, 2) rad^2: the covariance to add for the chance that the outlines are not the object's and its shadow's."""
    return np.asarray((DOUBT_RAD * (1 - confidence) ** 3) ** 2 * np.eye(2))
