"""Explanations of the other objects in a picture, once one of them and its light are known."""

from collections.abc import Sequence

import numpy as np

from ashe_live.light.estimators.proposals import proposals_of
from ashe_live.light.estimators.steps import FIRST_FIT
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import Judge
from ashe_live.light.ground.lit_ground import LitGround
from ashe_live.light.ground.regions import Region
from ashe_live.light.labels.associate import distinct

TRIED = 4  # splits of other regions that are fitted, the best-looking


def other_objects(
    best: Explanation, found: Sequence[Explanation], regions: Sequence[Region], ground: LitGround, judge: Judge
) -> list[tuple[Explanation, float]]:
    """Explanations of other objects with their log odds: those found before, and new ones for the shadow's colour.

    best: the explanation of the known object. found: all that the picture was explained by.
    """
    shift = np.asarray(best.materials.shift)
    proposals = [
        proposal
        for region in regions
        if region.window != best.region.window
        for proposal in proposals_of(region, ground, [shift], [])
        if proposal.split.undecided is None
    ]
    proposals.sort(key=lambda each: judge.split_score(each.region, each.materials, each.split), reverse=True)
    new = [each for each in explained(distinct(proposals, Proposal.is_like, TRIED), FIRST_FIT) if each is not None]
    others = [each for each in found if each is not best]
    return [(each, judge.log_odds(each)) for each in [*others, *new] if len(each.lights) == 1]
