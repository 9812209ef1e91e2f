"""How much darker a shadow is than ground from which the object hides as much of the sky, but not the light.

Beside an object the ground is darker under an even sky, too, which looks like the shadow of a high light. What a light
adds to that is seen by comparing ground inside of its shadow and outside with as much sky in view.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import GOLDEN_ANGLE_RAD, Float, Float32, Mask, median, unit_circle
from ashe_live.core.proxy import Proxy
from ashe_live.light.explanation.judgement.context import reach_m
from ashe_live.light.pixels.areas import distance_to
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View, Window
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import outline, outlines, painted, shadow_outline

# Directions by which the sky is counted. Each sends as much light to level ground: they are even on the ground's disc,
# as the seeds of a sunflower (Vogel, "A better way to construct the sunflower head", 1979).
SKY = 32
# Ground is compared with ground that sees the same part of the sky, but for these steps.
STEPS_OF_SKY = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.87, 0.92, 0.96, 0.985)
AROUND_SIZES = 2.2  # of the body's size: ground farther from its foot is not compared
WITHIN_PX, WITHOUT_PX = 1.5, 2.5  # from a shadow's border, which is blurred
BESIDE_BODY_PX = 3.0  # pixels nearer to the object than this may belong to it
FEWEST_PX = 5  # inside and outside that see the same part of the sky
AROUND = 24  # points on a ring around the body
# Across and down, of the same shape as a shadow, and the share of their pixels that have to be lit ground.
PLACES, LIT_SHARE = 9, 0.6
# Least share of its seeming depth that a light's shadow has beside ground which sees as much sky. Stated: right answers
# have 0.33 and more, cloudy skies 0.1 to 0.25 (docs/maths, "Confidence").
LEAST_SHARE = 0.3
# Sigmas, of what a pattern makes of a depth, by which it must fall short of what it seems. Stated.
MISSING_SIGMAS = 2.0


class Depth(NamedTuple):
    """How much darker a shadow is than ground that sees as much sky, in log brightness: 0 for none."""

    value: float
    sigma: float  # of its error, as lit ground of the shadow's shape is not as bright in all places: a pattern's


def depths_beyond_sky(view: View, proxy: Proxy, lights: Float) -> list[Depth | None]:
    """How much darker the body's shadow in each light is than ground that sees as much sky.

    Convex `proxy` stands on the ground; lights (l, 4): homogeneous points, marker frame. None where too little of the
    shadow, or of ground to compare it with, is in `view`.
    """
    window = _window_around(proxy, view)
    if window is None:
        return [None] * len(lights)
    view = view.cut(window)
    masks = painted(outlines(proxy, lights, view), view.is_ground.shape)
    is_ground = view.is_ground & (distance_to(masks.body) > BESIDE_BODY_PX)
    is_lit = is_ground & (distance_to(masks.shadow) > WITHOUT_PX)
    brightness = log_opponent(view.image_bgr)[..., 0]
    sky = np.digitize(_sky_in_view(proxy, view), STEPS_OF_SKY)
    shadows = masks.parts or (masks.shadow,)
    cores = [is_ground & shadow & (distance_to(~(shadow | masks.body)) > WITHIN_PX) for shadow in shadows]
    return [_depth(brightness, sky, core, is_lit) for core in cores]


def is_of_sky_alone(depths: Sequence[Depth | None], seeming: Sequence[float], least_share: float = LEAST_SHARE) -> bool:
    """Whether the shadows of these depths, by `depths_beyond_sky`, are no lights', but what a body hides of the sky.

    seeming: how much darker than lit ground each seems to be, in log brightness. False where no depth is known, where
    all that are known make up `least_share` of what seems or more, and where a pattern may hide what is missing.
    """
    known = [(depth, seems) for depth, seems in zip(depths, seeming, strict=True) if depth is not None]
    if not known:
        return False
    there, seems = sum(depth.value for depth, _ in known), sum(seems for _, seems in known)
    sigma = math.hypot(*(depth.sigma for depth, _ in known))
    return there < least_share * seems and seems - there > MISSING_SIGMAS * sigma


def _window_around(proxy: Proxy, view: View) -> Window | None:
    """The part of the picture that shows the ground around a body; None where nothing of it is in view."""
    radius_m = AROUND_SIZES * max(proxy.height_m, 2 * reach_m(proxy))
    ring = proxy.foot_marker + radius_m * np.column_stack([unit_circle(AROUND), np.zeros(AROUND)])
    seen = outline(view.camera, view.T_cam_marker, ring)
    if seen is None:
        return None
    low = np.clip(np.floor(seen.min(axis=0)), 0, view.size).astype(int)
    high = np.clip(np.ceil(seen.max(axis=0)), 0, view.size).astype(int)
    return None if (high <= low).any() else (slice(low[1], high[1]), slice(low[0], high[0]))


def _sky_in_view(proxy: Proxy, view: View) -> Float32:
    """(h, w) the share of an even sky's light that reaches the ground past the body."""
    distance, turn = np.sqrt((np.arange(SKY) + 0.5) / SKY), GOLDEN_ANGLE_RAD * np.arange(SKY)
    directions = np.column_stack([distance * np.cos(turn), distance * np.sin(turn), np.sqrt(1 - distance**2)])
    points, shape = proxy.points_marker(AROUND), view.is_ground.shape
    hidden = np.zeros(shape, np.uint8)
    for light in at_infinity(directions):
        hidden += painted([shadow_outline(view.camera, view.T_cam_marker, points, light)], shape).body.view(np.uint8)
    return np.asarray(1 - hidden / SKY, np.float32)


def _depth(brightness: Float32, sky: NDArray[np.intp], core: Mask, is_lit: Mask) -> Depth | None:
    """By how much less `brightness` (h, w) is in `core` than where `is_lit` at the same step of `sky`, (h, w) each.

    None where there is too little of either.
    """
    weights, differences = [], []
    for step in np.unique(sky[core]):
        inside, outside = (brightness[mask & (sky == step)] for mask in (core, is_lit))
        if min(len(inside), len(outside)) >= FEWEST_PX:
            weights.append(min(len(inside), len(outside)))
            differences.append(float(np.median(outside) - np.median(inside)))
    if not weights:
        return None
    return Depth(float(np.average(differences, weights=weights)), _scatter(brightness, core, is_lit))


def _scatter(brightness: Float32, core: Mask, is_lit: Mask) -> float:
    """By how much the median `brightness` (h, w) of lit ground differs between places of the shape of `core`.

    Half of the interval that holds 68 %, as other things stand in some places, which are no pattern. 0 where there are
    not two places, so that a pattern cannot be told.
    """
    rows, columns = np.nonzero(core)
    height, width = core.shape
    core_px, brightness, is_lit = rows * width + columns, brightness.ravel(), is_lit.ravel()
    medians = []
    for down in np.linspace(-rows.min(), height - 1 - rows.max(), PLACES).astype(int):
        for right in np.linspace(-columns.min(), width - 1 - columns.max(), PLACES).astype(int):
            place = core_px + (down * width + right)
            lit = brightness[place][is_lit[place]]
            if len(lit) >= LIT_SHARE * len(rows):
                medians.append(median(lit))
    spread = np.subtract(*np.quantile(np.array(medians, np.float32), (0.84, 0.16))) if len(medians) > 1 else 0.0
    return float(spread / 2)
