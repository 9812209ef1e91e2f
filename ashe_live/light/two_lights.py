"""Two lights: what their shadows cost alone and where they overlap, and which pixel lies in which."""

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.areas import distance_to, large_areas, majority, smoothed
from ashe_live.light.ground import LitGround
from ashe_live.light.log_colour import Float32
from ashe_live.light.materials import SHADED_SHARES, Materials, cost_of_shift, share_of_shift
from ashe_live.light.mixtures import UNEXPLAINED
from ashe_live.light.predicted import Predicted
from ashe_live.light.regions import Region
from ashe_live.light.shift import SHIFT_NOISE, shadow_ratio, shift_of_ratio

# What is left of the light where both are blocked, at least: less is no sky.
LEAST_AMBIENT = 0.01
# Of the region's unlit pixels, each light's shadow alone must be at least this share.
LEAST_ALONE, LEAST_ALONE_PX = 0.04, 30
COST_OF_DISTANCE, FARTHEST_PX = 1.0, 10.0
CLEARLY = 6.0


def shifts_of_both(ground: LitGround, first: Float, second: Float) -> Float | None:
    """(3,) the shift where both lights are blocked: what each takes away is missing. None if that leaves no light."""
    ratio = shadow_ratio(ground, first) + shadow_ratio(ground, second) - 1
    return shift_of_ratio(ground, ratio) if ratio.min() > LEAST_AMBIENT else None


def materials_of_two(region: Region, ground: LitGround, first: Materials, second: Materials) -> Materials | None:
    """The region as two lights' shadows, given how it looks as either's alone; None where they hardly both occur."""
    if np.abs((first.shift - second.shift) / SHIFT_NOISE).max() < 2:
        return None
    least = max(LEAST_ALONE_PX, LEAST_ALONE * np.count_nonzero(region.unlit))
    for one, other in ((first, second), (second, first)):
        if np.count_nonzero(region.unlit & (one.shaded < other.shaded) & (one.shaded < CLEARLY)) < least:
            return None
    if first.shift[0] > second.shift[0]:
        first, second = second, first
    both = shifts_of_both(ground, first.shift, second.shift)
    if both is None:
        return None
    cost_of_both = cost_of_shift(region, ground, both, SHADED_SHARES)
    layers = np.stack([first.shaded, second.shaded, cost_of_both])
    shares = np.stack([first.share, second.share, share_of_shift(region, ground, both)])
    share = np.take_along_axis(shares, layers.argmin(axis=0)[None], axis=0)[0]
    return Materials(
        (first.shift, second.shift, both),
        np.minimum(first.lit, second.lit),
        layers.min(axis=0),
        np.minimum(np.minimum(first.contact, second.contact), cost_of_both),
        share,
        tuple(layers),
    )


def parted(materials: Materials, shadow: Mask, fitted: Predicted | None = None) -> tuple[Mask, ...]:
    """The first and the second light's shadow, which share the pixels where both are blocked; none for one light.

    Without a fit, colours alone decide; with one, they decide near its outlines.
    """
    if not materials.layers:
        return ()
    first, second, both = (smoothed(np.minimum(layer, UNEXPLAINED)) for layer in materials.layers)
    if fitted is not None and len(fitted.parts) == 2:
        one, other = fitted.parts
        first = first + _penalty(one & ~other)
        second = second + _penalty(other & ~one)
        both = both + _penalty(one & other)
    label = np.argmin([first, second, both], axis=0)
    parts = tuple(majority(shadow & ((label == own) | (label == 2)), 5) for own in (0, 1))
    return tuple(large_areas(part, LEAST_ALONE_PX) for part in parts)


def are_two(parts: tuple[Mask, ...]) -> bool:
    """Whether each of two shadows has a place of its own."""
    if len(parts) != 2:
        return False
    one, other = parts
    return bool(min(np.count_nonzero(one & ~other), np.count_nonzero(other & ~one)) >= LEAST_ALONE_PX)


def _penalty(mask: Mask) -> Float32:
    return np.asarray(COST_OF_DISTANCE * np.minimum(distance_to(mask), FARTHEST_PX), dtype=np.float32)
