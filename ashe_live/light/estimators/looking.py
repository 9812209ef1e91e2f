"""A look at a picture: what it may show, judged beside whatever other views of the scene there are."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial

from ashe_live.core.arrays import Float
from ashe_live.core.stages import StageClock
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.proposals import proposals_of, selected_for_fit
from ashe_live.light.estimators.refining import refined_and_others
from ashe_live.light.estimators.scene_views import fine_and_coarse, scene_views
from ashe_live.light.estimators.steps import FAST, ProxySteps
from ashe_live.light.estimators.together import explained_together, without_alike
from ashe_live.light.estimators.trace import Look, Trace
from ashe_live.light.explanation.explain import Proposal, explained, explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.company import Company, company_features
from ashe_live.light.explanation.judgement.judge import Judge, explanation_features, is_settled, probabilities_of
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.glint import glint_in
from ashe_live.light.ground.lit_ground import unlit_mask, with_unlit_on_average
from ashe_live.light.ground.regions import region_with_on_plane, unlit_regions
from ashe_live.light.ground.shadow_shift import FINE, shadow_shifts, voted_for
from ashe_live.light.lamps.hypotheses import LampHypotheses
from ashe_live.light.views.evidence import no_less_sure
from ashe_live.light.views.joint import JointExplanation
from ashe_live.light.views.seen import SceneView, without_plane

# Least area of an unlit region, as a fraction of the coarse picture: smaller ones are specks.
LEAST_SHARE = 0.0005
# What is tried at most in a view beside the first: as in a single picture by the preset `fast`.
MOST_BESIDE = {"regions": FAST.regions, "shifts": FAST.shifts, "tried": FAST.tried}
FIRST_COMPANIONS = 1  # number of views beside the first that are searched in any case
SEARCHED_ALONE = 4  # number of views that are searched as single pictures are, where all of them together leave doubt

# The log odds of an explanation, judged beside these several.
LogOddsAmong = Callable[[Sequence[Explanation]], Callable[[Explanation], float]]


def looked(
    tracked: TrackedFrame, others: Sequence[TrackedFrame], steps: ProxySteps, judge: Judge, clock: StageClock
) -> Look:
    """One look at the picture of `tracked`, which must have a marker, and at the others, which show the same scene."""
    fine, coarse = fine_and_coarse(tracked, steps)
    trace = Trace(coarse)
    views = scene_views(tracked, fine, coarse, others, steps)
    clock.end("segment")
    if not views:
        return Look(trace, views)
    trace.ground = views[0].ground
    candidates, log_odds, lamps = _explanations(views[0], trace, steps, judge, clock)
    if len(views) > 1:
        together = _explained_together((views[0], candidates), views, steps, judge, lamps, clock)
        alone, alone_log_odds = _directions(candidates), log_odds
        candidates, log_odds = [each.joint for each, _ in together], [odds for _, odds in together]
        log_odds = no_less_sure(_directions(candidates), log_odds, alone, alone_log_odds)
        clock.end("views")
    trace.judged, trace.probabilities = candidates, probabilities_of(log_odds).tolist()
    return Look(trace, views)


def _explained_together(
    first: tuple[SceneView, Sequence[Explanation]],
    views: Sequence[SceneView],
    steps: ProxySteps,
    judge: Judge,
    lamps: LampHypotheses,
    clock: StageClock,
) -> list[tuple[JointExplanation, float]]:
    """As `explained_together`, of what is found in the first view and in as many others as it takes to be sure.

    Where that leaves doubt, views are searched as if each were the only one as well: what is plain does not shear, and
    is taken for its own shadow where other views have a say in the labels. first: the first view with its explanations.
    """

    def searched(several: Sequence[SceneView]) -> Iterator[tuple[SceneView, Sequence[Explanation]]]:
        for view in several:
            seen = Sharpener.of([view.fine])
            rough, *_ = _rough_explanations(view, seen, Trace(view.coarse), _beside(steps), judge, clock)
            yield view, rough

    companions = views[1 : 1 + steps.companions]
    found = [first, *searched(companions[:FIRST_COMPANIONS])]
    together = explained_together(found, views, steps, judge, lamps)
    if _leaves_no_doubt(together) or not companions:
        return together
    if more := companions[FIRST_COMPANIONS:]:
        together = explained_together([*found, *searched(more)], views, steps, judge, lamps)
        if _leaves_no_doubt(together):
            return together
    alone = [(view, _found_alone(view, steps, judge, clock)) for view in views[:SEARCHED_ALONE]]
    return without_alike([*together, *explained_together(alone, views, steps, judge, lamps)])


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
    """What one view may show, the likeliest refined, its log odds, and what the view's ground tells of lamps; no
    explanations where nothing stands out.

    trace: of the view, filled in on the way.
    """
    sharpener = Sharpener.of([view.fine])
    rough, log_odds_among, lamps = _rough_explanations(view, sharpener, trace, steps, judge, clock)
    if not rough:
        return [], [], lamps
    log_odds_of = log_odds_among(rough)
    found = refined_and_others(rough, sharpener, view.fine, view.coarse, view.ground, steps, log_odds_of, lamps)
    clock.end("fit")
    log_odds = list(map(log_odds_among(found), found))
    clock.end("judge")
    return found, log_odds, lamps


def _rough_explanations(
    view: SceneView, sharpener: Sharpener, trace: Trace, steps: ProxySteps, judge: Judge, clock: StageClock
) -> tuple[list[Explanation], LogOddsAmong, LampHypotheses]:
    """What one view may show, as the fits to the likeliest splits say, how these are judged among several, and what
    the view's ground tells of lamps. sharpener: of that view at full resolution.
    """
    fine, coarse, ground = view.fine, view.coarse, view.ground
    unlit = unlit_mask(ground, coarse.is_ground, round(LEAST_SHARE * coarse.is_ground.size))
    unlit = with_unlit_on_average(unlit, coarse)
    trace.glint = glint = glint_in(coarse, ground)
    trace.unlit = unlit = unlit if glint is None else unlit & ~glint.halo
    trace.regions = regions = unlit_regions(fine, unlit, ground, steps.region_px, steps.regions)
    clock.end("segment")
    proposals: list[Proposal] = []
    voted = partial(voted_for, ground=ground, count=steps.shifts, widths=(1.0, FINE))
    everywhere = voted(ground.colours[unlit])
    for region in regions:
        # What stands out elsewhere may outvote a region's own shadow; but all shadows are of the same lights.
        own = voted(region.colours[region.unlit])
        shifts, paired = (shadow_shifts(votes) for votes in zip(own, everywhere, strict=True))
        proposals += proposals_of(region, ground, shifts, paired)
    clock.end("associate")
    trace.proposals = selected_for_fit(proposals, steps.tried, judge)
    suns = [each for each in explained(trace.proposals, steps.first_fit) if each] if proposals else []
    lamps = LampHypotheses.of(coarse, ground, unlit, steps.light)
    likelier = lamps.likelier(suns, partial(explained_near, preset=steps.first_fit))
    trace.rough = rough = sharpener.measured(likelier)
    alone = cache(explanation_features)

    def log_odds_among(several: Sequence[Explanation]) -> Callable[[Explanation], float]:
        company = Company(several, glint)

        def log_odds(each: Explanation) -> float:
            return judge.log_odds_of({**alone(each), **company_features(each, company)}) + lamps.agreement(each)

        return cache(log_odds)

    clock.end("fit")
    return rough, log_odds_among, lamps
