"""Areas of a mask (h, w), as all masks here are: connected, large, cleaned of specks, grown and filled."""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float32, Mask

SMOOTHING_PX = 0.8  # standard deviation
LEAST_OVERLAP = 0.3  # share of an area that must lie in what is predicted there for it to count as part of that


def smoothed(values: Float32) -> Float32:
    """(h, w) the values (h, w), blurred by a Gaussian of SMOOTHING_PX."""
    return np.asarray(cv2.GaussianBlur(values, (0, 0), SMOOTHING_PX), dtype=np.float32)


def cleaned(mask: Mask) -> Mask:
    """Morphologically opened, then closed: without specks and pinholes."""
    kernel = _square(3)
    opened = cv2.morphologyEx(_bytes(mask), cv2.MORPH_OPEN, kernel)
    return cv2.morphologyEx(opened, cv2.MORPH_CLOSE, kernel).view(np.bool_)


def majority(mask: Mask, across_px: int = 3) -> Mask:
    """The majority vote of each pixel's neighbourhood: removes specks, but keeps thin strips."""
    # On masks this equals a median filter, and is several times faster.
    counts = cv2.boxFilter(_bytes(mask), -1, (across_px, across_px), normalize=False, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(counts > across_px**2 // 2)


def thick(mask: Mask, across_px: int) -> Mask:
    """The parts that are at least `across_px` wide."""
    return cv2.morphologyEx(_bytes(mask), cv2.MORPH_OPEN, _square(across_px)).view(np.bool_)


def large_areas(mask: Mask, least_px: int) -> Mask:
    """The connected areas of `mask` with at least `least_px` pixels."""
    labels, sizes = labelled(mask, connectivity=8)
    return np.asarray((sizes >= max(least_px, 1)).take(labels))


def areas_by_size(mask: Mask, least_px: int) -> list[Mask]:
    """The connected areas of `mask` with at least `least_px` pixels, largest first."""
    labels, sizes = labelled(mask, connectivity=4)
    order = np.argsort(-sizes, kind="stable")
    return [labels == index for index in order if sizes[index] >= least_px]


def overlapping(mask: Mask, other: Mask, least_share: float = LEAST_OVERLAP) -> Mask:
    """The connected areas of `mask` with more than `least_share` of their pixels in `other`; all of `mask` if none."""
    labels, sizes = labelled(mask, connectivity=4)
    shared = np.bincount(labels[other & mask], minlength=len(sizes))
    kept = shared > least_share * sizes
    return np.asarray(kept.take(labels)) if kept.any() else mask


def grown(mask: Mask, by_px: int) -> Mask:
    """Dilated by a square of half side `by_px`."""
    return cv2.dilate(_bytes(mask), _square(2 * by_px + 1)).view(np.bool_)


def shrunk(mask: Mask, by_px: int) -> Mask:
    """Eroded by a square of half side `by_px`."""
    return cv2.erode(_bytes(mask), _square(2 * by_px + 1)).view(np.bool_)


def closed(mask: Mask, by_px: int) -> Mask:
    """With the gaps filled that are at most 2 `by_px` wide."""
    return cv2.morphologyEx(_bytes(mask), cv2.MORPH_CLOSE, _square(2 * by_px + 1)).view(np.bool_)


def filled(mask: Mask) -> Mask:
    """With its holes filled."""
    outlines, _ = cv2.findContours(_bytes(mask), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    picture = np.zeros(mask.shape, np.uint8)
    cv2.drawContours(picture, outlines, -1, 1, cv2.FILLED)
    return picture.view(np.bool_)


def resized(mask: Mask, size: tuple[int, int]) -> Mask:
    """Scaled to a size (width, height): of each pixel the nearest one's."""
    return cv2.resize(_bytes(mask), size, interpolation=cv2.INTER_NEAREST).view(np.bool_)


def distance_to(mask: Mask) -> Float32:
    """(h, w) distance in pixels to the nearest pixel of `mask`; 1000 everywhere if the mask is empty."""
    if not mask.any():
        return np.full(mask.shape, 1e3, np.float32)
    return np.asarray(cv2.distanceTransform(_bytes(~mask), cv2.DIST_L2, 3), dtype=np.float32)


def sampled(mask: Mask, most: int) -> NDArray[np.intp]:
    """Up to `most` flat indices of `mask`, chosen at random but always the same."""
    inside = np.flatnonzero(mask)
    return inside if len(inside) <= most else np.sort(np.random.default_rng(0).choice(inside, most, replace=False))


def mean_nearby(values: Float32, mask: Mask, within_px: int) -> Float32:
    """(h, w, ...) mean of such values over the `mask` (h, w) in a square of half side `within_px` around each pixel.

    0 where none of it is there.
    """
    size = 2 * within_px + 1, 2 * within_px + 1
    total, count = (
        cv2.boxFilter(each, -1, size, normalize=False, borderType=cv2.BORDER_CONSTANT)
        for each in (cv2.copyTo(values, _bytes(mask)), mask.astype(np.float32))
    )
    return np.asarray((total.T / np.maximum(count, 1).T).T, dtype=np.float32)  # of each channel


def window_around(mask: Mask, margin_px: int) -> tuple[slice, slice]:
    """Rows and columns of the bounding box of `mask`, widened by `margin_px`, clipped to the picture."""
    x, y, across, down = cv2.boundingRect(_bytes(mask))
    return (
        slice(max(0, y - margin_px), min(mask.shape[0], y + down + margin_px)),
        slice(max(0, x - margin_px), min(mask.shape[1], x + across + margin_px)),
    )


def labelled(mask: Mask, connectivity: int) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """(h, w) label of each pixel's connected area, 0 outside of `mask`; (n,) the areas' pixel counts, 0 for label 0."""
    count, found = cv2.connectedComponents(_bytes(mask), connectivity=connectivity)
    labels = np.asarray(found, dtype=np.int32)
    return labels, np.bincount(labels[mask], minlength=count)


def _bytes(mask: Mask) -> NDArray[np.uint8]:
    """The mask as OpenCV takes it, 0 or 1, without a copy."""
    return np.ascontiguousarray(mask).view(np.uint8)


@cache
def _square(side_px: int) -> NDArray[np.uint8]:
    return np.ones((side_px, side_px), np.uint8)
