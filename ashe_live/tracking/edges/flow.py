"""Where the marker's corners went while nobody can read it: optical flow of them and of the paper around.

Lucas and Kanade's method in a pyramid; a point counts when following it back returns to where it came from.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import scaled_pixels
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.squares import is_front_of_square, region_around

Points = NDArray[np.integer[Any] | np.floating[Any]]  # (n, 1, 2), as OpenCV has them

MARGIN_RATIO = 0.5
# A larger marker is scaled down to this size.
WORKING_PX = 160.0
MAX_POINTS, MIN_POINTS = 40, 5
WINDOW, LEVELS = (15, 15), 3
MAX_RETURN_PX = 0.7
# Least share of the points that agree on one motion. It is below a half, as a reflection may hide the rest.
MIN_AGREEING = 0.25
# Points that agree on an affine motion over those on a similarity, from which the former is taken.
MORE_AGREEING = 1.2
# Largest change of a side between two frames, as a logarithm.
MAX_GROWTH = 0.15
# Points on the paper around the square are used as well, up to this size over the square's.
PAPER = 1.4


def flowed_corners(before_bgr: Image, now_bgr: Image, corners_px: Float) -> Float | None:
    """Where `corners_px` (4, 2) of `before_bgr` are in `now_bgr`, both (h, w, 3); None when that is unclear."""
    region = region_around(corners_px, 8, MARGIN_RATIO, before_bgr.shape)
    if region is None or before_bgr.shape != now_bgr.shape:
        return None
    (left, top), (right, bottom) = region
    if min(right - left, bottom - top) < 2 * WINDOW[0]:
        return None
    scale = min(1.0, WORKING_PX / max(np.ptp(corners_px, axis=0)))
    before, now = (_grey(image[top:bottom, left:right], scale) for image in (before_bgr, now_bgr))
    inside = scaled_pixels(corners_px - (left, top), scale)
    mask = np.zeros(before.shape, dtype=np.uint8)
    paper = inside.mean(axis=0) + PAPER * (inside - inside.mean(axis=0))
    cv2.fillConvexPoly(mask, np.round(paper).astype(np.int32), 255)
    found = cv2.goodFeaturesToTrack(before, MAX_POINTS, 0.02, 3, mask=mask)
    own = inside.astype(np.float32)[:, None]
    found = own if found is None else np.concatenate([own, found])
    there, good = _followed(before, now, found)
    if good.sum() < max(MIN_POINTS, MIN_AGREEING * len(found)):
        return None
    motion, agreeing = _common_motion(found[good], there[good])
    if motion is None or agreeing < MIN_AGREEING * len(found):
        return None
    moved = inside @ motion[:, :2].T + motion[:, 2]
    corners = np.add(scaled_pixels(moved, 1 / scale), (left, top))
    growth = side_lengths_px(corners) / side_lengths_px(corners_px)
    return corners if is_front_of_square(corners) and np.abs(np.log(growth)).max() < MAX_GROWTH else None


def _followed(before: Image, now: Image, points: Points) -> tuple[Points, Mask]:
    """Where points (n, 1, 2) went, and (n,) which of them return to their place when they are followed back."""
    there, is_there, _ = cv2.calcOpticalFlowPyrLK(before, now, points, points.copy(), winSize=WINDOW, maxLevel=LEVELS)
    back, is_back, _ = cv2.calcOpticalFlowPyrLK(now, before, there, there.copy(), winSize=WINDOW, maxLevel=LEVELS)
    returns = np.linalg.norm((back - points).reshape(-1, 2), axis=1) <= MAX_RETURN_PX
    return there, np.asarray((is_there.ravel() > 0) & (is_back.ravel() > 0) & returns)


def _common_motion(before: Points, after: Points) -> tuple[Float | None, int]:
    """(2, 3) the motion on which most points (n, 1, 2) agree, None if there is none, and how many do.

    Between two frames the change of perspective is smaller than the flow's own error: affine is enough, and where it
    explains hardly more points than a similarity does, these are some on a hand that moves before the marker.
    """
    motion, agreeing = cv2.estimateAffinePartial2D(before, after, ransacReprojThreshold=1.0)
    sheared, more = cv2.estimateAffine2D(before, after, ransacReprojThreshold=1.0)
    if sheared is not None and more.sum() > MORE_AGREEING * agreeing.sum():
        motion, agreeing = sheared, more
    return (None, 0) if motion is None else (np.asarray(motion, np.float64), int(agreeing.sum()))


def _grey(image_bgr: Image, scale: float) -> Image:
    grey = cv2.cvtColor(image_bgr, cv2.COLOR_BGR2GRAY)
    if scale < 1:
        grey = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return np.asarray(grey, dtype=np.uint8)
