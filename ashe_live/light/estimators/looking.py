"""A look at a picture: calls the stages in their order to find what the picture, and other views, may show."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.stages import StageClock
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.proposals import proposals_of, selected_for_fit
from ashe_live.light.estimators.refining import leaves_no_doubt, refined_alone, refined_and_others
from ashe_live.light.estimators.scene_views import fine_and_coarse, scene_views
from ashe_live.light.estimators.steps import FAST, ProxySteps
from ashe_live.light.estimators.together import explained_together, without_alike
from ashe_live.light.estimators.trace import Look, Trace
from ashe_live.light.explanation.explain import Proposal, explained, explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.company import Company, company_features
from ashe_live.light.explanation.judgement.judge import Judge, explanation_features, is_settled, probabilities_of
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.explanation.searches.known_place import explanations_by_place, hints_of
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.glint import glint_in
from ashe_live.light.ground.lit_ground import with_unlit_on_average
from ashe_live.light.ground.regions import region_with_on_plane, unlit_regions
from ashe_live.light.ground.shadow_shift import FINE, shadow_shifts, voted_for
from ashe_live.light.ground.sheet_shadow import sheet_shadow_in
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.joint.evidence import no_less_sure
from ashe_live.light.views.joint.same_silhouettes import counted_once
from ashe_live.light.views.seen import without_plane

# Least area of an unlit region, as a fraction of the coarse picture: smaller ones are specks.
LEAST_SHARE = 0.0005
# The most that is tried in a view beside the first: as much as the preset `fast` tries in a single picture.
MOST_BESIDE = {"regions": FAST.regions, "shifts": FAST.shifts, "tried": FAST.tried}
HINTS = 5  # number of lights in which a known object's place is searched
SAME_RAD, SAME_M = math.radians(1), 0.003  # angle and distance within which two explanations count as one
SEARCHED_ALONE = 4  # number of views that are searched as single pictures are, where all of them together leave doubt

# The log odds of an explanation, judged beside these several.
LogOddsAmong = Callable[[Sequence[Explanation]], Callable[[Explanation], float]]


def looked(
    tracked: TrackedFrame, others: Sequence[TrackedFrame], steps: ProxySteps, judge: Judge, clock: StageClock
) -> Look:
    """One look at the picture of `tracked`, which must have a marker, and at the others, which show the same scene."""
    judge = judge if steps.caster is None else judge.of_known_body()
    fine, coarse = fine_and_coarse(tracked, steps)
    trace = Trace(coarse)
    views = scene_views(tracked, fine, coarse, others, steps)
    clock.end("segment")
    if not views:
        return Look(trace, views)
    trace.ground = views[0].ground
    candidates, log_odds, lamps = _explanations(views[0], trace, steps, judge, clock)
    if len(views) > 1:
        together = _explained_together((views[0], candidates), views, trace, steps, judge, lamps, clock)
        alone, alone_log_odds = _directions(candidates), log_odds
        once = counted_once(together)
        candidates, log_odds = [each.joint for each, _ in once], [odds for _, odds in once]
        log_odds = no_less_sure(_directions(candidates), log_odds, alone, alone_log_odds)
        clock.end("views")
    trace.judged, trace.probabilities = candidates, probabilities_of(log_odds).tolist()
    return Look(trace, views)


def _explained_together(
    first: tuple[SceneView, Sequence[Explanation]],
    views: Sequence[SceneView],
    trace: Trace,
    steps: ProxySteps,
    judge: Judge,
    lamps: LampHypotheses,
    clock: StageClock,
) -> list[tuple[JointExplanation, float]]:
    """As `explained_together`, of what is found in the first view; where all leave doubt about it, in others, too.

    Where that leaves doubt as well, each view is also searched as if it were the only one: the inside of a plain object
    does not visibly shear, so that labels which rest on other views take it for the shadow. first: the first view with
    its explanations; trace: of its picture.
    """

    def searched(several: Sequence[SceneView]) -> Iterator[tuple[SceneView, Sequence[Explanation]]]:
        for view in several:
            seen = Sharpener.of([view.fine])
            rough, *_ = _rough_explanations(view, seen, Trace(view.coarse), _beside(steps), judge, clock)
            yield view, rough

    def together_of(
        several: Sequence[tuple[SceneView, Sequence[Explanation]]],
        found: Sequence[tuple[SceneView, Sequence[Explanation]]],
    ) -> list[tuple[JointExplanation, float]]:
        company = Company([one for _, those in found for one in those], trace.glint, trace.sheet_shadow)
        return explained_together(several, views, steps, judge, lamps, company)

    companions = views[1 : 1 + steps.companions]
    together = together_of([first], [first])
    if _leaves_no_doubt(together) or not companions:
        return together
    found = [first, *searched(companions)]
    together = together_of(found, found)
    if _leaves_no_doubt(together):
        return together
    alone = [(view, _found_alone(view, steps, judge, clock)) for view in views[:SEARCHED_ALONE]]
    return without_alike([*together, *together_of(alone, [*found, *alone])])


def _leaves_no_doubt(together: Sequence[tuple[JointExplanation, float]]) -> bool:
    """Whether one direction is so likely that more views need not be searched.

    What hides the shadow in one view does not in another, but where nothing hides it, more views find the same.
    """
    return is_settled([odds for _, odds in together], _directions([each.joint for each, _ in together]))


def _found_alone(view: SceneView, steps: ProxySteps, judge: Judge, clock: StageClock) -> list[Explanation]:
    """What a view shows where no other is known, with what the others tell of its pixels, by which it is judged."""
    found, *_ = _explanations(without_plane(view), Trace(view.coarse), steps, judge, clock)
    own = {id(each.region): each.region for each in found}
    compared = {key: region_with_on_plane(region, view.ground) for key, region in own.items()}
    return [replace(each, region=compared[id(each.region)]) for each in found]


def _directions(several: Sequence[Explanation]) -> list[Float]:
    """(3,) each, towards the light, or the first of two."""
    return [each.lights[0].to_light_marker for each in several]


def _beside(steps: ProxySteps) -> ProxySteps:
    """How a companion is searched: the first view finds the same explanations, unless they are hard to see in it."""
    counts = {name: min(getattr(steps, name), most) for name, most in MOST_BESIDE.items()}
    return replace(steps, **counts)


def _explanations(
    view: SceneView, trace: Trace, steps: ProxySteps, judge: Judge, clock: StageClock
) -> tuple[list[Explanation], list[float], LampHypotheses]:
    """The explanations of one view (the likeliest refined), their log odds, and the lamps that its ground suggests.

    Without explanations if nothing stands out from the ground. trace: of the view; intermediate results are added.
    """
    sharpener = Sharpener.of([view.fine])
    rough, log_odds_among, lamps = _rough_explanations(view, sharpener, trace, steps, judge, clock)
    if not rough:
        return [], [], lamps
    log_odds_of = log_odds_among(rough)
    found = refined_and_others(rough, sharpener, view, steps, log_odds_of, lamps)
    clock.end("fit")
    if steps.caster is not None and not leaves_no_doubt(found, log_odds_among(found)):
        found += _found_by_place(view, trace, found, log_odds_among(found), sharpener, lamps, steps, judge)
        clock.end("fit")
    log_odds = list(map(log_odds_among(found), found))
    clock.end("judge")
    return found, log_odds, lamps


def _found_by_place(
    view: SceneView,
    trace: Trace,
    found: Sequence[Explanation],
    log_odds: Callable[[Explanation], float],
    sharpener: Sharpener,
    lamps: LampHypotheses,
    steps: ProxySteps,
    judge: Judge,
) -> list[Explanation]:
    """Where the known object may stand in the lights that it, or any object of the picture, may show.

    found: explanations by the known object, beside those by any.
    """
    assert steps.caster is not None
    assert trace.unlit is not None
    of_any, by_any, _ = _rough_explanations(
        view, sharpener, Trace(view.coarse), steps.with_caster(None), judge, StageClock()
    )
    hints = hints_of(
        [*sorted(of_any, key=by_any(of_any), reverse=True)[:HINTS], *sorted(found, key=log_odds, reverse=True)],
        HINTS,
    )
    placed = explanations_by_place(steps.caster, hints, view, trace.unlit, steps.region_px)
    likeliest = sorted(sharpener.measured(placed), key=log_odds, reverse=True)[: steps.refined + 1]
    sharp = refined_alone(likeliest, sharpener, steps, lamps)
    return [each for each in sharp if not any(_is_same(each, one) for one in found)]


def _is_same(one: Explanation, other: Explanation) -> bool:
    """Whether two explanations of one known object have it at one place in one light."""
    away = float(np.linalg.norm(one.proxy.foot_marker - other.proxy.foot_marker))
    near = angle_between(one.lights[0].to_light_marker, other.lights[0].to_light_marker)
    return near < SAME_RAD and away < SAME_M and len(one.lights) == len(other.lights)


def _rough_explanations(
    view: SceneView, sharpener: Sharpener, trace: Trace, steps: ProxySteps, judge: Judge, clock: StageClock
) -> tuple[list[Explanation], LogOddsAmong, LampHypotheses]:
    """The explanations of one view by fits to the likeliest splits, a function that judges them, and the lamps that its
    ground suggests. sharpener: of that view at full resolution.
    """
    fine, coarse, ground = view.fine, view.coarse, view.ground
    unlit = with_unlit_on_average(view.unlit(round(LEAST_SHARE * coarse.is_ground.size)), coarse)
    trace.sheet_shadow = sheet_shadow = sheet_shadow_in(fine)
    trace.glint = glint = glint_in(coarse, ground)
    trace.unlit = unlit = unlit if glint is None else unlit & ~glint.halo
    trace.regions = regions = unlit_regions(fine, unlit, ground, steps.region_px, steps.regions)
    clock.end("segment")
    proposals: list[Proposal] = []
    voted = partial(voted_for, ground=ground, count=steps.shifts, widths=(1.0, FINE))
    everywhere = voted(ground.colours[unlit])
    for region in regions:
        # A region's own pixels vote first, as others could outvote its shadow; then all, as shadows share their lights.
        own = voted(region.colours[region.unlit])
        shifts, paired = (shadow_shifts(votes) for votes in zip(own, everywhere, strict=True))
        proposals += proposals_of(region, ground, shifts, paired)
    clock.end("associate")
    trace.proposals = selected_for_fit(proposals, steps.tried, judge)
    suns = [each for each in explained(trace.proposals, steps.first_fit) if each] if proposals else []
    lamps = LampHypotheses.of(coarse, ground, unlit, steps.light)
    likelier = lamps.likelier(suns, partial(explained_near, preset=steps.first_fit))
    trace.rough = rough = sharpener.measured(likelier)
    own_features = cache(explanation_features)

    def log_odds_among(several: Sequence[Explanation]) -> Callable[[Explanation], float]:
        company = Company(several, glint, sheet_shadow)

        def log_odds(each: Explanation) -> float:
            return judge.log_odds_of({**own_features(each), **company_features(each, company)}) + lamps.agreement(each)

        return cache(log_odds)

    clock.end("fit")
    return rough, log_odds_among, lamps
