"""A picture of the empty table laid over the picture of the same table with an object on it.

A camera on a stand trembles, and its focus changes its focal length by a percent. Where it only turned, a homography
lays all of one picture over the other; where it moved too, one lays the marker's plane. It is found by the poses, then
by the pictures themselves (the enhanced correlation coefficient: Evangelidis and Psarakis, 2008).
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.transforms import image_from_plane
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.clean_plate.plain_ground import change_of_light, log_linear
from ashe_live.light.pixels.log_colour import is_exposed

WIDTH_PX = 320  # of the pictures that are compared
BLUR_PX = 1.0
# What is registered is log brightness without what changes over so many pixels, as light and shadow do.
SLOW_PX = 8.0
ROUNDS, LEAST_GAIN = 40, 1e-4
# In each of so many columns and rows of cells, of the plate's pixels those are edges that are steepest, and at least so
# steep (log brightness over a pixel, times 8). So many of all of them must have stayed as they are, to so much in log
# brightness. On 47 pictures 0.84 to 1.00 have (5th to 100th percentile), with a plate that is shifted by a pixel 0.16
# to 0.75 (5th to 95th).
CELLS, EDGES, STEEP = (8, 6), 0.05, 1.0
SAME, LEAST_SAME, CLEARLY_SAME, FEWEST_EDGES = 0.15, 0.7, 0.9, 40
# By so many of its sides, and a pixel, the marker's corners may lie beside where they were.
MOST_MOVED = 0.04


def registered(tracked: TrackedFrame, empty: TrackedFrame) -> Image | None:
    """The picture of the empty table as the clean plate (h, w, 3) of `tracked`; None if it shows another view.

    Both must have a marker, and in the same place. What the empty picture does not show is as in `tracked`, where
    nothing is then found.
    """
    if tracked.camera.size != empty.camera.size:
        return None
    now, before = np.asarray(tracked.frame.image_bgr), np.asarray(empty.frame.image_bgr)
    scale = min(1.0, WIDTH_PX / now.shape[1])
    small_now, small_before = _shrunk(now, scale), _shrunk(before, scale)
    still = same_share(small_now, small_before)
    by_poses = _scaled(_by_poses(tracked, empty), scale)
    moved = None if still >= CLEARLY_SAME else _refined(small_now, small_before, by_poses)
    turned = 0.0 if moved is None else same_share(small_now, _warped(small_before, moved, small_now))
    if max(still, turned) < LEAST_SAME:
        return None
    to_before = None if moved is None or still >= turned else _scaled(moved, 1 / scale)
    if _has_moved_marker(tracked, empty, np.eye(3) if to_before is None else to_before):
        return None
    return before if to_before is None else _warped(before, to_before, now)


def _has_moved_marker(tracked: TrackedFrame, empty: TrackedFrame, to_before: Float) -> bool:
    """Whether the marker lies elsewhere; to_before: (3, 3) from pixels of `tracked` to those of `empty`."""
    assert tracked.marker is not None
    assert empty.marker is not None
    there, corners = (np.asarray(each.marker.corners_px) for each in (tracked, empty) if each.marker is not None)
    mapped = np.column_stack([there, np.ones(len(there))]) @ to_before.T
    away_px = np.linalg.norm(mapped[:, :2] / mapped[:, 2:] - corners, axis=1)
    side_px = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).mean()
    return bool(away_px.mean() > MOST_MOVED * side_px + 1)


def same_share(image_bgr: Image, plate_bgr: Image) -> float:
    """The share of the plate's edges, all over it, that the picture, (h, w, 3) as well, shows as they are.

    0 where there are hardly any edges.
    """
    change = cv2.GaussianBlur(change_of_light(image_bgr, plate_bgr), (0, 0), BLUR_PX)
    difference = np.abs(np.asarray(change)).mean(axis=2)
    exposed = ~grown(~(is_exposed(image_bgr) & is_exposed(plate_bgr)), 1)
    brightness = cv2.GaussianBlur(log_linear(plate_bgr).mean(axis=2), (0, 0), BLUR_PX)
    across, down = (np.asarray(cv2.Sobel(brightness, cv2.CV_32F, *order)) for order in ((1, 0), (0, 1)))
    steepness = np.where(exposed, np.hypot(across, down), 0.0)
    results = [np.zeros(0, np.bool_)]
    for rows in np.array_split(np.arange(len(steepness)), CELLS[1]):
        for columns in np.array_split(np.arange(steepness.shape[1]), CELLS[0]):
            cell = np.ix_(rows, columns)
            if steepness[cell].size:
                is_edge = steepness[cell] > max(float(np.quantile(steepness[cell], 1 - EDGES)), STEEP)
                results.append(difference[cell][is_edge] < SAME)
    are_same = np.concatenate(results)
    return float(are_same.mean()) if len(are_same) >= FEWEST_EDGES else 0.0


def _by_poses(tracked: TrackedFrame, empty: TrackedFrame) -> Float:
    """(3, 3) from pixels of `tracked` to those of `empty`, of the marker's plane."""
    homographies = []
    for each in (tracked, empty):
        assert each.marker is not None
        homographies.append(image_from_plane(each.camera, each.marker.T_cam_marker))
    now, before = homographies
    return np.asarray(before @ np.linalg.inv(now))


def _refined(now: Image, before: Image, start: Float) -> Float | None:
    """The homography (3, 3) from pixels of `now` to those of `before` that correlates both best; None if none does."""
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, ROUNDS, LEAST_GAIN)
    first = np.asarray(start / start[2, 2], dtype=np.float32)
    try:
        _, found = cv2.findTransformECC(_detail(now), _detail(before), first, cv2.MOTION_HOMOGRAPHY, criteria)
    except cv2.error:  # they do not correlate
        return None
    moved = np.asarray(found, dtype=np.float64)
    return moved if np.isfinite(moved).all() else None


def _detail(image_bgr: Image) -> Float32:
    """(h, w) log brightness without its slow changes."""
    brightness = log_linear(image_bgr).mean(axis=2)
    return np.asarray(brightness - cv2.GaussianBlur(brightness, (0, 0), SLOW_PX), dtype=np.float32)


def _scaled(homography: Float, scale: float) -> Float:
    """A homography (3, 3) between pictures, for both scaled by `scale`; pixel centres are at whole numbers."""
    scaling = np.array([[scale, 0, (scale - 1) / 2], [0, scale, (scale - 1) / 2], [0, 0, 1]])
    return np.asarray(scaling @ homography @ np.linalg.inv(scaling))


def _warped(before: Image, homography: Float, now: Image) -> Image:
    """`before` as `now` sees it, by the homography from its pixels to those of `before`; and beyond, as it is now."""
    size = now.shape[1], now.shape[0]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    warped = cv2.warpPerspective(before, homography, size, flags=flags)
    seen = cv2.warpPerspective(np.full(before.shape[:2], 255, np.uint8), homography, size, flags=flags)
    is_seen: Mask = np.asarray(seen) == 255
    return np.where(is_seen[..., None], np.asarray(warped, np.uint8), now)


def _shrunk(image_bgr: Image, scale: float) -> Image:
    size = max(1, round(image_bgr.shape[1] * scale)), max(1, round(image_bgr.shape[0] * scale))
    return np.asarray(cv2.resize(image_bgr, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
