"""Log-opponent colours: logs of linear light, brightness separated from chroma.

In them a shadow is the same shift for every colour of the ground.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Image, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT

# Added to linear light before the log: the level below which 8-bit values are indistinguishable from black.
DARKEST = 0.004
SATURATED = 250  # value of the brightest channel from which on a camera's response curve may be saturated
# Chroma varies less than brightness does, and is more discriminative.
CHROMA_WEIGHT = 1.2
# Rows: brightness, red over blue, red and blue over green; columns: logs of red, green, blue.
OPPONENT = np.array([(1 / 3, 1 / 3, 1 / 3), (CHROMA_WEIGHT, 0, -CHROMA_WEIGHT), CHROMA_WEIGHT * np.array((1, -2, 1))])
FROM_OPPONENT = np.linalg.inv(OPPONENT)


def is_exposed(image_bgr: Image) -> Mask:
    """(h, w) the pixels of a picture (h, w, 3) that are not saturated."""
    return np.asarray(cv2.inRange(image_bgr, (0, 0, 0), (SATURATED - 1,) * 3) > 0)


def log_opponent(image_bgr: Image, smoothing_px: float = 0.7) -> Float32:
    """(h, w, 3) log brightness, log red over blue, log of red and blue over green, of an sRGB picture (h, w, 3).

    The picture is blurred first by a Gaussian of `smoothing_px`.
    """
    smooth = cv2.GaussianBlur(image_bgr, (0, 0), smoothing_px) if smoothing_px > 0 else image_bgr
    return np.asarray(cv2.transform(log_linear(np.asarray(smooth)), OPPONENT[:, ::-1]), dtype=np.float32)


def log_linear(image_bgr: Image) -> Float32:
    """(h, w, 3) log of the linear light of an sRGB picture (h, w, 3), with DARKEST added to it."""
    return np.asarray(cv2.LUT(image_bgr, np.log(LINEAR_FROM_SRGB_8BIT + DARKEST).astype(np.float32)), dtype=np.float32)


def log_opponent_of_linear(rgb: Float) -> Float:
    """(..., 3) log-opponent colours of linear RGB."""
    return np.asarray(np.log(rgb + DARKEST) @ OPPONENT.T, dtype=np.float64)


def linear_rgb(log_opponent_colours: Float | Float32) -> Float:
    """(..., 3) linear RGB of log-opponent colours: the inverse of `log_opponent_of_linear`."""
    return np.asarray(np.exp(log_opponent_colours @ FROM_OPPONENT.T) - DARKEST, dtype=np.float64)
