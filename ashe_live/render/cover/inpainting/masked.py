"""Pictures of which only a part is known: their means, at their own size and reduced, and what lies around it."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float32, Mask

# A pixel of a reduced picture is known from the first share of known pixels in it on, and in a hole from the second on.
KNOWN_FROM, HOLE_FROM = 0.98, 0.02
Box = tuple[slice, slice]  # rows and columns


def reduced(picture: Float32 | Mask, size: int) -> Float32:
    """(size, size[, 3]) the means of a square picture's pixels; of a mask the shares."""
    return np.asarray(cv2.resize(picture.astype(np.float32), (size, size), interpolation=cv2.INTER_AREA), np.float32)


def blurred_within(picture: Float32, weight: Float32, sigma_px: float) -> Float32:
    """(n, n, 3) the means of what has weight (n, n), by a Gaussian; 0 where nothing has any around."""
    sums, share = (cv2.GaussianBlur(each, (0, 0), sigma_px) for each in (picture * weight[..., None], weight))
    return np.asarray(sums / np.maximum(share, 1e-6)[..., None], np.float32)


def mean_around(picture: Float32, trusted: Mask, sigma: float) -> Float32:
    """(n, n, 3) the means of what is trusted (n, n), by a Gaussian, from a quarter of the resolution."""
    weight = trusted.astype(np.float32)
    sums, share = (
        cv2.GaussianBlur(reduced(each, len(weight) // 4), (0, 0), sigma / 4)
        for each in (picture * weight[..., None], weight)
    )
    means = sums / np.maximum(share, 1e-6)[..., None]
    return np.asarray(cv2.resize(means, weight.shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)


def distances_from(mask: Mask) -> Float32:
    """(n, n) pixels from each pixel to the nearest one of the mask: 0 within it."""
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5), np.float32)


def box_around(mask: Mask, beside_px: int) -> Box:
    """The rectangle around a mask (n, n), and so many pixels more, as far as the picture goes."""
    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    return (
        slice(max(0, top - beside_px), min(len(mask), top + height + beside_px)),
        slice(max(0, left - beside_px), min(len(mask), left + width + beside_px)),
    )
