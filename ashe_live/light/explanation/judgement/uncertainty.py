"""The uncertainty of a direction beyond its outlines': pose, focal length, systematic errors, and low confidence."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import tangent_basis
from ashe_live.core.types import TrackedFrame

FLOOR_RAD = math.radians(0.4)  # sigma along each axis of systematic errors: corner bias, a curled sheet, the lens


def covariance_of_outlines(covariance_rad2: Float) -> Float:
    """(2, 2) rad^2: a direction's covariance from that of its outlines alone, with the floor of systematic errors."""
    return np.asarray(covariance_rad2 + FLOOR_RAD**2 * np.eye(2))


@dataclass(frozen=True, slots=True)
class Calibration:
    """How errors exceed what outlines alone imply, fitted by `ashe-live bench fit-judge` (docs/maths.md, (24))."""

    overdispersion: float  # factor on the outlines' covariance: errors of neighbouring borders are correlated
    doubt_rad: float  # sigma along each axis added to an answer of confidence 0
    doubt_power: float  # of the doubt 1 - confidence, by which that sigma falls

    def covariance(
        self, covariance_rad2: Float, to_light_marker: Float, confidence: float, tracked: TrackedFrame
    ) -> Float:
        """(2, 2) rad^2 on the direction's tangent basis, of all causes: outlines, pose, focal length, and doubt.

        covariance_rad2: (2, 2) of the outlines alone. confidence: the probability that these are the object's and its
        shadow's.
        """
        doubt = (self.doubt_rad * (1 - confidence) ** self.doubt_power) ** 2 * np.eye(2)
        of_outlines = covariance_of_outlines(self.overdispersion * covariance_rad2)
        return np.asarray(of_outlines + _covariance_of_pose(to_light_marker, tracked) + doubt)


def _covariance_of_pose(to_light_marker: Float, tracked: TrackedFrame) -> Float:
    """(2, 2) rad^2 on the direction's tangent basis: the uncertainty of the marker's rotation and the focal length."""
    assert tracked.marker is not None
    total = np.zeros((2, 2))
    if tracked.marker.covariance is not None:
        # A turn about the eastward axis moves a direction up, one about the upward axis moves it east.
        east, up = tangent_basis(to_light_marker) @ tracked.marker.T_cam_marker[:3, :3].T
        by_turn = np.array([up, -east])
        total = total + by_turn @ tracked.marker.covariance[:3, :3] @ by_turn.T
    return np.asarray(0.5 * (total + total.T))
