"""Two lights: the unary costs of each one's shadow and of their overlap, and which pixels lie in which shadow."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import SHIFT_NOISE, shadow_ratio, shift_of_ratio
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.costs import Costs, cost_of_distance
from ashe_live.light.labels.materials import (
    SHADED_SHARES,
    Materials,
    cost_of_shift,
    materials_of,
    object_cost,
    share_of_light_lost,
)
from ashe_live.light.pixels.areas import large_areas, majority, smoothed
from ashe_live.light.pixels.mixtures import UNEXPLAINED, nearest_squared_distance
from ashe_live.light.shape.predicted import Predicted

# Least shadow ratio where both lights are blocked: the sky leaves more light than that.
LEAST_AMBIENT = 0.01
NOISE_SIGMAS = 2.0  # by which contributions that add up to more than all light may do so by noise
# Each light's shadow alone must hold at least this fraction of the region's unlit pixels, and this many of them.
LEAST_ALONE, LEAST_ALONE_PX = 0.04, 30
COST_PER_PX, FARTHEST_PX = 1.0, 10.0  # extra cost per pixel outside of a predicted shadow, and its limit
CLEARLY, NOT_SHADED = 6.0, 12.0  # squared distances, in units of the shift's noise
MOST_ASKED = 1000  # unlit pixels by which pairs of shifts are compared


def ratio_of_both(first: Float, second: Float) -> Float:
    """(3,) the shadow ratio where both lights are blocked, by those of each, linear RGB, as contributions add up; none
    is below 0 where they are exact.
    """
    return first + second - 1


def likeliest_pairs(region: Region, ground: LitGround, shifts: Sequence[Float], count: int) -> list[tuple[int, int]]:
    """The pairs of shifts that together explain the region's unlit colours best, neither of them superfluous.

    shifts: (3,) each. Returns at most `count` pairs of indices, the best first.
    """
    colours = region.colours[region.unlit]
    if not len(colours):
        return []
    colours = colours[:: len(colours) // MOST_ASKED + 1]
    noise = np.diag(SHIFT_NOISE**2).astype(np.float32)

    def missed(shift: Float) -> Float32:
        shaded = ground.palette.centres + shift.astype(np.float32)
        return np.minimum(nearest_squared_distance(colours, shaded, noise), NOT_SHADED)

    alone, ratios = [missed(shift) for shift in shifts], [shadow_ratio(ground, shift) for shift in shifts]
    found = []
    for i, j in combinations(range(len(shifts)), 2):
        exclusive = (np.count_nonzero((a < CLEARLY) & (a < b)) for a, b in ((alone[i], alone[j]), (alone[j], alone[i])))
        ratio = ratio_of_both(ratios[i], ratios[j])
        if ratio.min() > LEAST_AMBIENT and min(exclusive) >= LEAST_ALONE * len(colours):
            together = missed(shift_of_ratio(ground, ratio))
            found.append((float(np.minimum(np.minimum(alone[i], alone[j]), together).mean()), (i, j)))
    return [pair for _, pair in sorted(found)[:count]]


def materials_of_each(region: Region, ground: LitGround, shifts: Sequence[Float]) -> Materials | None:
    """The materials of the shadow of one light or of two, by their shifts (3,); None as `materials_of_two`."""
    first, *others = (materials_of(region, ground, shift) for shift in shifts)
    return materials_of_two(region, ground, first, others[0]) if others else first


def materials_of_two(region: Region, ground: LitGround, first: Materials, second: Materials) -> Materials | None:
    """The materials of two lights' shadows, the deeper one first; None where both together would leave no light.

    Where they leave none by less than their shifts' noise, the least is left: a camera's tone curve deepens shadows.
    """
    if first.shift[0] > second.shift[0]:
        first, second = second, first
    ratios = [shadow_ratio(ground, each.shift) for each in (first, second)]
    ratio, noise = ratio_of_both(*ratios), SHIFT_NOISE[0] * np.hypot(*ratios)
    if (ratio < -NOISE_SIGMAS * noise).any():
        return None
    both = shift_of_ratio(ground, np.maximum(ratio, LEAST_AMBIENT))
    cost_of_both = cost_of_shift(region, ground, both, SHADED_SHARES)
    layers = np.stack([first.shaded, second.shaded, cost_of_both])
    shares = np.stack([first.light_lost, second.light_lost, share_of_light_lost(region, ground, both)])
    light_lost = np.take_along_axis(shares, layers.argmin(axis=0)[None], axis=0)[0]
    return Materials(
        shifts=(first.shift, second.shift, both),
        lit=np.minimum(first.lit, second.lit),
        shaded=layers.min(axis=0),
        contact=np.minimum(np.minimum(first.contact, second.contact), cost_of_both),
        light_lost=light_lost,
        layers=tuple(layers),
        other_ground=region.surroundings,
    )


def separated_shadows(materials: Materials, shadow: Mask, fitted: Predicted | None = None) -> tuple[Mask, ...]:
    """The first and the second light's shadows (h, w), which overlap where both are blocked; empty for one light.

    Without a fit, colours alone decide; with one, `fitted`, only those near its outlines.
    """
    if not materials.layers:
        return ()
    first, second, both = (smoothed(np.minimum(layer, UNEXPLAINED)) for layer in materials.layers)
    if fitted is not None and len(fitted.parts) == 2:
        one, other = fitted.parts
        first = first + cost_of_distance(one & ~other, COST_PER_PX, FARTHEST_PX)
        second = second + cost_of_distance(other & ~one, COST_PER_PX, FARTHEST_PX)
        both = both + cost_of_distance(one & other, COST_PER_PX, FARTHEST_PX)
    label = np.argmin([first, second, both], axis=0)
    parts = tuple(majority(shadow & ((label == light) | (label == 2)), 5) for light in (0, 1))
    return tuple(large_areas(part, LEAST_ALONE_PX) for part in parts)


def are_two_shadows(parts: tuple[Mask, ...]) -> bool:
    """Whether there are two shadows and each has pixels that the other does not cover."""
    if len(parts) != 2:
        return False
    one, other = parts
    return bool(min(np.count_nonzero(one & ~other), np.count_nonzero(other & ~one)) >= LEAST_ALONE_PX)


def cost_reduction(region: Region, materials: Materials, split: Split) -> float:
    """The mean reduction of unary cost per unlit pixel by the split, against labelling all as lit ground."""
    masks = Predicted(split.object_mask, split.shadow_mask, split.parts)
    costs = Costs(region, materials, object_cost(region, split.object_mask))
    nothing = np.zeros_like(split.object_mask)
    saved = costs.of(Predicted(nothing, nothing, (nothing, nothing))) - costs.of(masks)
    return saved / max(int(region.unlit.sum()), 1)
