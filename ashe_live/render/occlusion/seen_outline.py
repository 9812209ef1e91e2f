"""Where a real object's outline is in the picture, a little beside that of the body that stands for it.

A fitted body belongs to a family, and may be beside the object by pixels. Along the normal of its outline there is a
step from the object to the ground. It is sought at all places of the outline together (dynamic programming, as in
Amini, Weymouth, Jain, "Using dynamic programming for solving variational problems in vision", 1990), and must have
ground outside: letters, shadows and rims on the object, and the texture of the ground, are steps as well.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT

PLACES = 120  # of the outline at which a step is sought
REACH = 0.05  # how far from the outline, over the root of the area within it
STEP_PX = 0.5  # between the samples along a profile
WINDOW, GAP = 6, 2  # samples whose mean is the level beside a step, and between the step and either window
# Parallel profiles that are averaged, over at most so many pixels to either side along the outline.
PARALLEL, SIDEWAYS_PX = 5, 4.0
NOISE = 2e-4  # variance of linear light, of all three channels together, that any picture has
# Independent samples in both windows together; and the squared step over the variance beside it from which a step is
# clear. How much clearer it is says nothing of whether it is the outline's.
SAMPLES, CLEAR = 5.0, 4.0
EXPECTED = 0.6  # standard deviation of a step's place, over the reach
BEND = 2.0  # cost of moving by one sample more than the neighbouring place does, which is at most MOST_BEND
MOST_BEND = 4
# The colours of object and ground are those of bands beyond the reach, as wide as this share of it or so many samples,
# in logarithms of light above a floor; their deviation is so much at least; neighbouring places count by a Gaussian.
BAND, LEAST_BAND, FLOOR, LEAST_DEVIATION, NEIGHBOURS = 0.6, 8, 0.01, 0.05, 2.0
# What a colour costs at most, as none is explained for certain; objects vary more than ground does. The log odds of one
# sample are limited, and count half, as neighbouring ones are alike.
UNEXPLAINED, OF_OBJECT, MOST_ODDS, ODDS_COUNT = 3.0, 1.0, 2.0, 0.5
UNCLEAR = 0.05  # weight of a place without a step, beside its neighbours
TRUSTED_PX = 0.75  # a step nearer than this to the body's outline hardly moves it: it is as uncertain as the body


@dataclass(frozen=True, slots=True, eq=False)
class SeenOutline:
    """Places on a body's convex outline in a picture, in their order around it, and how far outside the object's is."""

    points_px: Float  # (n, 2)
    normals: Float  # (n, 2) unit vectors outwards
    offset_px: Float  # (n,)


def seen_outline(image_bgr: Image, hull_px: Float) -> SeenOutline | None:
    """The object's outline near a convex one (m, 2) in a picture (h, w, 3); None where that has no area."""
    area = abs(cv2.contourArea(hull_px.astype(np.float32)))
    if len(hull_px) < 3 or area < 1.0:
        return None
    points, normals = _places(hull_px)
    # What stands right before the camera is larger than the picture.
    size_px = min(math.sqrt(area), max(image_bgr.shape[:2]))
    reach = max(round(REACH * size_px / STEP_PX), 1)
    band = max(round(BAND * reach), LEAST_BAND)
    profile, squares = _profiles(image_bgr, points, normals, reach + max(band, GAP + WINDOW))
    steps = _Steps.between(profile, squares, reach)
    offsets = np.arange(-reach, reach + 1)
    cost = -2 * SAMPLES * np.log1p(np.minimum(steps.contrast, CLEAR)) + (offsets / (EXPECTED * reach)) ** 2
    cost += _ground_within(profile, reach, band)
    chosen = _cheapest_around(cost)
    return SeenOutline(points, normals, _smoothed_px(steps, chosen, profile, reach))


@dataclass(frozen=True, slots=True, eq=False)
class _Steps:
    """The steps at k offsets of n places."""

    inner: Float  # (n, k, 3) the mean of linear light inside
    rise: Float  # (n, k, 3) of that outside beyond it
    contrast: Float  # (n, k) squared rise over the variance within both windows

    @staticmethod
    def between(profile: Float, squares: Float, reach: int) -> "_Steps":
        """Of profiles (n, s, 3) with their mean squares (n, s), at up to `reach` samples from their middle."""
        values = np.concatenate([profile, squares[..., None]], axis=2)
        sums = np.concatenate([np.zeros_like(values[:, :1]), values.cumsum(axis=1)], axis=1)
        means = (sums[:, WINDOW:] - sums[:, :-WINDOW]) / WINDOW
        middle, count = profile.shape[1] // 2, 2 * reach + 1
        first = middle - reach - GAP - WINDOW
        inside = means[:, first : first + count]
        outside = means[:, middle - reach + GAP + 1 :][:, :count]
        inner, outer = inside[..., :3], outside[..., :3]
        variance = inside[..., 3] + outside[..., 3] - (inner**2).sum(axis=2) - (outer**2).sum(axis=2)
        rise = outer - inner
        return _Steps(inner, rise, (rise**2).sum(axis=2) / (np.maximum(variance, 0.0) + NOISE))


def _places(hull_px: Float) -> tuple[Float, Float]:
    """(n, 2) points evenly spaced along a convex polygon (m, 2), and (n, 2) its unit normals there, outwards."""
    edges = np.roll(hull_px, -1, axis=0) - hull_px
    lengths = np.hypot(*edges.T)
    ends = lengths.cumsum()
    at = (np.arange(PLACES) + 0.5) / PLACES * ends[-1]
    edge = np.minimum(np.searchsorted(ends, at), len(ends) - 1)
    along = edges[edge] / np.maximum(lengths[edge], 1e-9)[:, None]
    points = hull_px[edge] + along * (at - ends[edge] + lengths[edge])[:, None]
    outwards = along[:, ::-1] * (1, -1)
    outwards *= np.sign(((points - hull_px.mean(axis=0)) * outwards).sum())
    outwards = outwards + np.roll(outwards, 1, axis=0) + np.roll(outwards, -1, axis=0)
    return points, outwards / np.maximum(np.hypot(*outwards.T), 1e-9)[:, None]


def _profiles(image_bgr: Image, points: Float, normals: Float, reach: int) -> tuple[Float, Float]:
    """(n, s, 3) linear light along the normals, at up to `reach` samples from points (n, 2), the mean of parallel
    profiles; (n, s) the mean squares, of all channels together.
    """
    offsets = STEP_PX * np.arange(-reach, reach + 1)
    spacing_px = np.hypot(*(points[1] - points[0]))
    sideways = min(max(spacing_px / 2, 1.0), SIDEWAYS_PX) * np.linspace(-1, 1, PARALLEL)
    starts = points + sideways[:, None, None] * (normals[:, ::-1] * (-1, 1))
    at = starts[:, :, None] + offsets[:, None] * normals[:, None]
    # Only the part around the outline is made linear.
    height, width = image_bgr.shape[:2]
    low = np.clip(np.floor(at.min(axis=(0, 1, 2))).astype(int), 0, (width - 1, height - 1))
    high = np.clip(np.ceil(at.max(axis=(0, 1, 2))).astype(int) + 1, low + 1, (width, height))
    linear = LINEAR_FROM_SRGB_8BIT.astype(np.float32)[image_bgr[low[1] : high[1], low[0] : high[0]]]
    x, y = np.moveaxis((at - low).reshape(-1, len(offsets), 2).astype(np.float32), 2, 0)
    sampled = cv2.remap(linear, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    values = np.asarray(sampled, np.float64).reshape(PARALLEL, len(points), len(offsets), 3)
    return values.mean(axis=0), (values**2).mean(axis=0).sum(axis=2)


def _ground_within(profile: Float, reach: int, band: int) -> Float:
    """(n, k) log odds that what lies inside of each offset is ground, not object, summed along profiles (n, s, 3)."""
    middle = profile.shape[1] // 2
    colours = np.log(np.maximum(profile[:, middle - reach - band : middle + reach + band + 1], 0.0) + FLOOR)
    of_object, _ = _log_likelihood(colours, colours[:, :band])
    of_ground, deviation = _log_likelihood(colours, colours[:, -band:])
    unexplained = -UNEXPLAINED - np.log(deviation).sum(axis=2)
    odds = np.maximum(of_ground, unexplained) - np.maximum(of_object, unexplained + OF_OBJECT)
    summed = ODDS_COUNT * np.clip(odds, -MOST_ODDS, MOST_ODDS).cumsum(axis=1)
    return np.asarray(summed[:, band : band + 2 * reach + 1])


def _log_likelihood(colours: Float, band: Float) -> tuple[Float, Float]:
    """(n, s) of colours (n, s, 3) by Gaussians of those of bands (n, b, 3), and (n, 1, 3) their deviations."""
    means = _over_neighbours(np.concatenate([band.mean(axis=1), (band**2).mean(axis=1)], axis=1), NEIGHBOURS)[:, None]
    deviation = np.sqrt(np.maximum(means[..., 3:] - means[..., :3] ** 2, 0.0) + LEAST_DEVIATION**2)
    return -(0.5 * ((colours - means[..., :3]) / deviation) ** 2 + np.log(deviation)).sum(axis=2), deviation


def _over_neighbours(values: Float, sigma: float) -> Float:
    """(n, c) Gaussian means over the neighbours of each of n places around an outline."""
    reach = math.ceil(3 * sigma)
    around = np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * (around / sigma) ** 2)
    pairs = zip(weights / weights.sum(), around, strict=True)
    return np.asarray(sum(weight * np.roll(values, shift, axis=0) for weight, shift in pairs))


def _cheapest_around(cost: Float) -> Float:
    """(n,) indices of the offset of each place that cost (n, k) the least together, with their bends (Viterbi).

    As the outline is closed it is gone around three times, of which the middle one counts.
    """
    n, k = cost.shape
    moves = np.arange(-MOST_BEND, MOST_BEND + 1)
    bends = BEND * moves[:, None] ** 2
    before = np.arange(k) + moves[:, None] + MOST_BEND
    total, came_from = cost[0], np.zeros((3 * n, k), dtype=np.intp)
    padded = np.full(k + 2 * MOST_BEND, np.inf)
    for place in range(1, 3 * n):
        padded[MOST_BEND:-MOST_BEND] = total
        through = padded[before] + bends
        best = through.argmin(axis=0)
        came_from[place] = np.arange(k) + moves[best]
        total = through[best, np.arange(k)] + cost[place % n]
    chosen = np.empty(3 * n, dtype=np.intp)
    chosen[-1] = total.argmin()
    for place in range(3 * n - 1, 0, -1):
        chosen[place - 1] = came_from[place, chosen[place]]
    return chosen[n : 2 * n]


def _smoothed_px(steps: _Steps, chosen: Float, profile: Float, reach: int) -> Float:
    """(n,) pixels outside, where half of the chosen steps is reached, smoothed along the outline."""
    row = np.arange(len(chosen))
    inner, rise, contrast = steps.inner[row, chosen], steps.rise[row, chosen], steps.contrast[row, chosen]
    share = ((profile - inner[:, None]) * rise[:, None]).sum(axis=2)
    share /= np.maximum((rise**2).sum(axis=1), 1e-12)[:, None]
    near = np.arange(-GAP - 2, GAP + 3)
    samples = np.take_along_axis(share, (profile.shape[1] // 2 + chosen - reach)[:, None] + near, axis=1)
    low, high = samples[:, :-1], samples[:, 1:]
    crosses = (low < 0.5) & (high >= 0.5)
    first = np.where(crosses, np.abs(near[:-1] + 0.5), np.inf).argmin(axis=1)
    low, high, is_found = low[row, first], high[row, first], crosses.any(axis=1)
    crossing = near[first] + (0.5 - low) / np.where(is_found, high - low, 1.0)
    offset_px = STEP_PX * (chosen - reach + np.where(is_found, crossing, 0.0))
    weight = np.where(is_found, contrast / (contrast + 1), UNCLEAR)
    weighted, weights = _over_neighbours(np.column_stack([weight * offset_px, weight]), 1.0).T
    offset_px = weighted / np.maximum(weights, 1e-9)
    return np.asarray(offset_px**3 / (offset_px**2 + TRUSTED_PX**2))
