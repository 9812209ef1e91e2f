"""The lit ground: the colours that are found all over the frame, and the pixels that they do not explain.

A ground, plain or patterned, shows its few colours everywhere; an object and its shadow show theirs in one place. So
colours are classified by their spatial spread over the frame, whatever their brightness. They are logs of linear light,
in which a shadow is one shift, the same for every colour of the ground (docs/maths, "The lit ground").
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Image, Mask, median
from ashe_live.light.ground.preset import COARSE, GroundPreset
from ashe_live.light.ground.sheen import sheen_on, without_sheen
from ashe_live.light.ground.slow_shading import LightFall, field_beside, robust_trend, slow_bases
from ashe_live.light.pixels.areas import cleaned, grown, large_areas, resized, sampled, shrunk, smoothed
from ashe_live.light.pixels.log_colour import linear_rgb, log_opponent
from ashe_live.light.pixels.mixtures import Mixture, clusters, mixture_of, nearest_centres, nearest_squared_distance
from ashe_live.light.pixels.view import View, Window

CELLS = (8, 6)  # columns and rows, over which a colour's spread is counted
# Squared Mahalanobis distance from the palette beyond which a colour is not the lit ground's, and its upper limit.
UNLIT_DISTANCE, MOST_DISTANCE = 6.0, 60.0
SAMPLES, LEAST_SAMPLES = 2000, 500  # pixels of ground whose colours are clustered; fewest that a ground is found by
# Thresholds on a colour's spread, absolute and relative to the median one (the lower of the two applies): above WIDE it
# is the ground's, below RARE it is rare.
WIDE, WIDE_OF_TYPICAL = 0.3, 0.6
RARE, RARE_OF_TYPICAL = 0.35, 0.75
SMOOTHING_PX, NEAR_PX = 0.7, 3  # standard deviation of the smoothing of `squared_distance`, and its reach
WIDENING = 1.3  # factor on the covariances of the palette's components
# Scale at which colours are averaged, and the least area there, in pixels, of an object found by its mean colour.
AVERAGED, LEAST_AVERAGED_PX = 1 / 3, 12
# Log odds of lying on the plane below which a pixel is something that stands there, if its colour is unusual for the
# ground by a squared distance: ground that is hidden in other views has such log odds, too.
OFF_PLANE, UNUSUAL_DISTANCE = -1.5, 3.5
# Log odds from which on it is surely on the plane; what is brighter there, by so much in log brightness than the
# brightest of the palette's colours with a share of COMMON, is a glow.
ON_PLANE, BRIGHTER, COMMON = 0.5, 0.1, 0.03
SPECK_SHARE = 0.0005  # of the picture: smaller unlit areas are specks
SEEN_SHARE = 0.15  # least ground in a cell that counts, as a fraction of the fullest cell's


@dataclass(frozen=True, slots=True, eq=False)
class BroadAreas:
    """Areas in colours that the ground has in narrow joints only, and that are too broad for these."""

    mask: Mask  # (h, w)
    palette: Mixture  # the ground's other colours, which show what lies there


@dataclass(frozen=True, slots=True, eq=False)
class LitGround:
    """The ground's palette of colours, and each pixel's distance from it."""

    colours: Float32  # (h, w, 3) log-opponent colours without the ground's own slow shading
    field: Float32  # (b, 3) that shading: coefficients of b functions of the image's coordinates, `slow_bases`
    palette: Mixture  # of the lit ground
    rare: Mask  # (h, w) where the pixel's colour has a small spread over the frame
    squared_distance: Float32  # (h, w) squared Mahalanobis distance to the palette, smoothed; 0 far from rare colours
    sheen: Mask  # (h, w) ground that is brighter than the palette by specular or reflected light
    fall: LightFall | None = None  # a lamp's, or gloss under a sun, one of these functions; None: they are a quadratic
    divided: bool = False  # by edges into surfaces that are lit alike, where a lamp's fall would explain it as one
    on_plane: Float32 | None = None  # (h, w) log odds by other views that a pixel lies on the plane; None: one view
    broad: BroadAreas | None = None  # which count as unlit although the palette has their colours; None: none
    # Of the view as the camera took it, where this one is of a view over plain ground (View.taken).
    taken: "LitGround | None" = None


def fit_lit_ground(
    image_bgr: Image, is_ground: Mask, preset: GroundPreset, fall: LightFall | None = None
) -> LitGround | None:
    """The lit ground of `image_bgr` (h, w, 3), where `is_ground` (h, w) leaves out the marker and the sky.

    fall: of the light of a lamp near by, if there is one. None when too little of the frame is ground, or none of its
    colours is widely spread.
    """
    colours = log_opponent(image_bgr)
    if np.count_nonzero(is_ground) < LEAST_SAMPLES:
        return None
    bases = slow_bases(is_ground.shape, fall)
    field, spread = _wider_spread(colours, bases, is_ground, preset.spread_colours)
    typical, spread = median(spread[is_ground]), smoothed(spread)
    lit = is_ground & (spread > min(WIDE, WIDE_OF_TYPICAL * typical))
    chosen = sampled(shrunk(lit, 1), SAMPLES)
    if len(chosen) < LEAST_SAMPLES:
        return None
    values, slow = colours.reshape(-1, 3)[chosen], bases[chosen]
    labels = None
    for _ in range(preset.field_rounds):
        labels, centres = clusters(values - slow @ field, preset.palette_colours, labels)
        field = field_beside(values - centres[labels], slow, field)
    palette = mixture_of(values - slow @ field, preset.palette_colours, WIDENING, labels)
    if palette is None:
        return None
    flat = colours - (bases @ field).reshape(colours.shape)
    rare = spread < min(RARE, RARE_OF_TYPICAL * typical)
    near = grown(is_ground & rare, NEAR_PX)
    squared = np.zeros(lit.shape, np.float32)
    distances = nearest_squared_distance(flat[near], palette.centres, palette.covariances)
    squared[near] = np.minimum(distances, MOST_DISTANCE)
    squared_distance = np.asarray(cv2.GaussianBlur(squared, (0, 0), SMOOTHING_PX), dtype=np.float32)
    sheen = sheen_on(flat, squared_distance, is_ground, palette)
    return LitGround(flat, field, palette, rare, squared_distance, sheen, fall)


def ground_colours(image_bgr: Image, ground: LitGround, window: Window) -> Float32:
    """(h, w, 3) log-opponent colours of a window of the frame at another scale, without the ground's slow shading.

    image_bgr: the whole frame at that scale. Sheen takes the palette's colours.
    """
    colours = log_opponent(image_bgr[window])
    flat = colours - (slow_bases(image_bgr.shape[:2], ground.fall, window) @ ground.field).reshape(colours.shape)
    sheen = resized(ground.sheen, image_bgr.shape[1::-1])[window]
    return without_sheen(flat, sheen, ground.palette)


def lit_rgb(ground: LitGround) -> Float:
    """(3,) mean linear RGB of the lit ground, as the camera took it."""
    palette = (ground.taken or ground).palette
    return np.asarray(np.average(linear_rgb(palette.centres), axis=0, weights=palette.weights))


def as_taken(view: View, ground: LitGround) -> tuple[View, LitGround]:
    """A view and the ground that was fitted to it, or both as the camera took the picture, with its exposure, the fall
    of light and what the ground mirrors, where they are over plain ground.
    """
    return (view, ground) if view.taken is None or ground.taken is None else (view.taken, ground.taken)


def with_on_plane(ground: LitGround, on_plane: Float32) -> LitGround:
    """The ground with the evidence of other views: log odds (h, w) that a pixel lies on the plane.

    What does, and is brighter than the palette, is light that something reflects onto it, and counts as sheen.
    """
    centres = ground.palette.centres
    brightest = float(centres[ground.palette.weights > COMMON, 0].max(initial=float(centres[:, 0].min())))
    glow = (on_plane > ON_PLANE) & (ground.colours[..., 0] > brightest + BRIGHTER)
    return replace(ground, on_plane=on_plane, sheen=ground.sheen | cleaned(glow))


def unlit_mask(ground: LitGround, is_ground: Mask, least_px: int) -> Mask:
    """(h, w) objects and shadows: compact areas of at least `least_px` pixels that the lit ground does not explain."""
    unexplained = ground.rare & (ground.squared_distance > UNLIT_DISTANCE) & ~ground.sheen
    if ground.on_plane is not None:
        unexplained |= (ground.on_plane < OFF_PLANE) & (ground.squared_distance > UNUSUAL_DISTANCE)
    if ground.broad is not None:
        unexplained |= ground.broad.mask
    return large_areas(cleaned(is_ground & unexplained), least_px)


def with_unlit_on_average(unlit: Mask, view: View) -> Mask:
    """(h, w) `unlit` (h, w) of `view`, and the areas whose mean colour is not the ground's, as their pixels' may be.

    A coarse-grained ground, such as brick or gravel, has specks of nearly every colour, and explains a plain object
    pixel by pixel; averaged, its colours are few. Only what is thicker than the averages' blur is added.
    """
    small = view.scaled(round(view.size[0] * AVERAGED))
    ground = fit_lit_ground(small.image_bgr, small.is_ground, COARSE)
    if ground is None:
        return unlit
    averaged = unlit_mask(ground, small.is_ground, LEAST_AVERAGED_PX)
    whole = resized(averaged, view.size)
    reach = round(1 / AVERAGED)
    thick = grown(shrunk(whole & view.is_ground & ~grown(unlit, 1), reach), reach)
    return unlit | (thick & view.is_ground)


def _wider_spread(colours: Float32, bases: Float32, is_ground: Mask, count: int) -> tuple[Float32, Float32]:
    """(b, 3) the slow field, or zeros, whichever spreads the ground's colours more widely; and that spread (h, w)."""
    chosen, cells = sampled(is_ground, SAMPLES), _cells(is_ground.shape).ravel()
    values, slow = colours.reshape(-1, 3)[chosen], bases[chosen]

    def typical(labels: NDArray[np.intp]) -> float:
        return median(_spreads(labels, cells[chosen])[labels])

    trend = robust_trend(values, slow)
    labels, centres = clusters(values, count)
    flat_labels, flat_centres = clusters(values - slow @ trend, count, labels)
    field = np.zeros_like(trend)
    if typical(flat_labels) > typical(labels):
        field, centres = trend, flat_centres
    labels = nearest_centres(colours.reshape(-1, 3) - bases @ field, centres)
    inside = is_ground.ravel()
    return field, _spreads(labels[inside], cells[inside], len(centres))[labels].reshape(is_ground.shape)


def _cells(shape: tuple[int, ...]) -> NDArray[np.intp]:
    """(h, w) which of the frame's cells a pixel lies in."""
    (height, width), (columns, rows) = shape, CELLS
    return (np.arange(height) * rows // height)[:, None] * columns + np.arange(width) * columns // width


def _spreads(labels: NDArray[np.intp], cells: NDArray[np.intp], count: int = 0) -> Float32:
    """(k,) spread of each cluster's pixels (n,): the perplexity of their distribution over the n seen cells, over n."""
    count, places = max(count, int(labels.max()) + 1), CELLS[0] * CELLS[1]
    counts = np.bincount(labels * places + cells, minlength=count * places).reshape(count, places)
    total = counts.sum(axis=0)
    seen = total > SEEN_SHARE * total.max()
    density = counts[:, seen] / total[seen]
    share = density / np.maximum(density.sum(axis=1, keepdims=True), 1e-9)
    perplexity = np.exp(-(share * np.log(share + 1e-12)).sum(axis=1))
    return np.asarray(perplexity / np.count_nonzero(seen), dtype=np.float32)
