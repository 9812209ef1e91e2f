"""How wide borders of shadows are in a picture: the distance over which brightness passes from 10 to 90 %."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, REC709_LUMINANCE

REACH_PX, STEP_PX = 9.0, 0.1  # how far a profile reaches to both sides of a border, and between its samples
END_PX = 2.0  # length of each end of a profile, whose median is the level there
TOGETHER = 8  # neighbouring profiles that are averaged once their middles are aligned
LEAST_STEP = 0.15  # least difference of the levels, over that of the lit side, in a border worth measuring
LEAST_STEP_LINEAR = 0.02  # the same in linear light: smaller ones drown in noise
MOST_SLOPE = 0.15  # most change within an end, over that difference: more means that something else lies there


def border_widths(image_bgr: Image, places_px: Float, outward_px: Float, scale: float = 1.0) -> Float:
    """(n,) widths in pixels across borders through (n, 2) `places_px` of (h, w, 3) uint8; NaN where there is none.

    outward_px: (n, 2) unit vectors from shadow to light. scale: of the profiles' reach, in large pictures. Neighbours
    in the list stand for one another: each width is that of the mean of up to TOGETHER profiles around it.
    """
    offsets = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    # By tables of each channel's contribution: a matrix product over the linear picture takes far longer.
    tables = (LINEAR_FROM_SRGB_8BIT * REC709_LUMINANCE[::-1, None]).astype(np.float32)
    blue, green, red = map(cv2.LUT, cv2.split(image_bgr), tables)
    linear = blue + green + red
    at = (places_px[:, None] + scale * offsets[:, None] * outward_px[:, None]).astype(np.float32)
    profiles = cv2.remap(linear, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    inside = ((at > 1) & (at < np.array(image_bgr.shape[1::-1]) - 2)).all(axis=(1, 2))
    ends = round(END_PX / STEP_PX)
    dark, lit = np.median(profiles[:, :ends], axis=1), np.median(profiles[:, -ends:], axis=1)
    step = lit - dark
    good = inside & (step > LEAST_STEP * lit) & (step > LEAST_STEP_LINEAR)
    steps = (profiles - dark[:, None]) / np.where(good, step, 1.0)[:, None]
    good &= np.abs(steps[:, :ends]).max(axis=1) < MOST_SLOPE
    good &= np.abs(steps[:, -ends:] - 1).max(axis=1) < MOST_SLOPE
    middles = np.abs(steps - 0.5).argmin(axis=1)
    half = len(offsets) // 2
    good &= np.abs(middles - half) < half // 2
    widths = np.full(len(places_px), np.nan)
    reach = half // 2
    for k in np.flatnonzero(good).tolist():
        near = np.arange(max(0, k - TOGETHER // 2), min(len(good), k + TOGETHER // 2 + 1))
        near = near[good[near]]
        mean = np.mean([steps[j, middles[j] - reach : middles[j] + reach + 1] for j in near], axis=0)
        widths[k] = scale * _rise(mean)
    return widths


def _rise(profile: Float) -> float:
    """Distance in pixels between the first places that are 10 and 90 % of a rising profile."""
    middle = len(profile) // 2
    below = np.flatnonzero(profile[: middle + 1] < 0.1)
    above = np.flatnonzero(profile[middle:] > 0.9)
    if not len(below) or not len(above):
        return float("nan")
    return float(above[0] + middle - below[-1]) * STEP_PX
