"""Explanations of a region, and what speaks for and against each."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.explanation.alignment import Alignment
from ashe_live.light.explanation.shading import Shading, shading_of
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import Materials
from ashe_live.light.pixels.areas import distance_to, grown, shrunk, window_around
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.predicted import Predicted

# The ring on either side of an outline where its sharpness is measured; the outline's own pixels are mixed.
RING_PX = (1.0, 4.0)
BESIDE_OBJECT_PX = 3.0  # what is nearer to the object may be of it
WITHIN_PX = 1.5
FLAT = 0.7  # log of breadth over height above which a body is flat
# A picture may show a strongly lit object without its shading: clipped, shining through, painted.
LEAST_CONTRAST = -0.5
LEAST_SPREAD = 1e-3  # of what a correlation can be told of


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """A region taken for an object and its shadow, and the light that follows from it."""

    region: Region
    materials: Materials
    split: Split
    alignment: Alignment
    lights: tuple[FittedLight, ...]
    as_object: Float32  # (h, w) unary cost of the object's colours

    @property
    def predicted(self) -> Predicted:
        return self.alignment.placed.predicted

    @property
    def proxy(self) -> Proxy:
        return self.alignment.placed.lit.body.proxy


EVIDENCE = (
    "misfit",
    "clear body",
    "clear shadow",
    "flat",
    "contrast",
    "sunlit",
    "hue",
    "brightness",
    "short",
    "long",
    "lit side",
    "missed",
    "edge",
    "border",
    "second",
)


def evidence(explanation: Explanation) -> Float:
    """(15,) numbers in the order of EVIDENCE; docs/maths.md says what each stands for."""
    alignment, shading = explanation.alignment, _shading(explanation)
    misfit = math.log(max(alignment.missed_px, 0.05) / alignment.placed.object_px)
    looks = appearance(explanation.region, explanation.materials, explanation.predicted)
    clear = alignment.clear_body, alignment.clear_shadow
    shown = max(shading.contrast, LEAST_CONTRAST), math.asinh(shading.sunlit)
    return np.array([misfit, *clear, _flatness(explanation), *shown, *looks])


def _flatness(explanation: Explanation) -> float:
    """How much flatter than half as high as wide, as a logarithm; 0 of what is not."""
    x, y, z, radius, half = explanation.proxy.spheroids_marker.T
    breadth = 0.5 * (np.ptp([x - radius, x + radius]) + np.ptp([y - radius, y + radius]))
    return max(math.log(max(breadth, 1e-9) / max((z + half).max(), 1e-9)) - FLAT, 0.0)


def _shading(explanation: Explanation) -> Shading:
    lights = [light.to_light_marker for light in explanation.lights]
    left_over = [math.exp(shift[0]) for shift in explanation.materials.shifts[: len(lights)]]
    return shading_of(explanation.region, explanation.predicted.body, explanation.proxy, lights, left_over)


def appearance(region: Region, materials: Materials, masks: Predicted) -> Float:
    """(9,) the evidence that needs no fit: how the picture looks where `masks` say object and shadow are."""
    brightness, red_blue, green = materials.shift
    size = max(_pixels(region.unlit), 1)
    longer = math.log(max(_pixels(masks.shadow) / max(_pixels(masks.body), 1), 1e-3))
    return np.array(
        [
            abs(green + 0.25 * red_blue),
            max(brightness + 0.5, 0.0),
            max(-longer - 1.0, 0.0),
            max(longer, 0.0),
            _lit_side(region, masks),
            math.log(0.02 + _pixels(region.unlit & ~masks.whole) / size),
            min(_sharpness(region, materials, masks), 1.0),
            _border_share(masks.shadow, masks.body),
            materials.lights - 1.0,
        ]
    )


def shadow_core(region: Region, masks: Predicted) -> Mask:
    """(h, w) where a shadow is whole: on the ground, away from its outline and from the object."""
    clear = region.is_ground & (distance_to(masks.body) > BESIDE_OBJECT_PX)
    return masks.shadow & clear & (distance_to(~masks.whole) > WITHIN_PX)


def _sharpness(region: Region, materials: Materials, masks: Predicted) -> float:
    """How much of the shift is lost on the way across the predicted shadow's outline: 1 for a sharp edge."""
    low, high = RING_PX
    # Nothing that counts is farther from the shadow than the ring, or from the ring than what it is measured from.
    near = window_around(masks.shadow, math.ceil(2 * high))
    shadow, body, share = masks.shadow[near], masks.body[near], materials.share[near]
    whole = shadow | body
    within, without = distance_to(~whole), distance_to(whole)
    clear = region.is_ground[near] & (distance_to(body) > BESIDE_OBJECT_PX)
    inner = shadow & clear & (within > low) & (within <= high)
    outer = clear & (without > low) & (without <= high) & grown(shadow, int(high))
    return _median(share[inner]) - _median(share[outer])


def _lit_side(region: Region, masks: Predicted) -> float:
    """Correlation over the object of brightness with the place along the way from its shadow: positive if lit so."""
    core = shrunk(masks.body, 1) & region.is_ground
    places, shaded = _places(core), _places(masks.shadow)
    if places.shape[1] <= 30 or shaded.shape[1] <= 5:
        return 0.0
    along = (places.mean(axis=1) - shaded.mean(axis=1)) @ places
    return _correlation(along, region.colours[..., 0][core])


def _correlation(one: Float | Float32, other: Float | Float32) -> float:
    """Pearson's, of n numbers each; 0 where either hardly varies."""
    a, b = (values - values.mean(dtype=np.float64) for values in (one, other))
    variances = float(a @ a) / len(a), float(b @ b) / len(b)
    return float(a @ b) / len(a) / math.sqrt(variances[0] * variances[1]) if min(variances) >= LEAST_SPREAD**2 else 0.0


def _places(mask: Mask) -> Float:
    """(2, n) rows and columns of the pixels of `mask`."""
    return np.array(np.divmod(np.flatnonzero(mask), mask.shape[1]), dtype=np.float64)


def _median(values: Float32) -> float:
    """The upper one of two; 0 of hardly any."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle]) if len(values) > 5 else 0.0


def _border_share(mask: Mask, other: Mask) -> float:
    """Share of the pixels just outside `mask` that lie in `other`; 1 for an empty mask."""
    border = grown(mask, 1) & ~mask
    return _pixels(border & other) / _pixels(border) if border.any() else 1.0


def _pixels(mask: Mask) -> int:
    return int(np.count_nonzero(mask))
