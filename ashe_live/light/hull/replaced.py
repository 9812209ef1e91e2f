"""Explanations by families that a hull replaces: those of the same object and the same shadow."""

from collections.abc import Sequence

from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.joint.repeated import show_the_same


def without_replaced(several: Sequence[tuple[JointExplanation, float]]) -> list[tuple[JointExplanation, float]]:
    """Explanations with their log odds, without those by families of an object and shadow that another's hull explains.

    A hull stands where no family explains the silhouettes. What families make of the same silhouettes, with lights
    degrees apart, is no other answer: it would take probability from the hull's, and may outweigh it together.
    """
    hulls = [each for each, _ in several if each.joint.hull is not None]
    return [
        (each, odds)
        for each, odds in several
        if each.joint.hull is not None
        or len(each.joint.lights) > 1
        or not any(show_the_same(hull, each) for hull in hulls)
    ]
