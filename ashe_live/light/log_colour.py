"""Logs of linear light, brightness apart from chroma: colours in which a shadow is a shift, whatever it falls on."""

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT

Float32 = NDArray[np.float32]

# Added to linear light before the log: what an 8-bit picture cannot tell from black.
DARKEST = 0.004
# Chroma differs less than brightness does, and says more.
CHROMA_WEIGHT = 1.2


def log_opponent(image_bgr: Image, smoothing_px: float = 0.7) -> Float32:
    """(h, w, 3): log brightness, log red over blue, log of red and blue over green, from linear light."""
    smooth = cv2.GaussianBlur(image_bgr, (0, 0), smoothing_px) if smoothing_px > 0 else image_bgr
    table = np.log(LINEAR_FROM_SRGB_8BIT + DARKEST).astype(np.float32)
    return np.asarray(_opponent(table[smooth][:, :, ::-1]), dtype=np.float32)


def log_opponent_of_linear(rgb: Float) -> Float:
    """(..., 3) log-opponent colours of linear RGB."""
    return np.asarray(_opponent(np.log(rgb + DARKEST)), dtype=np.float64)


def _opponent(logs_rgb: Float | Float32) -> Float | Float32:
    red, green, blue = np.moveaxis(logs_rgb, -1, 0)
    brightness = (red + green + blue) / 3
    return np.stack([brightness, CHROMA_WEIGHT * (red - blue), CHROMA_WEIGHT * (red + blue - 2 * green)], axis=-1)


def linear_rgb(log_opponent_colours: Float | Float32) -> Float:
    """(..., 3) linear RGB of log-opponent colours: the inverse of `log_opponent`."""
    brightness, red_blue, green = np.moveaxis(np.asarray(log_opponent_colours, dtype=np.float64), -1, 0)
    log_green = brightness - green / CHROMA_WEIGHT / 3
    red_and_blue = 3 * brightness - log_green
    difference = red_blue / CHROMA_WEIGHT
    logs = np.stack([(red_and_blue + difference) / 2, log_green, (red_and_blue - difference) / 2], axis=-1)
    return np.asarray(np.exp(logs) - DARKEST)
