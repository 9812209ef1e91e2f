"""The lit ground: the colours that are found all over the frame, and what of the frame they do not explain.

A ground, plain or patterned, shows its few colours everywhere; an object and its shadow show theirs in one place. So
colours are told apart by how widely they are spread, before anything is known of their brightness. Colours are logs of
linear light, in which a shadow is a shift, the same for every colour of the ground.
"""

from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.light.areas import cleaned, large_areas, shrunk, smoothed
from ashe_live.light.log_colour import Float32, linear_rgb, log_opponent
from ashe_live.light.mixtures import Mixture, clusters, mixture_of, nearest_centres, nearest_squared_distance
from ashe_live.light.sheen import sheen_on, without_sheen
from ashe_live.light.view import Window

Floats = TypeVar("Floats", Float, Float32)

CELLS = (8, 6)
SAMPLES = 5000
# Squared distance from the palette beyond which a colour is something else.
SURPRISING, MOST_SURPRISING = 6.0, 60.0


@dataclass(frozen=True, slots=True)
class GroundSteps:
    """How finely the ground is modelled."""

    spread_colours: int = 20  # clusters whose spread over the frame is measured
    palette_colours: int = 10  # clusters of the lit ground
    field_rounds: int = 2


@dataclass(frozen=True, slots=True, eq=False)
class LitGround:
    """The ground's palette and how far each pixel is from it."""

    colours: Float32  # (h, w, 3) log-opponent colours without the ground's own slow shading
    field: Float32  # (5, 3) that shading, as coefficients of slow bases
    palette: Mixture  # of the lit ground
    surprise: Float32  # (h, w) squared Mahalanobis distance to the nearest colour of the palette, smoothed
    spread: Float32  # (h, w) share of the frame over which the pixel's colour is found, in (0, 1]
    sheen: Mask  # (h, w) what differs from the palette by light alone


def fit_lit_ground(image_bgr: Image, is_ground: Mask, steps: GroundSteps) -> LitGround | None:
    """The lit ground of `image_bgr` (h, w, 3), where `is_ground` (h, w) leaves out the marker and the sky.

    None when too little of the frame is ground, or no colour of it is spread.
    """
    colours = log_opponent(image_bgr)
    if np.count_nonzero(is_ground) < SAMPLES // 10:
        return None
    bases = _slow_bases((*is_ground.shape,))
    field, spread = _wider_spread(colours, bases, is_ground, steps.spread_colours)
    lit = is_ground & (smoothed(spread) > _spread_of_ground(spread, is_ground))
    chosen = _samples(shrunk(lit, 1))
    if len(chosen) < SAMPLES // 10:
        return None
    for _ in range(steps.field_rounds):
        field = _field_beside_palette(colours, field, bases, chosen, steps.palette_colours)
    flat = colours - (bases @ field).reshape(colours.shape)
    palette = mixture_of(flat.reshape(-1, 3)[chosen], steps.palette_colours, widening=1.3)
    if palette is None:
        return None
    squared = nearest_squared_distance(flat.reshape(-1, 3), palette).reshape(lit.shape)
    surprise = np.asarray(cv2.GaussianBlur(np.minimum(squared, MOST_SURPRISING), (0, 0), 0.7), dtype=np.float32)
    return LitGround(flat, field, palette, surprise, spread, sheen_on(flat, surprise, is_ground, palette))


def ground_colours(image_bgr: Image, ground: LitGround, window: Window) -> Float32:
    """(h, w, 3): the colours of a window (rows, columns) of the frame at another scale, on the same ground."""
    colours = log_opponent(image_bgr[window])
    flat = colours - (_slow_bases(image_bgr.shape[:2], window) @ ground.field).reshape(colours.shape)
    size = image_bgr.shape[1::-1]
    sheen = cv2.resize(ground.sheen.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)[window].astype(bool)
    return without_sheen(flat, sheen, ground.palette)


def lit_rgb(ground: LitGround) -> Float:
    """(3,) mean linear RGB of the lit ground."""
    return np.asarray(np.average(linear_rgb(ground.palette.centres), axis=0, weights=ground.palette.weights))


def unlit_mask(ground: LitGround, is_ground: Mask, least_px: int) -> Mask:
    """(h, w): objects and shadows, as compact areas of at least `least_px` that the lit ground does not explain."""
    rare = smoothed(ground.spread) < _spread_of_ground(ground.spread, is_ground, most=0.35, of_median=0.75)
    surprising = (ground.surprise > SURPRISING) & ~ground.sheen
    return large_areas(cleaned(is_ground & rare & surprising), least_px)


def _slow_bases(shape: tuple[int, ...], window: Window = (slice(None), slice(None))) -> Float32:
    """(h * w, 5): the slow shading of a ground seen in perspective under one sky: a quadratic without a constant."""
    rows, columns = (np.arange(size, dtype=np.float32)[part] + 0.5 for size, part in zip(shape, window, strict=True))
    v, u = np.meshgrid(rows, columns, indexing="ij")
    u, v = 2 * u / shape[1] - 1, 2 * v / shape[0] - 1
    return np.stack([u, v, u * u, u * v, v * v], axis=2).reshape(-1, 5)


def _samples(mask: Mask) -> NDArray[np.intp]:
    """Up to SAMPLES flat indices of `mask`, chosen at random but always the same."""
    inside = np.flatnonzero(mask)
    if len(inside) <= SAMPLES:
        return inside
    return np.sort(np.random.default_rng(0).choice(inside, SAMPLES, replace=False))


def _wider_spread(colours: Float32, bases: Float32, is_ground: Mask, count: int) -> tuple[Float32, Float32]:
    """The slow field, or none, whichever leaves the ground's colours more widely spread; and that spread."""
    chosen = _samples(is_ground)
    none = np.zeros((bases.shape[1], 3), np.float32)
    trend = _robust_trend(colours, bases, chosen)
    spreads = [
        (field, _spread(colours - (bases @ field).reshape(colours.shape), is_ground, chosen, count))
        for field in (none, trend)
    ]
    return max(spreads, key=lambda pair: float(_median(pair[1][is_ground])))


def _spread(colours: Float32, is_ground: Mask, chosen: NDArray[np.intp], count: int) -> Float32:
    """(h, w): over how many of the frame's cells each pixel's colour is distributed (perplexity over cells)."""
    flat = colours.reshape(-1, 3)
    _, centres = clusters(flat[chosen], count)
    labels = nearest_centres(flat, centres)
    height, width = is_ground.shape
    columns, rows = CELLS
    cells = (np.arange(height) * rows // height)[:, None] * columns + np.arange(width) * columns // width
    inside = is_ground.ravel()
    total = np.bincount(cells.ravel()[inside], minlength=columns * rows)
    counts = np.bincount(labels[inside] * total.size + cells.ravel()[inside], minlength=len(centres) * total.size)
    seen = total > 0.15 * is_ground.size / total.size
    density = counts.reshape(len(centres), -1)[:, seen] / np.maximum(total[seen], 1)
    share = density / np.maximum(density.sum(axis=1, keepdims=True), 1e-9)
    perplexity = np.exp(-(share * np.log(share + 1e-12)).sum(axis=1)) / max(np.count_nonzero(seen), 1)
    return np.asarray(perplexity[labels].reshape(is_ground.shape), dtype=np.float32)


def _spread_of_ground(spread: Float32, is_ground: Mask, most: float = 0.3, of_median: float = 0.6) -> float:
    """The spread above which a colour is one of the ground's."""
    return min(most, of_median * float(_median(spread[is_ground])))


def _median(values: Floats) -> Floats:
    """Over the last axis; NumPy's own looks for NaN as well, and takes several times as long."""
    middle = values.shape[-1] // 2
    parted = np.partition(values, middle, axis=-1)
    upper = parted[..., middle]
    return upper if values.shape[-1] % 2 else 0.5 * (upper + parted[..., :middle].max(axis=-1))


def _robust_trend(colours: Float32, bases: Float32, chosen: NDArray[np.intp]) -> Float32:
    """(5, 3) slow field by reweighted least squares with a constant, which is left out; outliers: Cauchy weights."""
    design = np.column_stack([np.ones(len(chosen), np.float32), bases[chosen]]).astype(np.float64)
    values = colours.reshape(-1, 3)[chosen].T.astype(np.float64)
    ridge = 2e-5 * len(chosen) * np.diag([0.0, 1, 1, 3, 3, 3])
    weights = np.ones(len(chosen))
    for _ in range(6):
        weighted = design * weights[:, None]
        coefficients = np.linalg.solve(weighted.T @ design + ridge, (values @ weighted).T)
        residuals = values - coefficients.T @ design.T
        scale = 1.48 * _median(np.abs(residuals))[:, None] + 0.01
        weights = 1 / (1 + ((residuals / (2 * scale)) ** 2).sum(axis=0))
    return np.asarray(coefficients[1:], dtype=np.float32)


def _field_beside_palette(
    colours: Float32, field: Float32, bases: Float32, chosen: NDArray[np.intp], count: int
) -> Float32:
    """The slow field once more, from what the palette's colours leave over."""
    values = colours.reshape(-1, 3)[chosen]
    before = bases[chosen] @ field
    labels, centres = clusters(values - before, count)
    rest = values - centres[labels]
    weights = 1 / (1 + (((rest - before) / 0.15) ** 2).sum(axis=1))
    weighted = bases[chosen] * weights[:, None]
    ridge = 5e-4 * len(chosen) * np.eye(5, dtype=np.float32)
    coefficients = np.linalg.solve(weighted.T @ bases[chosen] + ridge, weighted.T @ rest)
    return np.asarray(coefficients, dtype=np.float32)
