"""Means of what is known of a picture, around each pixel; and from which shares on a reduced picture's pixels count."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float32

# A pixel of a reduced picture is known from the first share of known pixels in it on, and in a hole from the second on.
KNOWN_FROM, HOLE_FROM = 0.98, 0.02


def blurred_within(picture: Float32, weight: Float32, sigma_px: float) -> Float32:
    """(n, n, 3) the means of what has weight (n, n), by a Gaussian; 0 where nothing has any around."""
    sums, share = (cv2.GaussianBlur(each, (0, 0), sigma_px) for each in (picture * weight[..., None], weight))
    return np.asarray(sums / np.maximum(share, 1e-6)[..., None], np.float32)
