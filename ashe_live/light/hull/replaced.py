"""Explanations by families that a hull replaces: those of the same object and the same shadow."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.light.shape.predicted import predicted
from ashe_live.light.views.joint import JointExplanation

# Of the pixels that either of two explanations takes for the object, those that both do; of shadows too.
SAME_SHARE = 0.5


def without_replaced(several: Sequence[tuple[JointExplanation, float]]) -> list[tuple[JointExplanation, float]]:
    """Explanations with their log odds, without those by families of an object and shadow that another's hull explains.

    A hull stands where no family explains the silhouettes. What families make of the same silhouettes, with lights
    degrees apart, is no other answer: it would take probability from the hull's, and may outweigh it together.
    """
    hulls = [each for each, _ in several if each.joint.hull is not None]
    return [
        (each, odds)
        for each, odds in several
        if each.joint.hull is not None or not any(_is_replaced(each, hull) for hull in hulls)
    ]


def _is_replaced(family: JointExplanation, hull: JointExplanation) -> bool:
    """Whether in the hull's region both have mostly the same object and the same shadow."""
    region, split, lit = hull.joint.region, hull.joint.split, family.joint.alignment.placed.lit
    if len(lit.lights) != 1:
        return False
    seen = predicted(lit.body.proxy, lit.lights, region.view)
    pairs = ((seen.body, split.object_mask), (seen.shadow, split.shadow_mask))
    return all(_shared(mask & region.is_ground, other) > SAME_SHARE for mask, other in pairs)


def _shared(one: Mask, other: Mask) -> float:
    """The intersection of two masks over their union; 0 for none."""
    return int(np.count_nonzero(one & other)) / max(int(np.count_nonzero(one | other)), 1)
