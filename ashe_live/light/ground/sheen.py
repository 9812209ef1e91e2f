"""Sheen: ground made brighter by specular reflection or by light from a sunlit object, not to be taken for an object.

Sheen fades smoothly into normally lit ground, whereas an object has a sharp edge all around.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float32, Mask
from ashe_live.light.pixels.areas import areas_by_size, cleaned, grown, labelled
from ashe_live.light.pixels.mixtures import Mixture, nearest_centres

BLUR_PX = 1.0  # of brightness, before its slope is taken
STEEPEST = 0.05  # change of log brightness per pixel
BRIGHTER = 0.03  # least excess in log brightness over the ground's nearest colour
BRIGHT_DISTANCE = 5.0  # least squared Mahalanobis distance to the ground's palette
LEAST_PX = 30  # of a sheen
LEAST_SHARE = 0.02  # least area of even lit ground that a sheen adjoins, as a fraction of the picture
LIT_SHARE_AROUND = 0.45  # least fraction of lit ground along a sheen's border


def sheen_on(colours: Float32, squared_distance: Float32, is_ground: Mask, palette: Mixture) -> Mask:
    """(h, w) ground that differs from the palette only by being brighter, with a smooth transition.

    colours: (h, w, 3) log-opponent. squared_distance: (h, w) that to the palette's nearest colour, smoothed.
    """
    brightness = np.asarray(cv2.GaussianBlur(colours[..., 0], (0, 0), BLUR_PX), dtype=np.float32)
    even = is_ground & (slope_of(brightness) < STEEPEST)
    lit = is_ground & (squared_distance <= BRIGHT_DISTANCE)
    bright = even & (squared_distance > BRIGHT_DISTANCE)
    candidates = brightness[bright]
    bright[bright] = candidates > palette.centres[nearest_centres(colours[bright], palette.centres), 0] + BRIGHTER
    sheen = np.zeros_like(is_ground)
    if np.count_nonzero(bright) < LEAST_PX:
        return sheen
    labels, sizes = labelled(even & (lit | bright), 4)
    begins = np.bincount(labels[even & lit], minlength=len(sizes)) > LEAST_SHARE * is_ground.size
    begins[0] = False
    for area in areas_by_size(cleaned(bright & begins[labels]) & is_ground, LEAST_PX):
        beside = grown(area, 2) & ~grown(area, 1) & is_ground
        if np.count_nonzero(beside & lit) > LIT_SHARE_AROUND * np.count_nonzero(beside):
            sheen |= area
    return sheen


def slope_of(brightness: Float32) -> Float32:
    """(h, w) the magnitude of the gradient, per pixel, of a blurred picture (h, w)."""
    by_axis = [cv2.Sobel(brightness, cv2.CV_32F, dx, 1 - dx, scale=1 / 8) for dx in (0, 1)]
    return np.asarray(cv2.magnitude(*by_axis), dtype=np.float32)


def without_sheen(colours: Float32, sheen: Mask, palette: Mixture) -> Float32:
    """(h, w, 3) the colours (h, w, 3), replaced in `sheen` by the palette's nearest ones."""
    dull = colours.copy()
    dull[sheen] = palette.centres[nearest_centres(colours[sheen], palette.centres)]
    return dull
