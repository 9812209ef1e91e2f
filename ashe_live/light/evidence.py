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
FEWEST_PX = 8
UNSEEN_SHADOW = 10.0  # the cost of a shadow that is not there


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
    "beyond",
    "edge",
    "depth",
    "unshadowed",
    "border",
    "second",
)


def evidence(explanation: Explanation) -> Float:
    """(13,) numbers in the order of EVIDENCE; docs/maths.md says what each stands for."""
    fit, it = explanation.fit, explanation
    misfit = math.log(max(fit.residual_px, 0.05) / max(fit.object_px, 1.0))
    return np.array([misfit, *appearance(it.region, it.materials, it.predicted, it.own)])


def appearance(region: Region, materials: Materials, masks: Predicted, own: Float32) -> Float:
    """(12,) the evidence that needs no fit: how the picture looks where `masks` say object and shadow are."""
    brightness, red_blue, green = materials.shift
    size = max(int(region.unlit.sum()), 1)
    longer = math.log(max(int(masks.shadow.sum()) / max(int(masks.body.sum()), 1), 1e-3))
    edge, depth, cost = _shadow_in_picture(region, materials, masks, own)
    return np.array(
        [
            abs(green + 0.25 * red_blue),
            max(brightness + 0.5, 0.0),
            max(-longer - 1.0, 0.0),
            max(longer, 0.0),
            _shading(region, masks),
            math.log(0.02 + int((region.unlit & ~masks.whole).sum()) / size),
            math.log(0.02 + int((masks.whole & ~region.unlit & region.is_ground).sum()) / size),
            min(edge, 1.0),
            abs(depth - 1.0),
            min(max(cost, -5.0), 8.0),
            _border_share(masks.shadow, masks.body),
            materials.lights - 1.0,
        ]
    )


def _shadow_in_picture(
    region: Region, materials: Materials, masks: Predicted, own: Float32
) -> tuple[float, float, float]:
    """How sharply the shadow's outline stands out, its depth, and what it costs more than the best label."""
    share, shadow, whole = materials.share, masks.shadow, masks.whole
    within, without = distance_to(~whole), distance_to(whole)
    clear = region.is_ground & (distance_to(masks.body) > BESIDE_OBJECT_PX)
    low, high = RING_PX
    inner = shadow & clear & (within > low) & (within <= high)
    outer = clear & (without > low) & (without <= high) & grown(shadow, int(high))
    inside = shadow & clear & (within > 1.5)
    edge = _median(share[inner]) - _median(share[outer])
    if np.count_nonzero(inside) <= FEWEST_PX:
        return edge, 0.0, UNSEEN_SHADOW
    excess = materials.contact - np.minimum(materials.lit, own)
    return edge, float(np.median(share[inside])), float(excess[inside].mean())


def _shading(region: Region, masks: Predicted) -> float:
    """Correlation over the object of brightness with the place along the way from its shadow: positive if lit so."""
    body, shadow = masks.body, masks.shadow
    core = shrunk(body, 1) & region.is_ground
    if np.count_nonzero(core) <= 30 or np.count_nonzero(shadow) <= 5:
        return 0.0
    away = _centre(core) - _centre(shadow)
    y, x = np.nonzero(core)
    along = x * away[0] + y * away[1]
    brightness = region.colours[..., 0][core]
    if along.std() < 1e-3 or brightness.std() < 1e-3:
        return 0.0
    return float(np.corrcoef(along, brightness)[0, 1])


def _centre(mask: Mask) -> Float:
    y, x = np.nonzero(mask)
    return np.array([x.mean(), y.mean()])


def _median(values: Float32) -> float:
    return float(np.median(values)) if len(values) > 5 else 0.0


def _border_share(mask: Mask, other: Mask) -> float:
    """Share of the pixels just outside `mask` that lie in `other`; 1 for an empty mask."""
    border = grown(mask, 1) & ~mask
    return int((border & other).sum()) / int(border.sum()) if border.any() else 1.0
