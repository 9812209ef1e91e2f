"""An object's shadow, searched for by its shape where no explanation is likely.

On ground of many colours a shadow may have the colours of lit ground elsewhere, as of a table's dark grain. Then its
pixels do not stand out one by one, and no split contains it. Only the object stands out; where it is clear, its body
predicts which shadows it can cast.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from ashe_live.core.arrays import distinct
from ashe_live.core.transforms import angle_between
from ashe_live.light.explanation.explain import (
    FittedProposal,
    aligned_explanations,
    are_of_one_object,
    proposal_of,
)
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.second_light import NEAR_RAD
from ashe_live.light.explanation.searches.shadow_search import shadow_candidates
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.shape.batches import for_groups
from ashe_live.light.shape.light_points import NO_LIGHTS

BODIES, TRIED = 2, 2  # objects whose shadows are searched for, and candidates for each
CLEAR_BODY = 0.5  # least mean clarity of an outline that is taken for an object's
CLEAR_SHADOW = 0.18  # and of a shadow's border that was looked for


def with_shadows_searched(
    judged: Sequence[Explanation],
    view: SceneView,
    region_px: int,
    refine: Callable[[Sequence[Explanation]], list[Explanation]],
    log_odds: Callable[[Explanation], float],
) -> list[Explanation]:
    """The explanations, and those of the clearest objects' shadows that their shapes find.

    Of explanations of one object by nearly one light the likeliest is kept. region_px: size in pixels to which a region
    is scaled. refine: fits each explanation anew, and moves it onto the steps of light. log_odds: by which explanations
    are judged.
    """
    objects = _clear_objects(judged, log_odds)
    starts = [_starts(one, view, region_px) for one in objects]
    # Aligned and refined as one batch, as they do not depend on one another.
    aligned = for_groups(aligned_explanations, starts)
    refined = for_groups(refine, [[each for each in of_one if each is not None] for of_one in aligned])
    kept = list(judged)
    for one, of_one in zip(objects, refined, strict=True):
        same = [each for each in kept if are_of_one_object(each, one)]
        for new in of_one:
            rivals = [each for each in same if _near(each, new)]
            if _shows_shadow(new) and all(log_odds(new) > log_odds(each) for each in rivals):
                kept, same = ([each for each in some if each not in rivals] + [new] for some in (kept, same))
    return kept


def _clear_objects(judged: Sequence[Explanation], log_odds: Callable[[Explanation], float]) -> list[Explanation]:
    """The likeliest explanation of each object, the likeliest first: one that two regions show is searched once."""
    clear = (each for each in judged if each.alignment.clear_body > CLEAR_BODY)
    return distinct(sorted(clear, key=log_odds, reverse=True), are_of_one_object, BODIES)


def _starts(one: Explanation, view: SceneView, region_px: int) -> list[FittedProposal]:
    """The object of `one` with each candidate for its shadow."""
    starts: list[FittedProposal] = []
    for candidate in shadow_candidates(one.proxy, NO_LIGHTS, view.coarse, view.ground, TRIED):
        start = replace(one.lit, lights=candidate.light[None])
        region = candidate.region(start, view, region_px)
        starts.append(proposal_of(start, region, materials_of(region, view.ground, candidate.shift)))
    return starts


def _shows_shadow(found: Explanation) -> bool:
    """Whether the shadow that was looked for shows its border, by colours and by steps of light."""
    return found.alignment.clear_shadow >= CLEAR_SHADOW and found.steps.show_shadow


def _near(one: Explanation, other: Explanation) -> bool:
    return angle_between(one.to_light_from_body, other.to_light_from_body) < NEAR_RAD
