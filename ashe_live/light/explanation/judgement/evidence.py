"""Evidence: the features of an explanation by which its probability of being right is judged."""

import math
from collections.abc import Mapping

import numpy as np

from ashe_live.core.arrays import Float32, Mask, upper_median
from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.explanation import LIKELY_FAMILIES, Explanation
from ashe_live.light.explanation.judgement.shading import Shading, shading_of
from ashe_live.light.ground.regions import Region
from ashe_live.light.ground.shadow_shift import hue_of
from ashe_live.light.labels.materials import Materials
from ashe_live.light.pixels.areas import distance_to, grown, shrunk, window_around
from ashe_live.light.shape.light_points import towards
from ashe_live.light.shape.predicted import Predicted

# The ring on either side of an outline where its sharpness is measured; the outline's own pixels are mixed.
RING_PX = (1.0, 4.0)
BESIDE_OBJECT_PX = 3.0  # pixels nearer to the object than this may belong to it
WITHIN_PX = 1.5  # from a shadow's outline, whose pixels are mixed, to its inside
# The ground in shadow explains a colour whose unary cost is below the first and that lacks at least the second as a
# share of the light that the shadow takes: what lacks less may be the rim of a shadow.
EXPLAINED, DEEP = 0.0, 0.7
FLAT = 0.7  # log of breadth over height above which a body counts as flat
# A strongly lit object may show no shading in the picture: where it is overexposed, translucent or painted.
LEAST_CONTRAST = -0.5
LEAST_STEP_COST = 0.1  # lower costs of outlines than this count as equal
# Sine of a light's elevation below which level ground receives so little of it that a clear shadow is hardly its own.
LOW_SINE = 0.3
FEWEST_SHADED = 15  # pixels inside a shadow that are needed to measure its evenness

# The features, and the sign with which physics lets each count for an explanation (docs/maths, "Evidence").
SIGNS: Mapping[str, int] = {
    "misfit": -1,
    "steps": -1,
    "family": -1,
    "uneven": -1,
    "clear shadow": 1,
    "flat": -1,
    "contrast": 1,
    "sunlit": 1,
    "hue": -1,
    "brightness": -1,
    "short": -1,
    "long": -1,
    "missed": -1,
    "shaded": 1,
    "in shadow": -1,
    "lit": -1,
    "edge": 1,
    "border": -1,
    "second": -1,
    "grazing": -1,
    "constrained": 1,
    "agreeing": 1,
    "sheet": 1,
}


def evidence(explanation: Explanation) -> dict[str, float]:
    """The features of an explanation that its picture shows; docs/maths, "Evidence", defines each."""
    alignment, shading = explanation.alignment, _shading(explanation)
    return {
        "misfit": math.log(max(alignment.misfit_px, 0.05) / alignment.placed.object_px),
        **of_steps_and_families(explanation),
        "uneven": _unevenness(explanation),
        "grazing": max(LOW_SINE - float(explanation.lights[0].to_light_marker[2]), 0.0),
        "clear shadow": alignment.clear_shadow,
        "flat": _flatness(explanation),
        "contrast": max(shading.contrast, LEAST_CONTRAST),
        "sunlit": math.asinh(shading.sunlit),
        "in shadow": _share_in_shadow(explanation),
        "lit": _lit_share(explanation),
        **appearance(explanation.region, explanation.materials, explanation.predicted),
    }


def of_steps_and_families(explanation: Explanation) -> dict[str, float]:
    """How far the worse of both outlines lies from steps of light; by how much the light depends on the family, rad."""
    steps, foot = explanation.steps, explanation.lit.body.frame.origin_marker
    light = towards(explanation.lights[0].light, np.array([*foot, 0.0]))
    others = [angle_between(light, body.to_lights_marker[0]) for body in explanation.bodies[:LIKELY_FAMILIES]]
    return {
        "steps": math.log(max(steps.body, steps.shadow, LEAST_STEP_COST)),
        "family": float(np.median(others)) if others else 0.0,
    }


def _unevenness(explanation: Explanation) -> float:
    """Standard deviation inside the shadow of the share of its light that a pixel lacks; 0 where too little is seen."""
    lost = explanation.materials.light_lost[shadow_core(explanation.region, explanation.predicted)]
    return float(np.std(lost, dtype=np.float64)) if len(lost) >= FEWEST_SHADED else 0.0


def _flatness(explanation: Explanation) -> float:
    """Log of the body's breadth over its height, less FLAT; 0 for a body that is not flat."""
    x, y, z, radius, half = explanation.proxy.spheroids_marker.T
    breadth = 0.5 * (np.ptp([x - radius, x + radius]) + np.ptp([y - radius, y + radius]))
    return max(math.log(max(breadth, 1e-9) / max((z + half).max(), 1e-9)) - FLAT, 0.0)


def _shading(explanation: Explanation) -> Shading:
    lights = [light.light for light in explanation.lights]
    shadow_ratios = [math.exp(shift[0]) for shift in explanation.shifts]
    return shading_of(explanation.region, explanation.predicted.body, explanation.proxy, lights, shadow_ratios)


def appearance(region: Region, materials: Materials, masks: Predicted) -> dict[str, float]:
    """The features that need no fit: how the picture looks where `masks` place the object and its shadow."""
    brightness = float(materials.shift[0])
    unlit = region.unlit
    if materials.other_ground is not None and region.faint is not None:
        # Nearly lit ground needs no explanation; what is dark enough for the shadow of another light does.
        unlit = unlit & ~(materials.other_ground & region.faint)
    size = max(_pixels(unlit), 1)
    longer = math.log(max(_pixels(masks.shadow) / max(_pixels(masks.body), 1), 1e-3))
    return {
        "hue": hue_of(materials.shift),
        "brightness": max(brightness + 0.5, 0.0),
        "short": max(-longer - 1.0, 0.0),
        "long": max(longer, 0.0),
        "missed": math.log(0.02 + _pixels(unlit & ~masks.whole) / size),
        "shaded": _mean((materials.lit - materials.shaded)[masks.shadow]),
        "edge": min(_sharpness(region, materials, masks), 1.0),
        "border": _border_share(masks.shadow, masks.body),
        "second": materials.lights - 1.0,
    }


def shadow_core(region: Region, masks: Predicted) -> Mask:
    """(h, w) the inside of a shadow: on the ground, away from the shadow's outline and from the object."""
    core = np.zeros_like(masks.shadow)
    window = window_around(masks.shadow, math.ceil(2 * BESIDE_OBJECT_PX))
    shadow, body = masks.shadow[window], masks.body[window]
    clear = region.is_ground[window] & (distance_to(body) > BESIDE_OBJECT_PX)
    core[window] = shadow & clear & (distance_to(~(shadow | body)) > WITHIN_PX)
    return core


def _share_in_shadow(explanation: Explanation) -> float:
    """Fraction of the object's pixels, without its rim, that the ground in the same shadow explains."""
    materials = explanation.materials
    core = shrunk(explanation.predicted.body, 1) & explanation.region.is_ground
    as_shadow = (materials.contact < EXPLAINED) & (materials.light_lost > DEEP) & core
    return _pixels(as_shadow) / max(_pixels(core), 1)


def _lit_share(explanation: Explanation) -> float:
    """Fraction of the object's and the shadow's pixels that the lit ground explains."""
    region = explanation.region
    whole = explanation.predicted.whole & region.is_ground
    return _pixels(whole & ~region.unlit) / max(_pixels(whole), 1)


def _sharpness(region: Region, materials: Materials, masks: Predicted) -> float:
    """Share of the light that the shadow takes which comes back across its predicted outline: 1 for a sharp edge."""
    low, high = RING_PX
    # A window that holds the ring around the shadow, and all that distances in the ring are measured from.
    window = window_around(masks.shadow, math.ceil(2 * high))
    shadow, body, fraction = masks.shadow[window], masks.body[window], materials.light_lost[window]
    whole = shadow | body
    within, without = distance_to(~whole), distance_to(whole)
    clear = region.is_ground[window] & (distance_to(body) > BESIDE_OBJECT_PX)
    inner = shadow & clear & (within > low) & (within <= high)
    outer = clear & (without > low) & (without <= high) & grown(shadow, int(high))
    return _median(fraction[inner]) - _median(fraction[outer])


def _median(values: Float32) -> float:
    """The upper median; 0 of five values or fewer."""
    return upper_median(values) if len(values) > 5 else 0.0


def _mean(values: Float32) -> float:
    return float(values.mean()) if len(values) else 0.0


def _border_share(mask: Mask, other: Mask) -> float:
    """Fraction of the pixels just outside `mask` that lie in `other`; 1 for an empty mask."""
    border = grown(mask, 1) & ~mask
    return _pixels(border & other) / _pixels(border) if border.any() else 1.0


def _pixels(mask: Mask) -> int:
    return int(np.count_nonzero(mask))
