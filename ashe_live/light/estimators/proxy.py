"""The estimator `proxy`: fits a simple body and a light to a real object and its shadow.

The stages are segment -> associate -> fit -> judge, each made of pure functions in a package of its own. `ground` finds
the pixels that the lit ground does not explain, and how shadows shift its colours; `labels` proposes which of those
pixels are shadow and which object; `outline_fit` fits bodies and lights to both outlines; `explanation` aligns the
likeliest with the borders in the picture, relabels and refits, and rates the best one's confidence, or rejects it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.stages import StageClock
from ashe_live.core.types import Illumination, Light, LightEstimate, TrackedFrame
from ashe_live.light.estimators.known_body import estimate_by_body
from ashe_live.light.estimators.other_objects import other_objects
from ashe_live.light.estimators.proposals import proposals_of, selected_for_fit
from ashe_live.light.estimators.refining import refined_and_others
from ashe_live.light.estimators.scene_views import contradicting, scene_views, span_of
from ashe_live.light.estimators.steps import BALANCED, ProxySteps
from ashe_live.light.estimators.together import explained_together
from ashe_live.light.estimators.trace import Look, Trace
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.company import Company, company_features
from ashe_live.light.explanation.judgement.evidence import shadow_core
from ashe_live.light.explanation.judgement.judge import (
    Judge,
    best_direction,
    explanation_features,
    fitted_judge,
    probabilities_of,
    recalibrated,
)
from ashe_live.light.explanation.known_size import is_as_given
from ashe_live.light.explanation.no_answer import (
    NO_SHADOW,
    NOTHING_THERE,
    OTHER_SIZE,
    TOO_LITTLE_GROUND,
    fault_of_exposure,
    fault_of_scene,
)
from ashe_live.light.explanation.penumbra import angular_size, soft_size
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.glint import glint_in
from ashe_live.light.ground.lit_ground import LitGround, lit_rgb, unlit_mask, with_unlit_on_average
from ashe_live.light.ground.regions import unlit_regions
from ashe_live.light.ground.shadow_shift import FINE, shadow_ratio, shadow_shifts, shift_within
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.lamps.lamp import Scene, stated, with_size
from ashe_live.light.pixels.view import View

# Least area of an unlit region, as a fraction of the coarse picture: smaller ones are specks.
LEAST_SHARE = 0.0005


class ProxyEstimator:
    """Estimates one light or two with covariances and confidence, or gives the reason why there is none."""

    name = "proxy"

    def __init__(self, steps: ProxySteps = BALANCED, judge: Judge | None = None) -> None:
        """judge: None for the one that comes with the package."""
        self._steps = steps
        self._judge = judge or fitted_judge()

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        """As Estimator.estimate; the masks show the whole frame at the scale of the explained region."""
        estimate, _ = self.traced(tracked, others)
        return estimate

    def traced(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> tuple[LightEstimate, Trace]:
        """As `estimate`, with the trace of intermediate results: some megabytes that refer to the picture."""
        if tracked.marker is None:
            raise ValueError("a frame without a marker has no marker frame to answer in")
        if tracked.marker.body is not None:
            # What the marker is printed on casts a shadow itself, and is known.
            estimate = estimate_by_body(tracked, tracked.marker.body, self._steps.fine_width_px, self.name)
            return estimate, Trace(View.of(tracked, self._steps.coarse_width_px))
        clock = StageClock()
        estimate, trace = self._traced(tracked, others, clock)
        if len(estimate.views) > 1:
            # Views that contradict each other may leave no answer; one view's answer then tells which of them do.
            explained = estimate if estimate.light is not None else self._traced(tracked, (), clock)[0]
            odd = contradicting(explained, tracked, others, self._steps)
            # Where all of several views contradict one view's answer, that is wrong rather than all of them.
            is_doubtful = explained is not estimate and len(odd) == len(estimate.views) - 1 > 1
            if odd and not is_doubtful:
                agreeing = [other for other in others if not any(other is one for one in odd)]
                return self._traced(tracked, agreeing, clock)
        return estimate, trace

    def _traced(
        self, tracked: TrackedFrame, others: Sequence[TrackedFrame], clock: StageClock
    ) -> tuple[LightEstimate, Trace]:
        judge, (steps, *further) = self._judge, self._steps.looks
        first = self._looked(tracked, others, steps, clock)
        views = first.views
        looks = [first, *(self._looked(tracked, (), each, clock) for each in further if len(views) == 1)]

        def none(reason: str, body: Mask | None = None, shadow: Mask | None = None) -> tuple[LightEstimate, Trace]:
            reason = fault_of_exposure(first.trace.view) or reason
            return answer(Illumination(), reason, body, shadow), first.trace

        def answer(found: Illumination, reason: str | None, body: Mask | None, shadow: Mask | None) -> LightEstimate:
            index, timing_ms = tracked.frame.index, clock.timing_ms()
            indices = tuple(view.index for view in views)
            return LightEstimate(self.name, index, found, reason, body, shadow, timing_ms, indices, span_of(views))

        if not views:
            return none(TOO_LITTLE_GROUND)
        average = judge.average(len(looks))
        several = [
            (look, each, weight * probability)
            for look, weight in zip(looks, average.weights, strict=True)
            for each, probability in zip(look.trace.judged, look.trace.probabilities, strict=True)
        ]
        if not several:
            return none(NO_SHADOW if first.trace.regions else NOTHING_THERE)
        probabilities = np.array([probability for *_, probability in several])
        index, share = best_direction(probabilities, [each.lights[0].to_light_marker for _, each, _ in several])
        look, best, _ = several[index]
        trace, ground = look.trace, look.views[0].ground
        confidence = recalibrated(share, average)
        clock.end("judge")
        if confidence < judge.least_confidence:
            return none(fault_of_scene(best, confidence), *_masks_of(best))
        if not is_as_given(best, steps.first_fit):
            return none(OTHER_SIZE, *_masks_of(best))
        ratios = [shadow_ratio(ground, shift) for shift in _shifts_seen(best, ground)]
        assert trace.unlit is not None
        chosen = best
        told = stated(
            chosen,
            confidence,
            lambda each, probability: judge.lights_of(each, probability, tracked),
            ratios[: len(chosen.lights)],
            Scene(
                trace.view,
                ground,
                trace.unlit,
                lambda: other_objects(chosen, trace.judged, trace.regions, ground, judge),
                lambda: Sharpener.of([look.views[0].fine]),
                steps.fine_fit,
            ),
            # A hull's shadow has been compared with all of the plane: there is no body's border left to tell of a lamp.
            SUN if chosen.hull is not None and steps.light == AUTO else steps.light,
        )
        best = told.explanation
        # With two lights there is a third shift, that where both are blocked.
        answers = zip(told.lights, ratios, strict=False)
        lights = [replace(light, shadow_rgb_ratio=ratio) for light, ratio in answers]
        if len(lights) == 1:
            lights = [with_size(lights[0], _angular_size(best, lights[0], tracked))]
        clock.end("judge")
        found = Illumination(tuple(lights), ratios[-1], lit_rgb(ground), best.real_object)
        return answer(found, None, *_masks_of(best)), trace

    def _looked(
        self, tracked: TrackedFrame, others: Sequence[TrackedFrame], steps: ProxySteps, clock: StageClock
    ) -> Look:
        """One look at the picture, and with it at the others that show the same scene."""
        fine = View.of(tracked, steps.fine_width_px)
        coarse = fine.scaled(steps.coarse_width_px)
        trace = Trace(coarse)
        views = scene_views(tracked, fine, coarse, others, steps)
        clock.end("segment")
        if not views:
            return Look(trace, views)
        trace.ground = views[0].ground
        candidates, log_odds = self._explanations(fine, coarse, views[0].ground, trace, steps, clock)
        if len(views) > 1:
            others_found = []
            for view in views[1:][: steps.companions]:
                other = Trace(view.coarse)
                found, _ = self._explanations(view.fine, view.coarse, view.ground, other, steps, clock)
                others_found.append((view, found))
            together = explained_together([(views[0], candidates), *others_found], views, steps, self._judge)
            candidates, log_odds = [each for each, _ in together], [odds for _, odds in together]
            clock.end("views")
        trace.judged, trace.probabilities = candidates, probabilities_of(log_odds).tolist()
        return Look(trace, views)

    def _explanations(
        self, fine: View, coarse: View, ground: LitGround, trace: Trace, steps: ProxySteps, clock: StageClock
    ) -> tuple[list[Explanation], list[float]]:
        """What one view may show, the likeliest refined, and its log odds; nothing where nothing stands out."""
        judge = self._judge
        unlit = unlit_mask(ground, coarse.is_ground, round(LEAST_SHARE * coarse.is_ground.size))
        unlit = with_unlit_on_average(unlit, coarse)
        trace.glint = glint = glint_in(coarse, ground)
        trace.unlit = unlit = unlit if glint is None else unlit & ~glint.halo
        trace.regions = regions = unlit_regions(fine, unlit, ground, steps.region_px, steps.regions)
        clock.end("segment")
        if not regions:
            return [], []

        proposals: list[Proposal] = []
        for region in regions:
            # What stands out elsewhere may outvote a region's own shadow; but all shadows are of the same lights.
            votes = region.colours[region.unlit], ground.colours[unlit]
            shifts = shadow_shifts(ground, votes, steps.shifts)
            paired = shadow_shifts(ground, votes, steps.shifts, FINE)
            proposals += proposals_of(region, ground, shifts, paired)
        clock.end("associate")
        trace.proposals = selected_for_fit(proposals, steps.tried, judge)
        sharpener = Sharpener.of([fine])
        rough = [each for each in explained(trace.proposals, steps.first_fit) if each]
        trace.rough = rough = sharpener.measured(rough)
        to_glint = None if glint is None else glint.to_light_marker
        alone = cache(explanation_features)

        def log_odds_among(several: Sequence[Explanation]) -> Callable[[Explanation], float]:
            company = Company(several, to_glint)
            return cache(lambda each: judge.log_odds_of({**alone(each), **company_features(each, company)}))

        found = refined_and_others(rough, sharpener, fine, coarse, ground, steps, log_odds_among(rough))
        clock.end("fit")
        log_odds = list(map(log_odds_among(found), found))
        clock.end("judge")
        return found, log_odds


def _masks_of(explanation: Explanation) -> tuple[Mask, Mask]:
    """(h, w) each, of the whole frame at the region's scale: the object and the shadow."""
    region, split = explanation.region, explanation.split
    return region.in_frame(split.object_mask), region.in_frame(split.shadow_mask)


def _shifts_seen(best: Explanation, ground: LitGround) -> tuple[Float, ...]:
    """The shifts measured inside the final shadow, as the vote also counted penumbrae and contact shadows.

    Of two lights, the shifts of the vote.
    """
    if best.materials.lights == 2:
        return best.materials.shifts
    seen = shift_within(best.region.colours[shadow_core(best.region, best.predicted)], ground)
    return best.materials.shifts if seen is None else (seen,)


def _angular_size(best: Explanation, light: Light, tracked: TrackedFrame) -> float | None:
    soft = soft_size(best.proxy, light.homogeneous, tracked)
    if soft is not None:
        return soft
    return angular_size(best.proxy, light.homogeneous, best.materials.light_lost, best.predicted, best.region.view)
