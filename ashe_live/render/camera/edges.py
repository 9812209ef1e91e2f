"""Measures a picture's sharpness at edges whose places are known, such as those of the marker's square."""

import math
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, linear_from_srgb, srgb_from_linear
from ashe_live.core.square import along_sides, side_lengths_px
from ashe_live.render.camera.white import OVEREXPOSED

AROUND = 12  # places along each of a polygon's edges
REACH_PX, STEP_PX = 7.0, 0.25  # of a profile across an edge, to both sides
MIDDLE_PX = 2.0  # the edge must be within this distance of the profile's middle
BORDER_SIDES = 0.11  # least width of the square's black border, and as a rule of the paper around it, over its side
LEAST_REACH_PX = 4.0
BLUR_RANGE_PX = (0.0, 3.0)
BOX_VARIANCE_PX2 = 1 / 12  # variance of a box of one pixel, by which the model's own pixels are blurred as well
INTERPOLATION_VARIANCE_PX2 = 1 / 6  # of bilinear sampling, on average
LEAST_HEIGHT = 0.05  # least height of an edge, linear
RATIO_ERROR = 0.35  # largest error of the logarithm of an edge's ratio
BLURS_PX = np.arange(0.0, 2.6, 0.1)  # sigmas that are tried on a sharpened edge
SHARPENING_SIGMA_PX = 1.0  # sigma assumed of the blur in a camera's unsharp masking
MOST_SHARPENING = 2.0
# Least over- and undershoot together, over an edge's height, for sharpening to be measured: a soft edge that was
# sharpened a little without them looks like a less soft edge. Noise and uneven paper make up to half of it.
LEAST_OVERSHOOT = 0.05


def edge_blur_px(grey: Image, corners_px: Float, paper: float = 0.0) -> float:
    """Sigma of the blur, in pixels, of (h, w) uint8 at the border of a dark convex polygon (k, 2).

    0 if unknown, and at most 3: wider blurs do not fit into the profiles. `paper`: linear brightness around the
    polygon, where it may be more than the picture can show.
    """
    profile = _profile(grey, corners_px, REACH_PX)
    return 0.0 if profile is None else blur_of_step_px(profile.step, profile.height(paper))


def blur_and_sharpening(grey: Image, corners_px: Float, paper: float = 0.0) -> tuple[float, float]:
    """Sigma of the blur, in pixels, and how much was sharpened then, of (h, w) uint8 at the black square (4, 2).

    A camera blurs linear light and sharpens encoded values e by adding s (e - blurred e), which over- and undershoots
    beside an edge. Blurs are tried, each with the s of least squares. `paper`: as of `edge_blur_px`.
    """
    reach_px = float(np.clip(BORDER_SIDES * side_lengths_px(corners_px).min(), LEAST_REACH_PX, REACH_PX))
    profile = _profile(grey, corners_px, reach_px)
    if profile is None:
        return 0.0, 0.0
    sigma_px = blur_of_step_px(profile.step, profile.height(paper))
    seen = profile.encoded
    if np.ptp(seen) - (profile.light - profile.dark) < LEAST_OVERSHOOT * (profile.light - profile.dark):
        return sigma_px, 0.0
    edges = _blurred_steps(profile, len(seen))
    detail = edges - _smooth(edges, SHARPENING_SIGMA_PX / STEP_PX)
    missing = seen - edges
    amount = (missing * detail).sum(axis=1) / np.maximum(np.square(detail).sum(axis=1), 1e-12)
    amount = np.clip(amount, 0.0, MOST_SHARPENING)
    best = int(np.square(missing - amount[:, None] * detail).sum(axis=1).argmin())
    return float(BLURS_PX[best]), float(amount[best])


class Profile(NamedTuple):
    """A profile across an edge, which is in its middle, from dark to light."""

    step: Float  # (k,) linear, from 0 in the dark to 1 in the light; the mean of many
    encoded: Float  # (k,) as in the picture, in [0, 1]; the median of many, as shadows may cross some
    dark: float  # encoded, and so
    light: float
    used: NDArray[np.intp]  # (m,) indices of the places that it was measured at

    def height(self, paper: float) -> float:
        """Of the edge before the picture clipped it, over the part that it shows; 1 where its paper is not overexposed.

        The brightness of shaded paper is its own, however bright the rest is.
        """
        dark, light = (float(value) for value in linear_from_srgb([self.dark, self.light]))
        low, high = OVEREXPOSED
        share = min(max((light - low) / (high - low), 0.0), 1.0)
        return 1.0 + share * max((paper - light) / max(light - dark, LEAST_HEIGHT), 0.0)


def _profile(grey: Image, corners_px: Float, reach_px: float) -> Profile | None:
    points, outwards = along_sides(corners_px, np.linspace(0.15, 0.85, AROUND))
    return profile_at(grey, points.reshape(-1, 2), np.repeat(outwards, AROUND, axis=0), reach_px)


def profile_at(
    grey: Image, points: Float, outwards: Float, reach_px: float, ratio: float | None = None
) -> Profile | None:
    """The profile at places (n, 2) with unit normals (n, 2), from dark to light; None where no edge is found.

    `ratio`: of dark over light, linear; places with another one are left out. Without it, those as high as most count.
    """
    reach_px = round(reach_px / STEP_PX) * STEP_PX
    offsets = np.arange(-reach_px, reach_px + STEP_PX / 2, STEP_PX)
    farthest = points[:, None] + np.array([-reach_px, reach_px])[:, None] * outwards[:, None]
    whole = ((farthest > 0) & (farthest < np.array(grey.shape[::-1]) - 1)).all(axis=(1, 2))
    if whole.sum() < AROUND:
        return None
    encoded = across(grey, points[whole], outwards[whole], offsets)
    profiles = LINEAR_FROM_SRGB_8BIT[np.round(encoded).astype(np.uint8)]
    black, white = np.median(profiles[:, :4], axis=1), np.median(profiles[:, -4:], axis=1)
    height = white - black
    if ratio is None:
        good = height > 0.5 * max(float(np.median(height)), 0.0)
    else:
        off = np.log(np.maximum(black, 1e-3) / np.maximum(white, 1e-3)) - math.log(max(ratio, 1e-3))
        good = (height > LEAST_HEIGHT) & (np.abs(off) < RATIO_ERROR)
    if good.sum() < AROUND or np.median(height[good]) < LEAST_HEIGHT:
        return None
    used = np.flatnonzero(whole)[good]
    steps = (profiles[good] - black[good, None]) / height[good, None]
    middles = np.abs(steps - 0.5).argmin(axis=1)
    reach = round((reach_px - MIDDLE_PX) / STEP_PX)
    near = (middles >= reach) & (middles < len(offsets) - reach)
    if near.sum() < AROUND:
        return None
    columns = middles[near, None] + np.arange(-reach, reach + 1)
    aligned_steps = np.take_along_axis(steps[near], columns, axis=1)
    step = aligned_steps.mean(axis=0) if ratio is None else np.median(aligned_steps, axis=0)
    aligned = np.take_along_axis(encoded[good][near], columns, axis=1) / 255
    dark, light = (float(np.median(encoded[good][near][:, ends])) / 255 for ends in (slice(4), slice(-4, None)))
    return Profile(step, np.median(aligned, axis=0), dark, light, used[near])


def across(grey: Image, points: Float, outwards: Float, offsets: Float) -> Float:
    """(n, k) values of (h, w) uint8 at `offsets` (k,) from points (n, 2) along unit vectors (n, 2)."""
    at = points[:, None] + offsets[:, None] * outwards[:, None]
    # Only the part around them is converted: all of a large picture takes longer than everything else here.
    first, end = np.floor(at.min(axis=(0, 1))).astype(int), np.floor(at.max(axis=(0, 1))).astype(int) + 2
    first = np.clip(first, 0, np.array(grey.shape[::-1]) - 1)
    part = grey[first[1] : max(end[1], first[1] + 1), first[0] : max(end[0], first[0] + 1)].astype(np.float32)
    x, y = np.moveaxis((at - first).astype(np.float32), 2, 0)
    return np.asarray(cv2.remap(part, x, y, cv2.INTER_LINEAR), np.float64)


def blur_of_step_px(step: Float, height: float = 1.0) -> float:
    """Sigma of the Gaussian that has blurred a step (k,), 0 and 1 at its ends, every STEP_PX.

    Height over steepest slope is sqrt(2 pi) sigma; sharpening makes it less. Within BLUR_RANGE_PX. `height`: of all of
    the step, where it is clipped above 1.
    """
    # Slopes are taken over half a pixel to both sides, so that noise does not steepen them.
    wide = int(0.5 / STEP_PX)
    slope = float((step[2 * wide :] - step[: -2 * wide]).max()) / (2 * wide * STEP_PX * height)
    variance = 1 / (2 * math.pi * max(slope, 1e-3) ** 2) - 4 * wide**2 * STEP_PX**2 / 12
    variance -= BOX_VARIANCE_PX2 + INTERPOLATION_VARIANCE_PX2
    return float(np.clip(math.sqrt(max(variance, 0.0)), *BLUR_RANGE_PX))


def _blurred_steps(profile: Profile, count: int) -> Float:
    """(m, count) encoded profiles of a step by each of BLURS_PX, as pixels see it and bilinear sampling reads it."""
    at = (np.arange(count) - count // 2) * STEP_PX
    sigmas = np.sqrt(BLURS_PX**2 + BOX_VARIANCE_PX2)
    shares = 0.5 * (1 + np.vectorize(math.erf)(at / (math.sqrt(2) * sigmas[:, None])))
    dark, light = linear_from_srgb([profile.dark, profile.light])
    pixels = srgb_from_linear(dark + (light - dark) * shares)
    return _smooth(pixels, math.sqrt(INTERPOLATION_VARIANCE_PX2) / STEP_PX)


def _smooth(rows: Float, sigma: float) -> Float:
    return np.asarray(cv2.GaussianBlur(rows, (2 * math.ceil(3 * sigma) + 1, 1), sigma, borderType=cv2.BORDER_REPLICATE))
