"""A look at a picture: what it may show by itself, and where there are other views, what all of them may show."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.light import StageClock
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import FAST, ProxyPreset
from ashe_live.light.estimators.scene_views import fine_and_coarse, scene_views
from ashe_live.light.estimators.together import Found, JointSearch, without_alike
from ashe_live.light.estimators.view_search import Trace, ViewSearch
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import Judge, is_settled, probabilities_of
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.ground.regions import region_with_on_plane
from ashe_live.light.views.joint.aligned import JointExplanation
from ashe_live.light.views.joint.log_odds import no_less_sure
from ashe_live.light.views.joint.repeated import counted_once
from ashe_live.light.views.plane import without_plane

SEARCHED_ALONE = 4  # number of views that are searched as single pictures are, where all of them together leave doubt


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What a picture may show, and the views of the scene that this rests on, its own first."""

    trace: Trace
    views: list[SceneView]  # none where too little of the ground is lit
    # The search of the first view as if it were the only one, where the others beside it have left doubt.
    alone: ViewSearch | None = None

    @property
    def unlit(self) -> Mask:
        """(h, w) of the trace's view: pixels that the lit ground, of which there is enough, does not explain."""
        assert self.trace.unlit is not None
        return self.trace.unlit


def looked(
    tracked: TrackedFrame, others: Sequence[TrackedFrame], preset: ProxyPreset, judge: Judge, clock: StageClock
) -> Look:
    """One look at the picture of `tracked`, which must have a marker, and at the others, which show the same scene."""
    judge = judge if preset.caster is None else judge.of_known_body()
    fine, coarse = fine_and_coarse(tracked, preset)
    views = scene_views(tracked, fine, coarse, others, preset)
    clock.end("segment")
    if not views:
        return Look(Trace(coarse), views)
    first, of_first_alone = ViewSearch(views[0], preset, judge, clock), None
    candidates, log_odds = first.explanations
    if len(views) > 1:
        together, of_first_alone = _explained_together(first, candidates, views)
        alone, alone_log_odds = _directions(candidates), log_odds
        once = counted_once(together)
        candidates, log_odds = [each.joint for each, _ in once], [odds for _, odds in once]
        log_odds = no_less_sure(_directions(candidates), log_odds, alone, alone_log_odds)
        clock.end("views")
    return _look(first, candidates, log_odds, views, of_first_alone)


def looked_alone(search: ViewSearch) -> Look:
    """The look at a picture of which there is no other view, by the search of it."""
    return _look(search, *search.explanations, [search.view])


def _look(
    first: ViewSearch,
    judged: list[Explanation],
    log_odds: Sequence[float],
    views: list[SceneView],
    alone: ViewSearch | None = None,
) -> Look:
    """The look of these views that has judged these explanations; the search of the first view keeps them."""
    first.trace.judged, first.trace.probabilities = judged, probabilities_of(log_odds).tolist()
    return Look(first.trace, views, alone)


def _explained_together(
    first: ViewSearch, candidates: Sequence[Explanation], views: Sequence[SceneView]
) -> tuple[list[tuple[JointExplanation, float]], ViewSearch | None]:
    """What all views together may show, with its log odds: by the candidates of the first view; where these leave
    doubt, by those of others, too.

    Where that leaves doubt as well, each view is also searched as if it were the only one: the inside of a plain object
    does not visibly shear, so that labels which rest on other views take it for the shadow. That search of the first
    view comes with them.
    """
    joint = JointSearch(views, first.preset, first.judge, first.lamps)

    def together(several: Sequence[Found], found: Sequence[Found]) -> list[tuple[JointExplanation, float]]:
        return joint.explained(several, first.context_of([one for _, those in found for one in those]))

    of_first = first.view, candidates
    by_first = together([of_first], [of_first])
    companions = views[1 : 1 + first.preset.companions]
    if _leaves_no_doubt(by_first) or not companions:
        return by_first, None
    found = [of_first, *((view, first.another(view, _beside(first.preset)).rough()) for view in companions)]
    by_all = together(found, found)
    if _leaves_no_doubt(by_all):
        return by_all, None
    searches = [(view, first.another(without_plane(view), first.preset)) for view in views[:SEARCHED_ALONE]]
    alone = [(view, _found_alone(search, view)) for view, search in searches]
    return without_alike([*by_all, *together(alone, [*found, *alone])]), searches[0][1]


def _leaves_no_doubt(together: Sequence[tuple[JointExplanation, float]]) -> bool:
    """Whether one direction is so likely that more views need not be searched.

    What hides the shadow in one view does not in another, but where nothing hides it, more views find the same.
    """
    return is_settled([odds for _, odds in together], _directions([each.joint for each, _ in together]))


def _found_alone(alone: ViewSearch, view: SceneView) -> list[Explanation]:
    """What a view shows by itself, with the others' evidence on its pixels, by which it is judged."""
    found, _ = alone.explanations
    own = {id(each.region): each.region for each in found}
    compared = {key: region_with_on_plane(region, view.ground) for key, region in own.items()}
    return [replace(each, region=compared[id(each.region)]) for each in found]


def _directions(several: Sequence[Explanation]) -> list[Float]:
    """(3,) each, towards the light, or the first of two."""
    return [each.lights[0].to_light_marker for each in several]


def _beside(preset: ProxyPreset) -> ProxyPreset:
    """How a companion is searched: no more is tried than the preset `fast` tries in a single picture.

    The first view finds the same explanations, unless they are hard to see in it.
    """
    return replace(
        preset,
        regions=min(preset.regions, FAST.regions),
        shifts=min(preset.shifts, FAST.shifts),
        tried=min(preset.tried, FAST.tried),
    )
