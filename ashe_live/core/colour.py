"""sRGB and linear light. Everything computes in linear light and encodes once, last."""

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core.arrays import Float

REC709_LUMINANCE: Float = np.array([0.2126, 0.7152, 0.0722])


def linear_from_srgb(encoded: ArrayLike) -> Float:
    """Linear [0, 1] from sRGB [0, 1] of any shape (IEC 61966-2-1)."""
    value = np.asarray(encoded, dtype=np.float64)
    return np.where(value <= 0.04045, value / 12.92, ((np.maximum(value, 0.0) + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(linear: ArrayLike) -> Float:
    """sRGB [0, 1] from linear [0, 1] of any shape (IEC 61966-2-1)."""
    value = np.asarray(linear, dtype=np.float64)
    return np.where(value <= 0.0031308, value * 12.92, 1.055 * np.maximum(value, 0.0) ** (1 / 2.4) - 0.055)


LINEAR_FROM_SRGB_8BIT: Float = linear_from_srgb(np.arange(256) / 255)
