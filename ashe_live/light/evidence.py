"""Explanations of a region, and what speaks for and against each."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.areas import distance_to, grown, shrunk
from ashe_live.light.associate import Split
from ashe_live.light.fit import Fit
from ashe_live.light.log_colour import Float32
from ashe_live.light.materials import Materials
from ashe_live.light.predicted import Predicted
from ashe_live.light.regions import Region

# The ring on either side of an outline where its sharpness is measured; the outline's own pixels are mixed.
RING_PX = (1.0, 4.0)
BESIDE_OBJECT_PX = 3.0  # what is nearer to the object may be of it
WITHIN_PX = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """A region taken for an object and its shadow, and the light that follows from it."""

    region: Region
    materials: Materials
    split: Split
    fit: Fit
    predicted: Predicted
    own: Float32  # (h, w) cost of the object's colours


EVIDENCE = (
    "misfit",
    "hue",
    "brightness",
    "short",
    "long",
    "shading",
    "missed",
    "edge",
    "border",
    "second",
)


def evidence(explanation: Explanation) -> Float:
    """(10,) numbers in the order of EVIDENCE; docs/maths.md says what each stands for."""
    fit = explanation.fit
    misfit = math.log(max(fit.residual_px, 0.05) / max(fit.object_px, 1.0))
    return np.array([misfit, *appearance(explanation.region, explanation.materials, explanation.predicted)])


def appearance(region: Region, materials: Materials, masks: Predicted) -> Float:
    """(9,) the evidence that needs no fit: how the picture looks where `masks` say object and shadow are."""
    brightness, red_blue, green = materials.shift
    size = max(int(region.unlit.sum()), 1)
    longer = math.log(max(int(masks.shadow.sum()) / max(int(masks.body.sum()), 1), 1e-3))
    return np.array(
        [
            abs(green + 0.25 * red_blue),
            max(brightness + 0.5, 0.0),
            max(-longer - 1.0, 0.0),
            max(longer, 0.0),
            _shading(region, masks),
            math.log(0.02 + int((region.unlit & ~masks.whole).sum()) / size),
            min(_sharpness(region, materials, masks), 1.0),
            _border_share(masks.shadow, masks.body),
            materials.lights - 1.0,
        ]
    )


def shadow_core(region: Region, masks: Predicted) -> Mask:
    """(h, w) where a shadow is whole: on the ground, away from its outline and from the object."""
    return masks.shadow & _clear_of(masks.body, region) & (distance_to(~masks.whole) > WITHIN_PX)


def _sharpness(region: Region, materials: Materials, masks: Predicted) -> float:
    """How much of the shift is lost on the way across the predicted shadow's outline: 1 for a sharp edge."""
    within, without = distance_to(~masks.whole), distance_to(masks.whole)
    clear = _clear_of(masks.body, region)
    low, high = RING_PX
    inner = masks.shadow & clear & (within > low) & (within <= high)
    outer = clear & (without > low) & (without <= high) & grown(masks.shadow, int(high))
    return _median(materials.share[inner]) - _median(materials.share[outer])


def _clear_of(body: Mask, region: Region) -> Mask:
    return region.is_ground & (distance_to(body) > BESIDE_OBJECT_PX)


def _shading(region: Region, masks: Predicted) -> float:
    """Correlation over the object of brightness with the place along the way from its shadow: positive if lit so."""
    body, shadow = masks.body, masks.shadow
    core = shrunk(body, 1) & region.is_ground
    if np.count_nonzero(core) <= 30 or np.count_nonzero(shadow) <= 5:
        return 0.0
    places, shaded = (np.argwhere(mask).astype(np.float64) for mask in (core, shadow))
    away = places.mean(axis=0) - shaded.mean(axis=0)
    along = places @ away
    brightness = region.colours[..., 0][core].astype(np.float64)
    along -= along.mean()
    brightness -= brightness.mean()
    spreads = math.sqrt(along @ along / len(along)), math.sqrt(brightness @ brightness / len(along))
    return float(along @ brightness) / len(along) / (spreads[0] * spreads[1]) if min(spreads) >= 1e-3 else 0.0


def _median(values: Float32) -> float:
    return float(np.median(values)) if len(values) > 5 else 0.0


def _border_share(mask: Mask, other: Mask) -> float:
    """Share of the pixels just outside `mask` that lie in `other`; 1 for an empty mask."""
    border = grown(mask, 1) & ~mask
    return int((border & other).sum()) / int(border.sum()) if border.any() else 1.0
