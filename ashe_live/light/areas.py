"""Areas of a mask: connected, large, cleaned of specks, grown and filled."""

import cv2
import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.light.log_colour import Float32

SMOOTHING_PX = 0.8


def smoothed(values: Float32) -> Float32:
    return np.asarray(cv2.GaussianBlur(values, (0, 0), SMOOTHING_PX), dtype=np.float32)


def cleaned(mask: Mask) -> Mask:
    """Without specks and pinholes."""
    kernel = np.ones((3, 3), np.uint8)
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel)
    return cv2.morphologyEx(opened, cv2.MORPH_CLOSE, kernel).astype(bool)


def majority(mask: Mask, across_px: int = 3) -> Mask:
    """What most of a pixel's neighbours are: no specks, but thin strips survive."""
    return cv2.medianBlur(mask.astype(np.uint8), across_px).astype(bool)


def thick(mask: Mask, across_px: int) -> Mask:
    """The parts that are at least `across_px` wide."""
    return cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, _square(across_px)).astype(bool)


def large_areas(mask: Mask, least_px: int) -> Mask:
    """The connected areas of `mask` with at least `least_px` pixels."""
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    large = statistics[:, cv2.CC_STAT_AREA] >= least_px
    large[0] = False
    return np.asarray(large[labels], dtype=bool)


def areas_by_size(mask: Mask, least_px: int) -> list[Mask]:
    """The connected areas of `mask`, largest first."""
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    sizes = statistics[1:, cv2.CC_STAT_AREA]
    order = np.argsort(-sizes, kind="stable")
    return [labels == index + 1 for index in order if sizes[index] >= least_px]


def overlapping(mask: Mask, other: Mask, least_share: float) -> Mask:
    """The connected areas of `mask` of which more than `least_share` lies in `other`; `mask` itself if none does."""
    count, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    sizes, shared = (np.bincount(labels[each], minlength=count) for each in (mask, other & mask))
    kept = shared > least_share * sizes
    kept[0] = False
    return np.asarray(kept[labels], dtype=bool) if kept.any() else mask


def grown(mask: Mask, by_px: int) -> Mask:
    return cv2.dilate(mask.astype(np.uint8), _square(2 * by_px + 1)).astype(bool)


def shrunk(mask: Mask, by_px: int) -> Mask:
    return cv2.erode(mask.astype(np.uint8), _square(2 * by_px + 1)).astype(bool)


def filled(mask: Mask) -> Mask:
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    picture = np.zeros(mask.shape, np.uint8)
    cv2.drawContours(picture, outlines, -1, 1, cv2.FILLED)
    return picture.astype(bool)


def distance_to(mask: Mask) -> Float32:
    """(h, w) pixels to the nearest pixel of `mask`; far away where there is none."""
    if not mask.any():
        return np.full(mask.shape, 1e3, np.float32)
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 3), dtype=np.float32)


def _square(side_px: int) -> np.ndarray[tuple[int, int], np.dtype[np.uint8]]:
    return np.ones((side_px, side_px), np.uint8)
