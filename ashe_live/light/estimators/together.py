"""Explanations of several views together: each view's candidates, placed and aligned in all of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from operator import itemgetter

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.explanation.explain import explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.context import Context, are_apart
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, Judge
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.hull.explained import with_hull, without_replaced
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.views.costs_around import costs_around
from ashe_live.light.views.joint.aligned import (
    JointExplanation,
    JointStart,
    explained_in_views,
    in_each_view,
    towards_light,
    turned_from,
)
from ashe_live.light.views.joint.average_light import sharpened_families, with_average_light
from ashe_live.light.views.joint.log_odds import joint_log_odds, plane_support
from ashe_live.light.views.joint.refinement import by_families, refined_by_all_tangents, sharpened_in_views, with_steps
from ashe_live.light.views.joint.repeated import distinct_explanations

REFITTED = 1  # number of explanations, the likeliest, whose body's family is chosen anew by all views
FIRST_VIEWS = 3  # number of views in which candidates are aligned before the likeliest are in all
# Explanations that are less likely than the likeliest one, each in its own view, by more log odds than this are not
# aligned: other views would have to make up for odds of one in three thousand.
MOST_BEHIND = 8.0
MORE = 2  # number of candidates that are aligned in those views only, beside those that are aligned in all


# A view with explanations of it.
Found = tuple[SceneView, Sequence[Explanation]]


@dataclass(frozen=True, slots=True, eq=False)
class JointSearch:
    """Looks for explanations of several views together."""

    views: Sequence[SceneView]  # that of the answer first
    preset: ProxyPreset
    judge: Judge
    lamps: LampHypotheses  # that the first view's ground suggests

    def explained(self, found: Sequence[Found], context: Context) -> list[tuple[JointExplanation, float]]:
        """The likeliest different explanations found in some of the views, aligned in all, and their log odds, the
        likeliest first.

        context: what else the first view shows, and what was found in any.
        """

        @cache
        def log_odds(one: JointExplanation) -> float:
            return joint_log_odds(one, self.judge, context)

        candidates = _likely_candidates(found, self.judge, context)[: self.preset.joint + MORE]
        likely = self._aligned_in_first(candidates, log_odds)[: self.preset.joint]
        # Of each that is refitted, its best body of every family, the likeliest first.
        families = {id(each.origin): by_families(each, self.preset.fine_fit) for each in likely[:REFITTED]}
        likely = self._aligned_in_all([*(several[0] for several in families.values()), *likely[REFITTED:]])
        sharpener = Sharpener.of([view.fine for view in self.views])
        likely = sorted(with_steps(likely, sharpener), key=log_odds, reverse=True)
        of_families = [
            sharpened_families(each, families.get(id(each.origin), ()), sharpener) for each in likely[:REFITTED]
        ]
        sharp = [self._decided_with_hull(several[0], sharpener) for several in of_families]
        others = [_sharpened_if_corroborating(each, likely[0], sharpener) for each in likely[REFITTED:]]
        # What is judged is the explanation as it was; its light then becomes the mean of its families' lights.
        overdispersion = self.judge.calibration.overdispersion
        together = [
            (with_average_light(each, several, overdispersion), log_odds(each))
            for each, several in zip(sharp, of_families, strict=True)
        ]
        together += [(each, log_odds(each)) for each in others]
        return sorted(without_replaced(together), key=itemgetter(1), reverse=True)

    def _aligned_in_first(
        self, candidates: Sequence[tuple[SceneView, Explanation]], log_odds: Callable[[JointExplanation], float]
    ) -> list[JointExplanation]:
        """Explanations, each with the view that it is of, aligned in the first views; distinct, likeliest first."""
        first, region_px = self.views[:FIRST_VIEWS], self.preset.region_px
        starts = [start for home, one in candidates if (start := _start_in(first, home, one, region_px)) is not None]
        return distinct_explanations(sorted(_aligned_or_as_started(starts), key=log_odds, reverse=True))

    def _aligned_in_all(self, several: list[JointExplanation]) -> list[JointExplanation]:
        """Explanations of the first views aligned in all of them, without those that are like an earlier one."""
        others = self.views[FIRST_VIEWS:]
        if not others:
            return several
        starts = [_start_also_in(others, each, self.preset.region_px) for each in several]
        return distinct_explanations(_aligned_or_as_started(starts))

    def _decided_with_hull(self, moved: JointExplanation, sharpener: Sharpener) -> JointExplanation:
        """What lies on the steps of light, as a sun's or a lamp's, with a hull where no family explains it."""
        near_fit = partial(explained_near, preset=self.preset.fine_fit)
        decided = _decided(moved, self.lamps.decided(moved.joint, near_fit, sharpener))
        # The shape of a known caster needs no hull.
        return decided if self.preset.caster else with_hull(decided, sharpener)


def without_alike(several: Sequence[tuple[JointExplanation, float]]) -> list[tuple[JointExplanation, float]]:
    """Explanations with their log odds, the likeliest first, without those that are like a likelier one.

    Those that a hull replaces are left out as well.
    """
    ranked = sorted(without_replaced(several), key=itemgetter(1), reverse=True)
    kept = distinct_explanations([each for each, _ in ranked])
    return [(each, odds) for each, odds in ranked if any(each is one for one in kept)]


def _likely_candidates(found: Sequence[Found], judge: Judge, context: Context) -> list[tuple[SceneView, Explanation]]:
    """The explanations with the views that they are of, the likeliest first, without those that are MOST_BEHIND."""

    def log_odds(one: Explanation) -> float:
        return judge.log_odds(one, context) + plane_support(one.region, one.predicted.body, one.predicted.shadow)

    several = ((log_odds(each), view, each) for view, of_view in found for each in of_view)
    ranked = sorted(several, key=itemgetter(0), reverse=True)
    return [(view, each) for odds, view, each in ranked if odds > ranked[0][0] - MOST_BEHIND]


def _start_in(views: Sequence[SceneView], home: SceneView, one: Explanation, region_px: int) -> JointStart | None:
    """An explanation of the view `home`, to be aligned in those of the views that show it.

    None where the first of them does not: masks and body are to be that view's.
    """
    around = (one.costs if view is home else costs_around(one.lit, one.shifts, view, region_px) for view in views)
    first, *others = around
    return None if first is None else JointStart(one, one.lit, [first, *(each for each in others if each is not None)])


def _start_also_in(views: Sequence[SceneView], explanation: JointExplanation, region_px: int) -> JointStart:
    """An explanation of other views, to be aligned in those of the views that show it as well."""
    joint = explanation.joint
    more = (costs_around(joint.lit, joint.shifts, view, region_px) for view in views)
    costs = [*(each.costs for each in explanation.each), *(each for each in more if each is not None)]
    return JointStart(explanation.origin, joint.lit, costs)


def _sharpened_if_corroborating(
    other: JointExplanation, best: JointExplanation, sharpener: Sharpener
) -> JointExplanation:
    """Another explanation, moved onto the steps of light if it shows the best one's light by another object.

    Its direction of that light is averaged with the best one's, and is worth being as exact.
    """
    agrees = angle_between(towards_light(other), towards_light(best)) < GOOD_RAD
    if not agrees or not are_apart(other.joint.proxy, best.joint.proxy):
        return other
    return sharpened_in_views(refined_by_all_tangents(other), sharpener)


def _decided(explanation: JointExplanation, decided: Explanation) -> JointExplanation:
    """The explanation, or in each view what it was decided to be instead: a lamp's, or a sun's."""
    if decided.alignment is explanation.joint.alignment:
        return replace(explanation, joint=decided)
    return in_each_view(decided)


def _aligned_or_as_started(starts: Sequence[JointStart]) -> list[JointExplanation]:
    """The starts aligned in their views; then those of them where they stood that became another answer thereby."""
    found = explained_in_views(starts)
    return [each for each in found if each is not None] + turned_from(starts, found)
