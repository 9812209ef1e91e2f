"""An object's shadow, searched for by its shape where no explanation is likely.

On ground of many colours a shadow's may be those of lit ground elsewhere, as a table's dark grain: its pixels do not
stand out one by one, and no split of what does holds a shadow. The object alone stands out, and where it is clear its
body predicts what shadows it can cast.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.explain import Proposal, aligned_explanations
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.second_light import LEAST_CLARITY, NEAR_RAD
from ashe_live.light.explanation.shadow_search import ShadowCandidate, shadow_candidates
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.labels.materials import materials_of, object_cost
from ashe_live.light.labels.relabel import relabelled
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import NO_LIGHTS
from ashe_live.light.shape.predicted import predicted
from ashe_live.light.shape.sight import Sight

BODIES, TRIED = 2, 2  # objects whose shadows are searched for, and candidates for each
CLEAR_BODY = 0.5  # mean clarity of an outline from which on it is an object's


def with_shadows_searched(
    judged: Sequence[Explanation],
    fine: View,
    coarse: View,
    ground: LitGround,
    region_px: int,
    refine: Callable[[Explanation], Explanation],
    log_odds: Callable[[Explanation], float],
) -> list[Explanation]:
    """The explanations, and those of the clearest objects' shadows that their shapes find.

    Of explanations of one object by nearly one light the likeliest is kept. coarse: the view that `ground` was fitted
    to. fine: the view at the largest scale to use. region_px: size in pixels to which a region is scaled. refine: fits
    an explanation anew, and moves it onto the steps of light. log_odds: by which explanations are judged.
    """
    kept = list(judged)
    for one in _clear_objects(judged, log_odds):
        same = [each for each in kept if each.region is one.region]
        for candidate in shadow_candidates(one.proxy, NO_LIGHTS, coarse, ground, TRIED):
            start = _explained(one, candidate, fine, coarse, ground, region_px)
            found = None if start is None else refine(start)
            if found is None or not _shows_shadow(found):
                continue
            rivals = [each for each in same if _near(each, found)]
            if all(log_odds(found) > log_odds(each) for each in rivals):
                kept, same = ([each for each in some if each not in rivals] + [found] for some in (kept, same))
    return kept


def _clear_objects(judged: Sequence[Explanation], log_odds: Callable[[Explanation], float]) -> list[Explanation]:
    """The likeliest explanation of each region that shows an object, the likeliest region first."""
    found: list[Explanation] = []
    for each in sorted(judged, key=log_odds, reverse=True):
        if each.alignment.clear_body > CLEAR_BODY and not any(each.region is one.region for one in found):
            found.append(each)
    return found[:BODIES]


def _explained(
    one: Explanation, candidate: ShadowCandidate, fine: View, coarse: View, ground: LitGround, region_px: int
) -> Explanation | None:
    """The object of `one` with the candidate as its shadow, aligned; None where that is not in view."""
    shift = candidate.shift(ground)
    if shift is None:
        return None
    start = replace(one.alignment.placed.lit, lights=candidate.light[None])
    region = candidate.region(start, fine, coarse, ground, region_px)
    materials, masks = materials_of(region, ground, shift), predicted(one.proxy, start.lights, region.view)
    as_object = object_cost(region, masks.body & region.is_ground)
    split = relabelled(region, materials, as_object, masks)
    proposal = Proposal(region, materials, split, None, as_object)
    (found,) = aligned_explanations([(proposal, [start], Sight.of(region.view))])
    return found


def _shows_shadow(found: Explanation) -> bool:
    """Whether the shadow that was looked for shows its border, by colours and by steps of light."""
    return found.alignment.clear_shadow >= LEAST_CLARITY and found.steps.show_shadow


def _near(one: Explanation, other: Explanation) -> bool:
    return angle_between(one.to_light_from_body, other.to_light_from_body) < NEAR_RAD
