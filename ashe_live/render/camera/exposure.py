"""How what is drawn follows the video's exposure: at once where it changes, and still where only its measurement does.

A camera that adapts to the light changes its exposure by several per cent a frame, and what lags behind it shows: a
covered sheet as a rectangle that is brighter or darker than the ground beside it.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted

# Standard deviation, of a logarithm, of an exposure that is measured in one frame by the paper or by ground beside it:
# 0.002 to 0.005 in green, over a rendered clip and one by a phone (by second differences over the frames; a study
# without a command).
NOISE = 0.004
GAIN_RANGE = 0.4, 2.5  # limits of the exposure of one frame over that of another
RIDGE = 0.03  # on the slope of brightness over the plane, times the points' mean squared distance from the marker
ROUNDS = 3  # of the least-squares fit, each without the outliers of the one before
OUTLIER = 0.3  # points whose brightness changed by more than this beside the median (a logarithm) are left out
FEWEST_POINTS = 30  # least number of points of the ground by which exposures are compared


def followed(shown: Float, measured: Float) -> Float:
    """(n,) logarithms of the exposure to show next, by those shown now and those measured in a new frame.

    They move by the share of the change that is likely to be one and not noise (Wiener's filter, the mean square of the
    change itself standing for its expectation).
    """
    change = measured - shown
    square = float(np.square(change).mean())
    return np.asarray(shown + square / (square + NOISE**2) * change)


def gain_and_slope(tracked: TrackedFrame, places: Float, before_rgb: Float) -> tuple[Float, Float] | None:
    """(3,) brightness of the ground over that in an earlier frame, linear RGB at the marker's centre; and (2,) how its
    logarithm changes over the plane (1/m), as a table's sheen moves with the camera.

    By places (n, 2) of the marker's plane, metres, and how they were seen before (n, 3), linear RGB; None where too few
    are in the frame, which must have a marker.
    """
    T_cam_marker = tracked.pose.T_cam_marker
    points = np.column_stack([places, np.zeros(len(places))])
    at = project_distorted(tracked.camera, T_cam_marker, points)
    inside = ((at > 1) & (at < np.array(tracked.frame.size) - 2)).all(axis=1)
    if inside.sum() < FEWEST_POINTS:
        return None
    x, y = at[inside].astype(np.float32).T
    seen = cv2.remap(tracked.frame.image_bgr, x, y, cv2.INTER_LINEAR).reshape(-1, 3)
    now, then = LINEAR_FROM_SRGB_8BIT[seen[:, ::-1]], before_rgb[inside]
    logs = np.log(now.sum(axis=1) + 1e-3) - np.log(then.sum(axis=1) + 1e-3)
    seen_at, slope = places[inside], np.zeros(2)
    ridge = RIDGE * np.square(places).sum(axis=1).mean() * np.eye(2)
    same = _near_middle(logs)
    for _ in range(ROUNDS):
        centred = seen_at[same] - seen_at[same].mean(axis=0)
        slope = np.linalg.solve(centred.T @ centred + len(centred) * ridge, centred.T @ logs[same])
        same = _near_middle(logs - seen_at @ slope)
    gain = now[same].mean(axis=0) / np.maximum(then[same].mean(axis=0), 1e-4)
    return np.asarray(np.clip(gain * np.exp(-slope @ seen_at[same].mean(axis=0)), *GAIN_RANGE)), np.asarray(slope)


def _near_middle(logs: Float) -> Mask:
    """(n,) which logarithms are no outliers: never none, as the lower of two middle ones counts, and not their mean."""
    middle = (len(logs) - 1) // 2
    return np.asarray(np.abs(logs - np.partition(logs, middle)[middle]) < OUTLIER)
