"""Steps of light across outlines in the picture at full resolution: where one side turns brighter than the other.

Unary costs (`labels`) distinguish materials by their colours in the whole region, and locate a border to about a third
of a coarse pixel. Once an outline is nearly right, the step of light across it can be measured by itself, like the
edges of model-based tracking (Harris and Stennett, "RAPID", 1990): the level on each side comes from the pixels beside
the point. As light adds up, the border lies where half of the step is reached (docs/maths, "Steps of light").
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.light.edges.outline_points import EXPECTED_SHARE, OutlinePoints
from ashe_live.light.pixels.areas import grown
from ashe_live.light.pixels.view import View

SAMPLING_PX = 0.5  # along a profile
WINDOW_PX = 3.0  # on either side of a step, in which that side's level is measured
GAP_PX = 1.25  # between the step and either window, each sample standing for SAMPLING_PX: the picture's blur
# Parallel profiles that are averaged, evenly spread over at most so many pixels to either side along the outline.
PARALLEL, SIDEWAYS_PX = 5, 4.0
NOISE = 2e-4  # variance of linear light, of all three channels together, that any picture has
# Independent samples in both windows together, as blurred neighbours are correlated; and the distance in pixels over
# which a blurred step rises. Together they give the variance of a step's place.
SAMPLES, RISE_PX = 5.0, 2.0
LEAST_SIGMA_PX = 0.15  # of a step's place: the raster of the pixels, sharpening, compression
LEAST_CONTRAST = 1.0  # squared step over the variance within both windows, below which there is no step
# Sigma of the rise of a step, going out of a shadow, from the shadow's shift of the log of brightness: a share of it
# and so much, for penumbrae, contact shadows and grain; and the sigmas beyond which a step is not that shadow's.
RISE_SHARE, RISE_SLACK, MOST_UNLIKE = 0.25, 0.05, 2.0
UNRELIABLE_PX = 2  # from the ground's end: its own edge is no outline's
DARKEST = 1e-4  # of linear light, whose log is taken


@dataclass(frozen=True, slots=True, eq=False)
class LightPicture:
    """A picture in linear light, and where steps in it can be those of an object or of a shadow on the ground."""

    view: View
    linear_bgr: Float32  # (h, w, 3)
    reliable: Mask  # (h, w)

    @staticmethod
    def of(view: View) -> "LightPicture":
        """The whole of `view`."""
        linear = cv2.LUT(view.image_bgr, LINEAR_FROM_SRGB_8BIT.astype(np.float32))
        return LightPicture(view, np.asarray(linear, dtype=np.float32), ~grown(~view.is_ground, UNRELIABLE_PX))

    def is_reliable_at(self, points: Float) -> Mask:
        """(...) whether points (..., 2) lie on reliable pixels of the picture."""
        height, width = self.reliable.shape
        inside = np.asarray(np.isfinite(points).all(axis=-1))
        x, y = np.moveaxis(np.rint(np.where(inside[..., None], points, -1.0)), -1, 0)
        inside &= (x >= UNRELIABLE_PX) & (y >= UNRELIABLE_PX)
        inside &= (x < width - UNRELIABLE_PX) & (y < height - UNRELIABLE_PX)
        at = np.where(inside, y, 0).astype(np.intp), np.where(inside, x, 0).astype(np.intp)
        return np.asarray(inside & self.reliable[at])


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """The steps found at p points of each of m outlines."""

    offset_px: Float  # (m, p) distance of the step outside of the point, along the normal
    information: Float  # (m, p) one over the variance of that distance; 0 where no step is within reach


def steps_across(linear_bgr: Float32, places: OutlinePoints, reach_px: float, rises: Float) -> Steps:
    """The likeliest step of light within `reach_px` of each point of m outlines.

    linear_bgr: (h, w, 3). rises: (m,) by how much the log of brightness should rise out of each outline, for shadows;
    NaN where the step may be any, for objects. A step divides a profile along the normal into two windows, whose levels
    differ more than they vary within; it lies where the profile passes half of the way from one level to the other.
    """
    m, p = places.points.shape[:2]
    window, gap = round(WINDOW_PX / SAMPLING_PX), math.floor(GAP_PX / SAMPLING_PX)
    count = round(reach_px / SAMPLING_PX) + gap + window
    offsets = np.asarray(SAMPLING_PX * np.arange(-count, count + 1), dtype=np.float64)
    profile, squares = _profiles(linear_bgr, places, offsets)
    at = np.arange(window + gap, len(offsets) - window - gap)
    levels = _Levels.beside(profile, squares, window, len(at))
    unlike = _unlike(levels, rises.repeat(p))
    # Twice the log of a step's likelihood ratio, both sides' variance being unknown, and of the priors' densities.
    expected_px = EXPECTED_SHARE * reach_px
    plausible = 2 * SAMPLES * np.log1p(levels.contrast) - (offsets[at] / expected_px) ** 2 - unlike**2
    row = np.arange(m * p), plausible.argmax(axis=1)
    contrast, inner, step, unlike = levels.contrast[row], levels.inner[:, *row], levels.step[:, *row], unlike[row]
    share = ((profile - inner[..., None]) * step[..., None]).sum(axis=0)
    share /= np.maximum((step**2).sum(axis=0), 1e-12)[:, None]
    crossing, is_crossed = _half_way(share, at[row[1]], gap + 2)
    offset_px = offsets[0] + SAMPLING_PX * crossing
    variance_px2 = LEAST_SIGMA_PX**2 + RISE_PX**2 / (SAMPLES * np.maximum(contrast, 1e-9))
    is_found = (
        is_crossed & (contrast > LEAST_CONTRAST) & (np.abs(offset_px) <= reach_px) & (np.abs(unlike) < MOST_UNLIKE)
    )
    found = np.where(is_found, offset_px, 0.0), np.where(is_found, 1 / variance_px2, 0.0)
    return Steps(*(values.reshape(m, p) for values in found))


@dataclass(frozen=True, slots=True, eq=False)
class _Levels:
    """Linear light on both sides of each of k places of a step, in n profiles."""

    inner: Float  # (3, n, k) mean over the window inside
    outer: Float  # (3, n, k) mean over that outside
    step: Float  # (3, n, k) from the inner level to the outer one
    contrast: Float  # (n, k) squared step over the variance within both windows

    @staticmethod
    def beside(profile: Float32, squares: Float32, window: int, count: int) -> "_Levels":
        """Of profiles (3, n, s) with their squares (n, s), for k = `count` places between two windows of samples."""
        means = _window_means(np.concatenate([profile, squares[None]]), window)
        within, without = means[..., :count], means[..., -count:]
        inner, outer = within[:3], without[:3]
        step = outer - inner
        variance = np.maximum(within[3] + without[3] - (inner**2).sum(axis=0) - (outer**2).sum(axis=0), 0)
        return _Levels(inner, outer, step, (step**2).sum(axis=0) / (variance + NOISE))


def _unlike(levels: _Levels, rises: Float) -> Float:
    """(n, k) by how many sigmas the log of brightness rises otherwise than by rises (n,); 0 where these are NaN."""
    darker, brighter = (np.maximum(level.mean(axis=0), DARKEST) for level in (levels.inner, levels.outer))
    rise = np.log(brighter / darker)
    is_any = np.isnan(rises)
    slack = np.where(is_any, np.inf, RISE_SHARE * np.abs(rises) + RISE_SLACK)
    return np.asarray((rise - np.where(is_any, 0.0, rises)[:, None]) / slack[:, None])


def _profiles(linear_bgr: Float32, places: OutlinePoints, offsets: Float) -> tuple[Float32, Float32]:
    """(3, m p, s) means over parallel profiles through each point, sampled at `offsets` (s,); (m p, s) mean squares, of
    all channels together.
    """
    spacing_px = np.linalg.norm(places.points - np.roll(places.points, 1, axis=1), axis=2).mean(axis=1)
    sideways_px = np.clip(spacing_px / 2, 1.0, SIDEWAYS_PX)[:, None] * np.linspace(-1, 1, PARALLEL)[:, None, None]
    (x, y), (normal_x, normal_y) = (np.moveaxis(each, 2, 0) for each in (places.points, places.normals))

    def along(start: Float, normal: Float) -> Float32:
        """(PARALLEL m p, s) one coordinate of the samples, of profiles that start at (PARALLEL, m, p)."""
        lines = start[..., None] + normal[..., None] * offsets
        return lines.reshape(-1, len(offsets)).astype(np.float32)

    at = along(x - sideways_px * normal_y, normal_x), along(y + sideways_px * normal_x, normal_y)
    sampled = cv2.remap(linear_bgr, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    values = np.array(cv2.split(sampled), np.float32).reshape(3, PARALLEL, -1, len(offsets))
    return values.mean(axis=1), (values**2).mean(axis=1).sum(axis=0)


def _window_means(values: Float32, window: int) -> Float:
    """(..., s - window + 1) means over each `window` of successive samples of values (..., s)."""
    sums = np.zeros((*values.shape[:-1], values.shape[-1] + 1))
    values.cumsum(axis=-1, dtype=np.float64, out=sums[..., 1:])
    return np.asarray((sums[..., window:] - sums[..., :-window]) / window)


def _half_way(share: Float, middle: NDArray[np.intp], reach: int) -> tuple[Float, Mask]:
    """(n,) index, between samples, where a profile (n, s) rises through one half, nearest to `middle` (n,); and whether
    it does within `reach` samples.
    """
    last = share.shape[1] - 1
    around = np.clip(middle[:, None] + np.arange(-reach, reach + 1), 0, last).astype(np.intp)
    near = np.take_along_axis(share, around, axis=1)
    rises = (near[:, :-1] < 0.5) & (near[:, 1:] >= 0.5)
    away = np.abs(np.arange(-reach, reach) + 0.5)
    first = np.where(rises, away, np.inf).argmin(axis=1)[:, None]
    low, high = np.take_along_axis(near, first, axis=1), np.take_along_axis(near, first + 1, axis=1)
    is_crossed = np.asarray(rises.any(axis=1))
    part = np.where(is_crossed, ((0.5 - low) / np.maximum(high - low, 1e-12))[:, 0], 0.0)
    return np.asarray(np.take_along_axis(around, first, axis=1)[:, 0] + part), is_crossed
