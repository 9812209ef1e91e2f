"""A table's texture: on gravel and prints single pixels say little about the light, and means of a few say more."""

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Float32, Mask, upper_median

AROUND_PX = 5  # width of the squares over which light is averaged
# Robust scatter of pixels around these means, over the lit table's light, from which on a table is rough: of 42
# path-traced pictures those of gravel have 0.09 to 0.27, of a print in two tones 0.08 to 0.10, others 0.07 at most, and
# painted stripes and checks of more than a centimetre 0.08, which blur would only widen. And one of so many
# rows is measured.
ROUGH, EVERY = 0.085, 20
# Standard deviation of the blur in which edges are looked for on a rough table: with twice as much cloudy skies on
# gravel seem to have edges, too.
SMOOTH_PX = 1.5
LEAST_SHARE = 1e-3  # of ground around what is ground, beside rounding


def without_texture(light: Float32, is_ground: Mask, lit: float) -> tuple[Float32, Float32]:
    """(h, w) the `light` (h, w) of a rough table averaged over what is ground, and (h, w) its means around each pixel.

    Of a smooth one both are its light as it is. lit: the lit table's light.
    """
    if _scatter(light, is_ground) <= ROUGH * lit:
        return light, light
    share = is_ground.astype(np.float32)
    total, count = (cv2.GaussianBlur(each, (0, 0), SMOOTH_PX) for each in (light * share, share))
    smooth = np.where(is_ground, total / np.maximum(count, LEAST_SHARE), light).astype(np.float32)
    return smooth, _means(smooth)


def _means(light: Float32) -> Float32:
    return np.asarray(cv2.blur(light, (AROUND_PX, AROUND_PX)), dtype=np.float32)


def _scatter(light: Float32, is_ground: Mask) -> float:
    """Standard deviation of the ground's light around its means, robust; 0 without ground."""
    height, width = light.shape
    strips = light[: height - height % EVERY].reshape(-1, EVERY, width)[:, :AROUND_PX]
    means = cv2.blur(strips.mean(axis=1), (AROUND_PX, 1))
    away = np.abs(strips[:, AROUND_PX // 2] - means)[is_ground[AROUND_PX // 2 :: EVERY][: len(strips)]]
    return SIGMA_OVER_MAD * upper_median(away) if len(away) else 0.0
