"""The covariance of a direction by all causes: outlines, pose, focal length, systematic errors, low confidence."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import tangent_basis
from ashe_live.core.types import TrackedFrame
from ashe_live.light.shape.directions import HEMISPHERE_RAD, FittedLight

FLOOR_RAD = math.radians(0.4)  # sigma along each axis of systematic errors: corner bias, a curled sheet, the lens


def covariance_of_outlines(covariance_rad2: Float) -> Float:
    """(2, 2) rad^2: a direction's covariance from that of its outlines alone, with the floor of systematic errors."""
    return np.asarray(covariance_rad2 + FLOOR_RAD**2 * np.eye(2))


def overdispersed(covariance_rad2: Float, unseen_end: Float | float, factor: float) -> Float:
    """(..., 2, 2) covariances of directions with the part of outlines `factor` times as large.

    The prior that a light is somewhere on the hemisphere, which they contain, is no error of outlines, and stays: what
    outlines leave open is not wider than that.

    unseen_end: (...) the share of the elevations' variances that comes from shadows' ends out of view, and stays.
    """
    by_outlines = np.sqrt(1 - np.asarray(unseen_end))
    axes = np.stack([np.ones_like(by_outlines), by_outlines], axis=-1)
    total = factor * covariance_rad2 * axes[..., :, None] * axes[..., None, :]
    total[..., 1, 1] += unseen_end * covariance_rad2[..., 1, 1]
    # The information of the prior that became `factor` times as small.
    prior = (1 - 1 / max(factor, 1.0)) * axes**2 / HEMISPHERE_RAD**2
    return np.asarray(np.linalg.solve(np.eye(2) + total * prior[..., None, :], total))


@dataclass(frozen=True, slots=True)
class Calibration:
    """How errors exceed what outlines alone imply, fitted by `ashe-live bench fit-judge` (docs/maths, (24))."""

    overdispersion: float  # factor on the outlines' covariance: errors of neighbouring borders are correlated
    doubt_rad: float  # sigma along each axis added to an answer of confidence 0
    doubt_power: float  # of the doubt 1 - confidence, by which that sigma falls

    def covariance(
        self, fitted: FittedLight, confidence: float, tracked: TrackedFrame, has_shape_errors: bool = False
    ) -> Float:
        """(2, 2) rad^2 on the direction's tangent basis, of all causes: outlines, pose, focal length, and doubt.

        confidence: the probability that the outlines are the object's and its shadow's. has_shape_errors: whether the
        outlines' part has in it how the marker's body and with it its pose may be off.
        """
        doubt = (self.doubt_rad * (1 - confidence) ** self.doubt_power) ** 2 * np.eye(2)
        by_pose = covariance_of_pose(fitted.to_light_marker, tracked, has_shape_errors)
        return np.asarray(self.of_outlines(fitted) + by_pose + doubt)

    def of_outlines(self, fitted: FittedLight) -> Float:
        """(2, 2) rad^2 on the direction's tangent basis, where the outlines are the object's and its shadow's."""
        return covariance_of_outlines(overdispersed(fitted.covariance_rad2, fitted.unseen_end, self.overdispersion))


def covariance_of_pose(to_light_marker: Float, tracked: TrackedFrame, has_shape_errors: bool = False) -> Float:
    """(2, 2) rad^2 on the tangent basis of a direction (3,): by the marker's rotation, and the focal length in it.

    has_shape_errors: as of `Calibration.covariance`.
    """
    marker = tracked.pose
    total = np.zeros((2, 2))
    if marker.covariance is not None:
        of_turn = marker.covariance[:3, :3]
        if has_shape_errors and marker.pose_shape_errors is not None:
            by_shape = marker.T_cam_marker[:3, :3] @ marker.pose_shape_errors.pose[:3]
            of_turn = of_turn - by_shape @ by_shape.T
        # A turn about the eastward axis moves a direction up, one about the upward axis moves it east.
        east, up = tangent_basis(to_light_marker) @ marker.T_cam_marker[:3, :3].T
        by_turn = np.array([up, -east])
        total = total + by_turn @ of_turn @ by_turn.T
    return np.asarray(0.5 * (total + total.T))
