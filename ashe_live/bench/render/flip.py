"""LDR-FLIP, the difference that a person sees when flipping between two pictures: 0 none, 1 green for blue.

Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild, "FLIP: a difference evaluator for alternating
images", Proc. ACM Computer Graphics and Interactive Techniques 2020; all constants are theirs.
"""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT

PIXELS_PER_DEGREE = 67.0  # a display of 0.7 m width and 3840 pixels, seen from 0.7 m
XYZ_FROM_RGB = np.array([
    [0.41238656, 0.35759149, 0.18045049], [0.21263682, 0.71518298, 0.07218020], [0.01933062, 0.11919716, 0.95037259],
])  # fmt: skip
WHITE = XYZ_FROM_RGB.sum(axis=1)
# Contrast sensitivity of the achromatic, red-green and blue-yellow channels: two Gaussians each, (a, b).
SENSITIVITY = (((1.0, 0.0047), (0.0, 1e-5)), ((1.0, 0.0053), (0.0, 1e-5)), ((34.1, 0.04), (13.5, 0.025)))
COLOUR_POWER, COLOUR_KNEE, COLOUR_SHARE = 0.7, 0.4, 0.95
FEATURE_POWER, FEATURE_DEG = 0.5, 0.082


def flip_error(a_bgr: Image, b_bgr: Image) -> Float:
    """(h, w) the FLIP error of two pictures (h, w, 3) uint8 sRGB."""
    a, b = (_opponent(LINEAR_FROM_SRGB_8BIT[each[..., ::-1]]) for each in (a_bgr, b_bgr))
    feature = _feature_difference(a[..., 0], b[..., 0])
    return np.asarray(_colour_difference(a, b) ** (1 - feature))


def _colour_difference(a: Float, b: Float) -> Float:
    labs = [_hunt(_lab(np.clip(_linear(_filtered(each)), 0, 1))) for each in (a, b)]
    green, blue = (_hunt(_lab(np.array(colour, dtype=np.float64))) for colour in ((0, 1, 0), (0, 0, 1)))
    largest = float(_hyab(green, blue)) ** COLOUR_POWER
    difference = _hyab(labs[0], labs[1]) ** COLOUR_POWER
    knee = COLOUR_KNEE * largest
    beyond = COLOUR_SHARE + (difference - knee) / (largest - knee) * (1 - COLOUR_SHARE)
    return np.asarray(np.where(difference < knee, COLOUR_SHARE / knee * difference, beyond))


def _filtered(opponent: Float) -> Float:
    widest = max(b for gaussians in SENSITIVITY for _, b in gaussians)
    radius = math.ceil(3 * math.sqrt(widest / (2 * math.pi**2)) * PIXELS_PER_DEGREE)
    at = np.arange(-radius, radius + 1) / PIXELS_PER_DEGREE
    square = at[:, None] ** 2 + at**2
    channels = []
    for number, gaussians in enumerate(SENSITIVITY):
        kernel = sum(a * math.sqrt(math.pi / b) * np.exp(-(math.pi**2) * square / b) for a, b in gaussians)
        kernel = np.asarray(kernel / np.sum(kernel))
        channels.append(cv2.filter2D(opponent[..., number], -1, kernel, borderType=cv2.BORDER_REPLICATE))
    return np.stack(channels, axis=-1)


def _feature_difference(a: Float, b: Float) -> Float:
    deviation = 0.5 * FEATURE_DEG * PIXELS_PER_DEGREE
    radius = math.ceil(3 * deviation)
    x = np.arange(-radius, radius + 1, dtype=np.float64)
    gauss = np.exp(-(x[:, None] ** 2 + x**2) / (2 * deviation**2))
    found = []
    for kernel in (-x * gauss, (x**2 / deviation**2 - 1) * gauss):
        signed = np.where(kernel > 0, kernel / kernel[kernel > 0].sum(), kernel / -kernel[kernel < 0].sum())
        sizes = []
        for channel in (a, b):
            luminance = (channel + 16) / 116
            parts = [cv2.filter2D(luminance, -1, each, borderType=cv2.BORDER_REPLICATE) for each in (signed, signed.T)]
            sizes.append(np.hypot(*parts))
        found.append(np.abs(sizes[0] - sizes[1]))
    return np.asarray((np.maximum(*found) / math.sqrt(2)) ** FEATURE_POWER)


def _opponent(linear: Float) -> Float:
    """(..., 3) YCxCz, a linear opponent space, of linear RGB."""
    x, y, z = np.moveaxis(linear @ XYZ_FROM_RGB.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _linear(opponent: Float) -> Float:
    luminance, cx, cz = np.moveaxis(opponent, -1, 0)
    y = (luminance + 16) / 116
    return np.asarray(np.stack([y + cx / 500, y, y - cz / 200], axis=-1) * WHITE @ np.linalg.inv(XYZ_FROM_RGB).T)


def _lab(linear: Float) -> Float:
    relative = linear @ XYZ_FROM_RGB.T / WHITE
    delta = 6 / 29
    bent = np.where(relative > delta**3, np.cbrt(relative), relative / (3 * delta**2) + 4 / 29)
    x, y, z = np.moveaxis(bent, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _hunt(lab: Float) -> Float:
    """Hunt's adjustment: chroma scaled by lightness, as it is perceived."""
    return np.concatenate([lab[..., :1], 0.01 * lab[..., :1] * lab[..., 1:]], axis=-1)


def _hyab(a: Float, b: Float) -> Float:
    return np.asarray(np.abs(a[..., 0] - b[..., 0]) + np.hypot(a[..., 1] - b[..., 1], a[..., 2] - b[..., 2]))
