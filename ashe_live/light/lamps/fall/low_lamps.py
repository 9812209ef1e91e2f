"""Lamps lower than the top of an object: its shadow has no end, and what seems to be one is something else.

Where such a lamp hardly reaches, the sky that an object hides at its own foot is darker than the shadow, and a shadow
fades before it ends. An explanation that takes either for a shadow's end may fit well. But so near a lamp lights the
ground as no other light does: within some centimetres its light falls to a tenth, and the spot locates it to a
centimetre or two. Where that is lower than the object's top, and not where the explanation has its light, there is
nothing to state, unless the explanation is surer than the ground: uneven paint may look like a spot as well.
"""

import math
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import logit
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.slow_shading import irradiances
from ashe_live.light.lamps.fall.fall_directions import EVERY, INFORMATIVE_DEVIANCE, UNEVEN_DEVIANCE, FallDirections
from ashe_live.light.lamps.fall.fall_off import FallOff, fall_beside
from ashe_live.light.lamps.hypotheses import NEARNESSES
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import lamp_parameters

HEIGHTS = (1.0, 0.7, 0.5)  # of the lamps that are tried, over the object's height
LOWEST_M = 0.04  # of these lamps: no bulb fits below
SPACING = 0.7  # of these lamps, over their height: a spot is about as wide as its lamp is high
MARGIN = 1.5  # over their height, by which they may stand beside the ground that is seen
REACH_M = 0.6  # from the marker, along x and y, of that ground
SHARES = (0.3, 0.6, 0.85, 0.95)  # of all light that are the lamp's, where it is brightest
WIDTH = 1.53  # of a spot at half of its brightness, over its lamp's height: twice the r where (1 + r²)^-1.5 = 1/2
# Deviance of other lights from a low lamp, that chance exceeds once in twenty with three parameters more. The likeliest
# of many lamps exceeds it by chance more often: by twice the logarithm of how many spots there is room for.
ELSEWHERE = 7.8


def is_under_low_lamp(explanation: Explanation, confidence: float, view: View, ground: LitGround, unlit: Mask) -> bool:
    """Whether the ground shows a lamp lower than the explained object, where the explanation has none.

    confidence: of the explanation. view: the one that `ground` was fitted to. unlit: (h, w) what the lit ground does
    not explain. With two lights, the ground shows their sum, and nothing is said.
    """
    if len(explanation.lights) > 1:
        return False
    lit = explanation.lit
    fall_off = fall_beside(lit, view, ground, unlit)
    if fall_off is None:
        return False
    lights = np.vstack([lit.lights[:1], lit.first_light_near((0.0, *NEARNESSES))])
    return low_lamp_elsewhere(fall_off, explanation.proxy.height_m, lamp_parameters(lights), logit(confidence))


def low_lamp_elsewhere(fall_off: FallOff, top_m: float, lights: Float, log_odds: float = 0.0) -> bool:
    """Whether the ground shows a lamp that is lower than `top_m`, and none of some lights.

    lights: (n, 3) displacement and nearness each: an explanation's, as far as it leaves them open. log_odds: of that
    explanation by all but the ground's light, which has to outweigh them.
    """
    some = fall_off.every(EVERY)
    _, deviance = FallDirections(some).likeliest
    if deviance < UNEVEN_DEVIANCE:
        return False
    low_lamps = _lamps(some, top_m * np.array(HEIGHTS))
    if not len(low_lamps):
        return False
    dull = replace(some, gloss=None)  # which is what even light shines on as well, as for `deviance`
    low, even = _least_cost(dull, low_lamps), _least_cost(dull, np.zeros((1, 3)))
    elsewhere = ELSEWHERE + 2 * math.log(max(len(low_lamps) * (SPACING / WIDTH) ** 2, 1.0))
    outweighed = elsewhere + max(2 * log_odds, 0.0)
    # What lamps of ordinary heights explain as well, as they do a table's slow shading, is no low lamp's spot.
    is_spot = even - low > max(INFORMATIVE_DEVIANCE, deviance + elsewhere)
    return is_spot and _least_cost(some, lights) - low > outweighed


def _lamps(fall_off: FallOff, heights_m: Float) -> Float:
    """(n, 3) lamps of some heights (h,) above and beside the ground that is seen, not far from the marker."""
    places = fall_off.samples.places[np.abs(fall_off.samples.places).max(axis=1) < REACH_M]
    found = [np.empty((0, 3))]
    for height in heights_m:
        if height >= LOWEST_M and len(places):
            lowest, highest = places.min(axis=0) - MARGIN * height, places.max(axis=0) + MARGIN * height
            x, y = np.meshgrid(*(np.arange(a, b, SPACING * height) for a, b in zip(lowest, highest, strict=True)))
            found.append(np.column_stack([x.ravel(), y.ravel(), np.ones(x.size)]) / height)
    return np.vstack(found)


def _least_cost(fall_off: FallOff, lights: Float) -> float:
    """Of lights (n, 3), each with the likeliest of SHARES where it is brightest."""
    reference = fall_off.samples.places.mean(axis=0)
    fading = irradiances(reference[None], lights)[0] / irradiances(fall_off.samples.places, lights).max(axis=0)
    shares = [share * fading / (share * fading + 1 - share) for share in SHARES]
    return float(min(fall_off.worst_costs(lights, each, reference).min() for each in shares))
