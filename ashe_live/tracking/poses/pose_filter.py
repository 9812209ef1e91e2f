"""Smooths the pose: holds it still while the marker rests, and follows at once when it moves.

A one-euro filter on SE(3) (Casiez, Roussel and Vogel, CHI 2012: the cutoff rises with the motion), in which motion is
measured in units of each pose's own covariance. The difference between measured and held pose is split along the
covariance's principal axes. A component within the `filter_gate` of the preset, in standard deviations, is noise, and
is followed slowly; the farther it is beyond, the faster. So the held pose lags by little more than the gate.
"""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import rigid
from ashe_live.tracking.preset import TrackingPreset

# A pose held for longer says nothing about the next one.
LONGEST_GAP_S = 0.5


class PoseFilter:
    """For one marker; feed it every measured pose in order."""

    def __init__(self, side_m: float) -> None:
        """side_m: the marker's."""
        # Radians become the metres that they move the marker's edge, so that the six axes can be compared.
        self._units = np.array([side_m / 2] * 3 + [1.0] * 3)
        self._held: Float | None = None
        self._time_s = 0.0

    def reset(self) -> None:
        """The next pose has nothing to do with the last one."""
        self._held = None

    def add(self, T_cam_marker: Float, covariance: Float, time_s: float, preset: TrackingPreset) -> Float:
        """The held pose (4, 4) after measuring `T_cam_marker` (4, 4) with its `covariance` (6, 6), as in MarkerPose."""
        elapsed_s = time_s - self._time_s
        if self._held is None or not 0 < elapsed_s <= LONGEST_GAP_S or preset.filter_rest_s <= 0:
            self._held, self._time_s = T_cam_marker, time_s
            return T_cam_marker
        units = self._units
        turn = cv2.Rodrigues(T_cam_marker[:3, :3] @ self._held[:3, :3].T)[0].ravel()
        difference = units * np.concatenate([turn, T_cam_marker[:3, 3] - self._held[:3, 3]])
        variances, axes = np.linalg.eigh(units[:, None] * covariance * units)
        parts = axes.T @ difference
        # How much of each squared part may be noise; in a direction that is known exactly, none is.
        noise_share = preset.filter_gate**2 * variances.clip(0) / np.maximum(parts**2, 1e-30)
        gains = np.maximum(1 - math.exp(-elapsed_s / preset.filter_rest_s), 1 - noise_share)
        step = (axes @ (gains * parts)) / units
        R = cv2.Rodrigues(step[:3])[0] @ self._held[:3, :3]
        # The product of many rotations drifts from being one.
        R = cv2.Rodrigues(cv2.Rodrigues(R)[0])[0]
        self._held, self._time_s = rigid(R, self._held[:3, 3] + step[3:]), time_s
        return self._held
