"""A second light, once the body and a first light are known: searched where the body may cast another shadow.

It is accepted where the region's unary costs fall by more than the penalty for its parameters, and where the outline of
its shadow coincides with visible borders (docs/maths, "A second light of a known body").
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import without
from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.alignment import COST_PER_PARAMETER
from ashe_live.light.explanation.explain import aligned_explanations, explanation_criterion, proposal_of
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.shadow_search import ShadowCandidate, shadow_candidates
from ashe_live.light.labels.costs import Costs
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.labels.two_lights import are_two_shadows, materials_of_two
from ashe_live.light.shape.predicted import Predicted, predicted, predicted_of

TRIED = 2  # candidates for the second light
# How much a second light must lower the unary costs, and the least mean clarity of its shadow's borders, by which
# `ashe-live bench fit-seconds` counts right and wrong ones (docs/accuracy/sets.md says on which pictures).
LEAST_GAIN, LEAST_CLARITY = 2 * COST_PER_PARAMETER, 0.28
NEAR_RAD = math.radians(10)  # of lights that count as one
PART = 0.8  # of a shadow's pixels: so many lie in another shadow that it is a part of


@dataclass(frozen=True, slots=True, eq=False)
class TriedLight:
    """A second light beside a known one, fitted from a candidate for its shadow."""

    both: Explanation
    number: int  # of the second light among those of `both`
    start: Predicted  # what its candidate predicts in the region, before the fit
    costs: Costs  # of the region

    @property
    def clarity(self) -> float:
        """Mean clarity of its shadow's borders, 0 to 1 (docs/maths, (18))."""
        return float(self.both.alignment.clear_shadows[self.number])

    def gain(self) -> float:
        """How much the region's unary costs fall by it."""
        fitted = self.both.predicted
        alone = min(self.costs.of(_without(self.number, each)) for each in (self.start, fitted))
        return alone - self.costs.of(fitted)

    def is_accepted(self) -> bool:
        """Whether both are enough: LEAST_CLARITY, LEAST_GAIN."""
        return self.clarity >= LEAST_CLARITY and self.gain() > LEAST_GAIN


def with_lights_counted(
    explanations: Sequence[Explanation],
    rough: Sequence[Explanation],
    view: SceneView,
    region_px: int,
    log_odds: Callable[[Explanation], float],
) -> list[Explanation]:
    """Settles the number of lights: drops explanations by two lights where the picture shows one, and tries a second.

    Returns the explanations kept; those with a second light of the likeliest of them come first and replace those by
    one of their two lights. Where the likeliest has two lights, a second is tried for the likeliest by one of these; of
    two pairs, one whose shadows are parts of the other's and explain the same pixels less well is dropped.

    rough: the explanations before refinement, and others. region_px: size in pixels to which a region is scaled.
    log_odds: by which explanations are judged.
    """
    singles = [each for each in [*explanations, *rough] if len(each.lights) == 1]
    kept = [each for each in explanations if len(each.lights) == 1 or _shows_both(each, singles)]
    one = max(kept, key=log_odds, default=None)
    if one is None:
        return kept
    # A region may cut one of two shadows short. From the other light alone, all of it is found in the whole view.
    pairs = [one] if len(one.lights) > 1 else []
    alone = [each for each in kept if is_part_of(one, each)] if pairs else [one]
    known = max(alone, key=log_odds, default=None)
    if known is not None:
        found = shadow_candidates(known.proxy, known.lit.lights, view.coarse, view.ground, TRIED)
        tried = [tried_light(known, candidate, view, region_px) for candidate in found]
        pairs += [light.both for light in tried if light is not None and light.is_accepted()]
    whole, others = _without_cut(pairs), without(kept, pairs)
    return [*whole, *(other for other in others if not any(is_part_of(both, other) for both in whole))]


def _shows_both(both: Explanation, singles: Sequence[Explanation]) -> bool:
    """Whether both shadows are clear, by two lights, and no single one explains the region at a lower criterion."""
    if _are_near(both) or min(both.alignment.clear_shadows) < LEAST_CLARITY:
        return False
    return all(
        explanation_criterion(both) <= explanation_criterion(single)
        for single in singles
        if single.region is both.region
    )


def _are_near(both: Explanation) -> bool:
    """Whether two lights are so near to each other that they are one wide one: a shadow's core and its penumbra."""
    return angle_between(*(light.to_light_marker for light in both.lights)) < NEAR_RAD


def _without_cut(pairs: Sequence[Explanation]) -> list[Explanation]:
    """The explanations by two lights without those that cut short a shadow of one that is left."""
    whole = list(pairs)
    for pair in pairs:
        if any(_cuts_short(pair, other) for other in without(whole, [pair])):
            whole = without(whole, [pair])
    return whole


def _cuts_short(pair: Explanation, whole: Explanation) -> bool:
    """Whether each shadow of a pair is a part of one in `whole`, whose region costs less by `whole`."""
    first = whole.lights[0].to_light_marker
    in_order = sorted(pair.lights, key=lambda light: angle_between(light.to_light_marker, first))
    cut = predicted(pair.proxy, np.array([light.light for light in in_order]), whole.region.view)
    are_parts = all(
        np.count_nonzero(part & other) > PART * np.count_nonzero(part)
        for part, other in zip(cut.parts, whole.predicted.parts, strict=True)
    )
    return are_parts and whole.costs.of(whole.predicted) < whole.costs.of(cut)


def is_part_of(both: Explanation, other: Explanation) -> bool:
    """Whether the other explanation has one light only, which is one of the two lights of `both`."""
    if len(both.lights) < 2 or len(other.lights) > 1:
        return False
    angles = (angle_between(other.lights[0].to_light_marker, light.to_light_marker) for light in both.lights)
    return min(angles) < NEAR_RAD


def tried_light(known: Explanation, candidate: ShadowCandidate, view: SceneView, region_px: int) -> TriedLight | None:
    """A second light from a candidate for its shadow, of an explanation by one; None if its shadow is no other one.

    region_px: size in pixels to which the region of the body with both shadows is scaled.
    """
    ground = view.ground
    lit, shift = known.lit, candidate.shift
    region = candidate.region(lit, view, region_px)
    first, new = (materials_of(region, ground, each) for each in (known.materials.shift, shift))
    materials = materials_of_two(region, ground, first, new)
    if materials is None:
        return None
    second = 1 if materials.shifts[1] is shift else 0
    start = replace(lit, lights=np.insert(lit.lights, second, candidate.light, axis=0))
    fitted = proposal_of(start, region, materials)
    proposal = fitted.proposal
    assert proposal.as_object is not None
    if not are_two_shadows(proposal.split.parts):
        return None
    (both,) = aligned_explanations([fitted])
    if both is None or _are_near(both):
        return None
    return TriedLight(both, second, predicted_of(start, region.view), Costs(region, materials, proposal.as_object))


def _without(light: int, masks: Predicted) -> Predicted:
    """The masks without the shadow of light number `light`."""
    parts = [part if i != light else np.zeros_like(part) for i, part in enumerate(masks.parts)]
    return Predicted(masks.body, np.logical_or(*parts), tuple(parts))
