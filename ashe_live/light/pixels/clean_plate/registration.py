"""A picture of the empty table laid over the picture of the same table with an object on it.

A camera on a stand trembles, and its focus changes its focal length by a percent. Where it only turned, a homography
lays all of one picture over the other; where it moved too, one lays the marker's plane. It is found by the poses, then
by the pictures themselves (the enhanced correlation coefficient: Evangelidis and Psarakis, 2008). Pictures are taken as
they are: where a lens bends lines, only small motions can be undone.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.square import mean_side_px
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.clean_plate.plain_ground import change_of_light
from ashe_live.light.pixels.log_colour import is_exposed, log_linear
from ashe_live.light.pixels.sheet import MarkerPicture
from ashe_live.light.pixels.view import plane_homography, scaled_down

WIDTH_PX = 320  # of the pictures that are compared
BLUR_PX = 1.0  # standard deviation of the blur before edges are compared
# What is registered is log brightness without what changes over so many pixels, as light and shadow do.
SLOW_PX = 8.0
ROUNDS, LEAST_GAIN = 40, 1e-4  # of the registration (ECC): iterations, and gain of the correlation that ends it
# In each of so many columns and rows of cells the steepest share of the plate's pixels are edges, if they are at least
# so steep: by Sobel's operator, 8 times the change of log brightness over a pixel.
CELLS, EDGES, STEEP, FEWEST_EDGES = (8, 6), 0.05, 1.0, 40
# The largest change of an edge that counts as none, of log brightness; the share of edges without any that is asked
# for, and the one from which on nothing else is tried. Chosen by eye: on 47 pictures it is 0.84 to 1.00 (5th to 100th
# percentile), with a plate that is shifted by a pixel 0.16 to 0.75 (5th to 95th).
SAME, LEAST_SAME, CLEARLY_SAME = 0.15, 0.7, 0.9
# By so many of its sides, and a pixel, the marker's corners may lie beside where they were.
MOST_MOVED = 0.04


def registered(tracked: TrackedFrame, empty: TrackedFrame) -> Image | None:
    """The picture of the empty table as the clean plate (h, w, 3) of `tracked`; None if it shows another view.

    Both must have a marker, and in the same place. What the empty picture does not show is as in `tracked`, where
    nothing is then found.
    """
    if tracked.camera.size != empty.camera.size:
        return None
    now, before = _small(tracked), _small(empty)
    still = same_share(now.image_bgr, before.image_bgr)
    moved = None if still >= CLEARLY_SAME else _refined(now, before)
    turned = 0.0 if moved is None else same_share(now.image_bgr, _warped(before.image_bgr, moved, now.image_bgr))
    if max(still, turned) < LEAST_SAME:
        return None
    picture = np.asarray(empty.frame.image_bgr)
    if moved is None or still >= turned:
        return None if _has_moved_marker(tracked, empty, np.eye(3)) else picture
    to_before = _scaled(moved, np.divide(tracked.frame.size, now.camera.size))
    if _has_moved_marker(tracked, empty, to_before):
        return None
    return _warped(picture, to_before, np.asarray(tracked.frame.image_bgr))


def _small(tracked: TrackedFrame) -> MarkerPicture:
    """The frame's picture as it is compared, WIDTH_PX wide at most."""
    image, camera = scaled_down(np.asarray(tracked.frame.image_bgr), tracked.camera, WIDTH_PX)
    return MarkerPicture(image, camera, tracked.pose.T_cam_marker, tracked.pose.side_m)


def _has_moved_marker(tracked: TrackedFrame, empty: TrackedFrame, to_before: Float) -> bool:
    """Whether the marker lies elsewhere; to_before: (3, 3) from pixels of `tracked` to those of `empty`."""
    corners_px = np.array(empty.pose.corners_px)
    mapped_px = cv2.perspectiveTransform(np.array(tracked.pose.corners_px)[None], to_before)[0]
    away_px = np.linalg.norm(mapped_px - corners_px, axis=1).mean()
    return bool(away_px > MOST_MOVED * mean_side_px(corners_px) + 1)


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


def _refined(now: MarkerPicture, before: MarkerPicture) -> Float | None:
    """The homography (3, 3) from pixels of `now` to those of `before` that correlates both best; None if none does."""
    start = plane_homography(now, before)
    first = np.asarray(start / start[2, 2], dtype=np.float32)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, ROUNDS, LEAST_GAIN)
    details = _detail(now.image_bgr), _detail(before.image_bgr)
    try:
        _, found = cv2.findTransformECC(*details, first, cv2.MOTION_HOMOGRAPHY, criteria)
    except cv2.error:  # they do not correlate
        return None
    moved = np.asarray(found, dtype=np.float64)
    return moved if np.isfinite(moved).all() else None


def _detail(image_bgr: Image) -> Float32:
    """(h, w) log brightness without its slow changes."""
    brightness = log_linear(image_bgr).mean(axis=2)
    return np.asarray(brightness - cv2.GaussianBlur(brightness, (0, 0), SLOW_PX), dtype=np.float32)


def _scaled(homography: Float, scale: Float) -> Float:
    """A homography (3, 3) between pictures, for both scaled by (2,) along x and y; pixel centres are integers."""
    scaling = np.diag([*scale, 1.0])
    scaling[:2, 2] = (scale - 1) / 2
    return np.asarray(scaling @ homography @ np.linalg.inv(scaling))


def _warped(before: Image, homography: Float, now: Image) -> Image:
    """`before` as `now` sees it, by the homography from its pixels to those of `before`; and beyond, as it is now."""
    size = now.shape[1], now.shape[0]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    warped = cv2.warpPerspective(before, homography, size, flags=flags)
    seen = cv2.warpPerspective(np.full(before.shape[:2], 255, np.uint8), homography, size, flags=flags)
    is_seen: Mask = np.asarray(seen) == 255
    return np.where(is_seen[..., None], np.asarray(warped, np.uint8), now)
