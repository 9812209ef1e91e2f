"""A second light's shadow that mostly lies within the first one's, where it is a step from shaded to darker ground.

Two lamps over a table, or the sun and its mirror image in a window, often cast one shadow across the other. What is
left of the second one outside of the first is too little to be found by itself. So the known shadow is raised to the
level of lit ground, and the body's shadows are searched for on all of the ground at once.
"""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.explanation.searches.shadow_search import (
    BESIDE_PX,
    LEAST_PX,
    LENGTHS,
    PALEST,
    ShadowCandidate,
    candidates_on,
    unevenness,
)
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.shadow_shift import shadow_ratio, shift_near, shift_of_ratio
from ashe_live.light.labels.two_lights import LEAST_AMBIENT
from ashe_live.light.pixels.areas import grown, shrunk
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.predicted import predicted

STEEP = 0.03, 0.12, 0.25  # lengths of shadows of high lights, which hardly reach beyond another light's
BORDER_PX = 1  # of the known shadow and of the body, which mix colours


@dataclass(frozen=True, slots=True, eq=False)
class OverlappingShadow:
    """A candidate for a shadow that overlaps a known one, and how each of the two shifts the ground's colours."""

    candidate: ShadowCandidate
    known_shift: Float  # (3,) where the known light alone is blocked
    shift: Float  # (3,) where the candidate's alone is


def overlapping_shadows(
    proxy: Proxy, known_lights: Float, coarse: View, ground: LitGround, count: int
) -> list[OverlappingShadow]:
    """Up to `count` candidates for a body's shadow on lit ground and on that in its known shadow, the clearest first.

    known_lights: (l, 4) homogeneous points, marker frame. coarse: the view that `ground` was fitted to.
    """
    known = predicted(proxy, known_lights, coarse)
    lit = coarse.is_ground & ~grown(known.whole, BESIDE_PX)
    shaded = shrunk(known.shadow, BORDER_PX) & coarse.is_ground & ~grown(known.body, BORDER_PX)
    if min(np.count_nonzero(lit), np.count_nonzero(shaded)) < LEAST_PX:
        return []
    uneven = unevenness(ground, lit, known.body)
    pale = shaded & (uneven[..., 0] >= np.median(uneven[shaded, 0]))
    level = uneven[pale].mean(axis=0)
    known_shift = shift_near(ground.colours[pale], ground, np.asarray(level, dtype=np.float64))
    if known_shift is None or known_shift[0] > PALEST:
        return []
    uneven[shaded] -= level
    found = candidates_on(proxy, known_lights, coarse, lit | shaded, uneven, count, (*STEEP, *LENGTHS))
    shifts = [_own_shift(candidate, known_shift, lit, shaded, uneven, ground) for candidate in found]
    return [
        OverlappingShadow(candidate, known_shift, shift)
        for candidate, shift in zip(found, shifts, strict=True)
        if shift is not None and shift[0] <= PALEST
    ]


def _own_shift(
    candidate: ShadowCandidate, known_shift: Float, lit: Mask, shaded: Mask, uneven: Float32, ground: LitGround
) -> Float | None:
    """(3,) the shift of the candidate's light alone; None where too little of it is seen.

    uneven: (h, w, 3) log-opponent differences from ground that is lit, or `shaded` (h, w) by the known light alone.
    """
    within, beyond = candidate.area & shaded, candidate.area & lit
    if np.count_nonzero(beyond) >= np.count_nonzero(within):
        return shift_near(ground.colours[beyond], ground, candidate.difference)
    darker = np.asarray(uneven[within].mean(axis=0), dtype=np.float64)
    of_both = shift_near(ground.colours[within], ground, known_shift + darker)
    if of_both is None:
        return None
    # Light adds up: what the second takes away in the first one's shadow, it takes away beside it as well.
    ratio = 1 + shadow_ratio(ground, of_both) - shadow_ratio(ground, known_shift)
    return shift_of_ratio(ground, np.clip(ratio, LEAST_AMBIENT, 1.0))
