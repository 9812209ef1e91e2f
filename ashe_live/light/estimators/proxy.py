"""The estimator `proxy`: fits a simple body and one or two lights to a real object and its shadow.

The stages are segment -> associate -> fit -> judge, each made of pure functions in a package of its own. `ground` finds
the pixels that the lit ground does not explain, and how shadows shift its colours. `labels` proposes which of these
pixels are shadow and which are object. `outline_fit` fits bodies and lights to both outlines. `explanation` aligns the
likeliest of them with the borders in the picture, relabels and refits, and finally states the best one with its
confidence, or rejects it. `view_search` calls the stages for one view, `looking` for several; docs/maths.md leads to
the equations.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from ashe_live.core.arrays import Float, Mask, without
from ashe_live.core.light import Illumination, LightEstimate, StageClock
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import view_direction
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.known_body import estimate_by_body
from ashe_live.light.estimators.looking import Look, looked, looked_alone
from ashe_live.light.estimators.preset import BALANCED, ProxyPreset
from ashe_live.light.estimators.scene_views import contradicting
from ashe_live.light.estimators.stating import Choice, chosen, illumination_of
from ashe_live.light.estimators.view_search import Trace, ViewSearch
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.hidden_sky import depths_beyond_sky, is_of_sky_alone
from ashe_live.light.explanation.judgement.judge import Judge, fitted_judge, good_by_pose
from ashe_live.light.explanation.known_size import is_as_given
from ashe_live.light.explanation.no_answer import (
    LOW_LAMP,
    NO_SHADOW,
    NOTHING_THERE,
    OTHER_SIZE,
    SKY_ALONE,
    TOO_LITTLE_GROUND,
    fault_of_exposure,
    fault_of_place,
    fault_of_scene,
)
from ashe_live.light.lamps.fall.low_lamps import is_under_low_lamp
from ashe_live.light.lamps.kinds import SUN
from ashe_live.light.views.agreeing_views import without_confirming
from ashe_live.light.views.ground_height import COMPARED, height_above_ground, seen_from_ground, seen_from_marker
from ashe_live.light.views.selection import span_rad, usable

# Views of a known body that are used together at most, the farthest apart: what one of them hides another shows. Each
# costs half as much as the first; more than four were not measured.
VIEWS_OF_BODY = 4


class ProxyEstimator:
    """Estimates one light or two with covariances and confidence, or gives the reason why there is none."""

    name = "proxy"

    def __init__(self, preset: ProxyPreset = BALANCED, judge: Judge | None = None) -> None:
        """judge: None for the one that is shipped with the package."""
        self._preset = preset
        self._judge = judge or fitted_judge()

    def estimate(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> LightEstimate:
        """As Estimator.estimate. The masks cover the whole frame, at the scale of the explained region."""
        estimate, _ = self.traced(tracked, others)
        return estimate

    def traced(self, tracked: TrackedFrame, others: Sequence[TrackedFrame] = ()) -> tuple[LightEstimate, Trace]:
        """As `estimate`, with the trace of intermediate results: some megabytes that refer to the picture."""
        if tracked.marker is None:
            raise ValueError("a frame without a marker has no marker frame to answer in")
        if tracked.marker.body is not None:
            # The marker is printed on a known body, which casts a shadow itself.
            return self._of_known_body(tracked, others, tracked.marker.body)
        if tracked.clean_plate_bgr is not None:
            others = ()  # they show the ground's pattern, and nothing in common with a view over plain ground
        compared = usable(tracked, others, min(COMPARED, self._preset.views - 1))
        height_m = height_above_ground([tracked, *compared])
        if height_m == 0:
            return self._of_agreeing(tracked, others)
        tracked, *others = (seen_from_ground(each, height_m) for each in (tracked, *others))
        estimate, trace = self._of_agreeing(tracked, others)
        return replace(estimate, illumination=seen_from_marker(estimate.illumination, height_m)), trace

    def _of_known_body(
        self, tracked: TrackedFrame, others: Sequence[TrackedFrame], body: Proxy
    ) -> tuple[LightEstimate, Trace]:
        """As `traced`, where the marker is printed on a body; frames that show another scene are left out."""
        width_px = self._preset.fine_width_px
        clock, alone = StageClock(), None
        left = [each for each in others if each.marker is not None and each.marker.body is not None]
        by_body = partial(estimate_by_body, tracked, body=body, width_px=width_px, name=self.name, clock=clock)
        while True:
            found = by_body(usable(tracked, left, min(VIEWS_OF_BODY, self._preset.views) - 1))
            explained = found.estimate
            if found.used and explained.light is None:
                # Views that contradict each other leave no answer; then the first view's answer shows which ones do.
                alone = alone or by_body(()).estimate
                explained = alone
            odd = contradicting(explained, tracked, found.used, self._preset)
            clock.end("judge")
            if explained is alone:
                odd = _unless_all(odd, found.used)
            if not odd:
                span = _span_rad([each.pose.T_cam_marker for each in (tracked, *found.used)])
                estimate = replace(found.estimate, span_rad=span, timing_ms=clock.timing_ms())
                return estimate, Trace(found.view)
            left = without(left, odd)

    def _of_agreeing(self, tracked: TrackedFrame, others: Sequence[TrackedFrame]) -> tuple[LightEstimate, Trace]:
        """As `traced`, of frames in which the plane z = 0 is the ground; those that show another scene are left out."""
        clock, left = StageClock(), list(others)
        while True:
            estimate, look = self._looked(tracked, left, clock)
            odd = self._contradicting(estimate, look, tracked, left, clock)
            if not odd:
                return estimate, look.trace
            # Others take their place, which may be of that scene as well.
            left = without(left, odd)

    def _contradicting(
        self,
        estimate: LightEstimate,
        look: Look,
        tracked: TrackedFrame,
        others: Sequence[TrackedFrame],
        clock: StageClock,
    ) -> list[TrackedFrame]:
        """Those of the others that an estimate, made by `look`, rests on, and that show another scene."""
        if len(estimate.views) == 1:
            return []
        # Views that contradict each other may leave no answer; then the first view's answer shows which ones do.
        explained = estimate if estimate.light is not None else self._looked(tracked, (), clock, look.alone)[0]
        odd = contradicting(explained, tracked, others, self._preset)
        if explained is estimate:
            return without_confirming(odd, _likeliest(look.trace), self._judge)
        return _unless_all(odd, [other for other in others if other.frame.index in estimate.views])

    def _looked(
        self,
        tracked: TrackedFrame,
        others: Sequence[TrackedFrame],
        clock: StageClock,
        alone: ViewSearch | None = None,
    ) -> tuple[LightEstimate, Look]:
        """The estimate and the look that it was made by. alone: the search of the only view, if it was made before."""
        judge, (preset, *further) = self._judge, self._preset.looks
        first = looked(tracked, others, preset, judge, clock) if alone is None else looked_alone(alone)
        is_alone = len(first.views) == 1
        looks = [first, *(looked(tracked, (), each, judge, clock) for each in further if is_alone)]
        answer = _answer_by(looks, tracked, judge, preset, clock)
        body, shadow = (None, None) if answer.explanation is None else _masks_of(answer.explanation)
        estimate = LightEstimate(
            estimator=self.name,
            frame_index=tracked.frame.index,
            illumination=answer.illumination,
            reason=answer.reason,
            object_mask=body,
            shadow_mask=shadow,
            timing_ms=clock.timing_ms(),
            views=tuple(view.index for view in first.views),
            span_rad=_span_rad([view.coarse.T_cam_marker for view in first.views]),
        )
        return estimate, answer.look


@dataclass(frozen=True, slots=True, eq=False)
class _Answer:
    """What the looks at a picture lead to."""

    look: Look  # that it rests on
    explanation: Explanation | None  # the likeliest, also where it is not likely enough; None where nothing was found
    illumination: Illumination = field(default_factory=Illumination)
    reason: str | None = None  # why there is no light


def _answer_by(
    looks: Sequence[Look], tracked: TrackedFrame, judge: Judge, preset: ProxyPreset, clock: StageClock
) -> _Answer:
    """The answer by one or more looks at the picture of `tracked`; preset: that of the first look."""
    first = looks[0]
    choice = chosen(looks, judge) if first.views else None
    clock.end("judge")
    reason = _reason_for_none(first, choice, judge, preset)
    if choice is None or reason is not None:
        likeliest = None if choice is None else choice.explanation
        return _Answer(first, likeliest, reason=fault_of_exposure(first.trace.view, first.trace.unlit) or reason)
    illumination, explanation = illumination_of(choice, tracked, judge, preset)
    clock.end("judge")
    if (illumination.lights[0].confidence or 0.0) < judge.least_confidence:
        # The direction in the picture is known, but that at the marker is not: it may be a lamp, or the pose is unsure.
        good = good_by_pose(illumination.lights[0].to_light_marker, tracked)
        return _Answer(choice.look, explanation, reason=fault_of_place(choice.explanation, good))
    return _Answer(choice.look, explanation, illumination)


def _reason_for_none(first: Look, choice: Choice | None, judge: Judge, preset: ProxyPreset) -> str | None:
    """Why there is no answer; None where there is one. first: the first look at the picture."""
    if not first.views:
        return TOO_LITTLE_GROUND
    if choice is None:
        return NO_SHADOW if first.trace.regions else NOTHING_THERE
    if choice.confidence < judge.least_confidence:
        return fault_of_scene(choice.explanation, choice.confidence)
    if _shows_sky_alone(choice):
        return SKY_ALONE
    look = choice.look
    view, ground = look.trace.view, look.views[0].ground
    if preset.light != SUN and is_under_low_lamp(choice.explanation, choice.confidence, view, ground, look.unlit):
        return LOW_LAMP
    fine_views = [view.fine for view in look.views]
    return None if is_as_given(choice.explanation, preset.first_fit, fine_views) else OTHER_SIZE


def _shows_sky_alone(choice: Choice) -> bool:
    """Whether the choice's shadows are only where its body hides the sky, in the first view that shows it."""
    best = choice.explanation
    lights = np.array([light.light for light in best.lights])
    seeming = [-float(shift[0]) for shift in best.shifts]
    each_view = (depths_beyond_sky(view.fine, best.proxy, lights) for view in choice.look.views)
    depths = next((depths for depths in each_view if any(depth is not None for depth in depths)), None)
    return depths is not None and is_of_sky_alone(depths, seeming)


def _unless_all(odd: list[TrackedFrame], used: Sequence[TrackedFrame]) -> list[TrackedFrame]:
    """Those of the other views used that contradict the answer by the first one alone.

    None if all of several do: that answer is wrong rather than they.
    """
    return [] if len(used) > 1 and not without(used, odd) else odd


def _span_rad(poses: Sequence[Float]) -> float | None:
    """The largest angle between the directions of views with poses T_cam_marker (4, 4); None for one view."""
    return span_rad([view_direction(each) for each in poses]) if len(poses) > 1 else None


def _likeliest(trace: Trace) -> Explanation:
    """Of an answer's explanations, the likeliest."""
    return trace.judged[int(np.argmax(trace.probabilities))]


def _masks_of(explanation: Explanation) -> tuple[Mask, Mask]:
    """(h, w) each, of the whole frame at the region's scale: the object and the shadow."""
    region, split = explanation.region, explanation.split
    return region.in_frame(split.object_mask), region.in_frame(split.shadow_mask)
