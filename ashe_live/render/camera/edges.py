"""How sharp a picture is, at edges of which one knows where they are: the marker's square, and a shadow's border."""

import math
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, linear_from_srgb, srgb_from_linear
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import along_sides, mean_side_px, side_lengths_px
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.render.lights.cast_shadows import shadow_hull
from ashe_live.render.lights.lighting import Sun

AROUND = 12  # places along each of a polygon's edges
REACH_PX, STEP_PX = 7.0, 0.25  # of a profile across an edge, to both sides
MIDDLE_PX = 2.0  # to both sides, within which the edge must be
BORDER_SIDES = 0.11  # of the square: its black border is no thinner, and its paper's no narrower as a rule
LEAST_REACH_PX = 4.0
BLUR_RANGE_PX = (0.0, 3.0)
BOX_VARIANCE_PX2 = 1 / 12  # of a pixel, which the model's own pixels have too
INTERPOLATION_VARIANCE_PX2 = 1 / 6  # of bilinear sampling, on average
LEAST_HEIGHT = 0.05  # of an edge, linear
BLURS_PX = np.arange(0.0, 2.6, 0.1)  # that are tried on a sharpened edge
SHARPENING_SIGMA_PX = 1.0  # of the blur that is taken away: cameras have about this one
MOST_SHARPENING = 2.0
# Of an edge's height, how far it must over- and undershoot together: a soft edge that was sharpened a little looks like
# a less soft one, but for that. Noise and uneven paper make up to half of it.
LEAST_OVERSHOOT = 0.05
MOST_BORDER_PX = 1.5  # in a picture 640 pixels wide
LEAST_SINE = 0.1  # of a light's elevation, for how long its shadows are


def edge_blur_px(grey: Image, corners_px: Float) -> float:
    """Sigma of the blur, in pixels, of (h, w) uint8 at the border of a dark convex polygon (k, 2); 0 where untold."""
    profile = _profile(grey, corners_px, REACH_PX)
    return 0.0 if profile is None else _blur_px(profile.step)


def blur_and_sharpening(grey: Image, corners_px: Float) -> tuple[float, float]:
    """Sigma of the blur, in pixels, and how much was sharpened then, of (h, w) uint8 at the black square (4, 2).

    A camera blurs linear light and sharpens encoded values e by adding s (e - blurred e), which over- and undershoots
    beside an edge. Blurs are tried, each with the s of least squares.
    """
    reach_px = float(np.clip(BORDER_SIDES * side_lengths_px(corners_px).min(), LEAST_REACH_PX, REACH_PX))
    profile = _profile(grey, corners_px, reach_px)
    if profile is None:
        return 0.0, 0.0
    sigma_px = _blur_px(profile.step)
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


def unexplained_border_px(tracked: TrackedFrame, proxy: Proxy, sun: Sun) -> float:
    """Standard deviation (px) by which the real shadow's border is softer than lens and sun make it; 0 if by none.

    A camera's sharpening makes the marker's strong edges steeper than the weak ones of shadows, its denoising makes
    those softer, and a sun of unknown size counts as a bare one.
    """
    assert tracked.marker is not None
    T = tracked.marker.T_cam_marker
    body = proxy.points_marker()
    hull = shadow_hull(body, sun)
    points = np.column_stack([hull, np.zeros(len(hull))])
    if len(points) < 3 or (points @ T[2, :3] + T[2, 3]).min() <= 1e-3:
        return 0.0
    grey = np.asarray(cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    corners = tracked.marker.corners_px
    border = edge_blur_px(grey, project(tracked.camera, T, points))
    # A disc's standard deviation is half its radius; heights are spread evenly along the border, the root of whose mean
    # square is 1 / sqrt(3) of the whole.
    sine = max(float(sun.to_light[2]), LEAST_SINE)
    penumbra_m = sun.tan_half_size * float(body[:, 2].max()) / math.sqrt(3) / sine / 2
    penumbra = penumbra_m * mean_side_px(corners) / tracked.marker.side_m
    # The shadow maps' own texels blur about as much as a pixel does.
    rest = border**2 - edge_blur_px(grey, corners) ** 2 - penumbra**2 - BOX_VARIANCE_PX2
    return min(math.sqrt(max(rest, 0.0)), MOST_BORDER_PX * tracked.frame.size[0] / 640)


class _Profile(NamedTuple):
    """Across an edge, which is in the middle, from dark to light."""

    step: Float  # (k,) linear, dark 0 and light 1; mean of many
    encoded: Float  # (k,) as in the picture, in [0, 1]; their median, as shadows may cross some
    dark: float  # encoded, and so
    light: float


def _profile(grey: Image, corners_px: Float, reach_px: float) -> _Profile | None:
    """None where no edge can be told."""
    reach_px = round(reach_px / STEP_PX) * STEP_PX
    offsets = np.arange(-reach_px, reach_px + STEP_PX / 2, STEP_PX)
    points, outwards = along_sides(corners_px, np.linspace(0.15, 0.85, AROUND))
    at = points[:, :, None] + offsets[:, None] * outwards[:, None, None]
    at = at.reshape(-1, len(offsets), 2)
    whole = ((at > 0) & (at < np.array(grey.shape[::-1]) - 1)).all(axis=(1, 2))
    if whole.sum() < AROUND:
        return None
    x, y = np.moveaxis(at[whole].astype(np.float32), 2, 0)
    encoded = cv2.remap(grey.astype(np.float32), x, y, cv2.INTER_LINEAR)
    profiles = LINEAR_FROM_SRGB_8BIT[np.round(encoded).astype(np.uint8)]
    black, white = np.median(profiles[:, :4], axis=1), np.median(profiles[:, -4:], axis=1)
    height = white - black
    good = height > 0.5 * np.median(height)
    if np.median(height) < LEAST_HEIGHT or good.sum() < AROUND:
        return None
    steps = (profiles[good] - black[good, None]) / height[good, None]
    middles = np.abs(steps - 0.5).argmin(axis=1)
    reach = round((reach_px - MIDDLE_PX) / STEP_PX)
    near = (middles >= reach) & (middles < len(offsets) - reach)
    if near.sum() < AROUND:
        return None
    columns = middles[near, None] + np.arange(-reach, reach + 1)
    step = np.take_along_axis(steps[near], columns, axis=1).mean(axis=0)
    aligned = np.take_along_axis(encoded[good][near], columns, axis=1) / 255
    dark, light = (float(np.median(encoded[good][near][:, ends])) / 255 for ends in (slice(4), slice(-4, None)))
    return _Profile(step, np.median(aligned, axis=0), dark, light)


def _blur_px(step: Float) -> float:
    """Sigma of the Gaussian that has blurred a step (k,), 0 and 1 at its ends, every STEP_PX.

    Height over steepest slope is sqrt(2 pi) sigma; sharpening makes it less.
    """
    # Over half a pixel to both sides, so that noise does not steepen the slope.
    wide = int(0.5 / STEP_PX)
    slope = float((step[2 * wide :] - step[: -2 * wide]).max()) / (2 * wide * STEP_PX)
    variance = 1 / (2 * math.pi * max(slope, 1e-3) ** 2) - 4 * wide**2 * STEP_PX**2 / 12
    variance -= BOX_VARIANCE_PX2 + INTERPOLATION_VARIANCE_PX2
    return float(np.clip(math.sqrt(max(variance, 0.0)), *BLUR_RANGE_PX))


def _blurred_steps(profile: _Profile, count: int) -> Float:
    """(m, count) encoded profiles of a step by each of BLURS_PX, as pixels see it and bilinear sampling reads it."""
    at = (np.arange(count) - count // 2) * STEP_PX
    sigmas = np.sqrt(BLURS_PX**2 + BOX_VARIANCE_PX2)
    shares = 0.5 * (1 + np.vectorize(math.erf)(at / (math.sqrt(2) * sigmas[:, None])))
    dark, light = linear_from_srgb([profile.dark, profile.light])
    pixels = srgb_from_linear(dark + (light - dark) * shares)
    return _smooth(pixels, math.sqrt(INTERPOLATION_VARIANCE_PX2) / STEP_PX)


def _smooth(rows: Float, sigma: float) -> Float:
    return np.asarray(cv2.GaussianBlur(rows, (2 * math.ceil(3 * sigma) + 1, 1), sigma, borderType=cv2.BORDER_REPLICATE))
