"""The second lights that are tried beside a right first one, whether they are right or not."""

from collections.abc import Sequence
from dataclasses import dataclass

from ashe_live.bench.cases import Case
from ashe_live.core.arrays import Float
from ashe_live.core.light import StageClock
from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.estimators.scene_views import fine_and_coarse, scene_views
from ashe_live.light.estimators.view_search import ViewSearch
from ashe_live.light.explanation.explain import refined, refined_by_tangents
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, Judge
from ashe_live.light.explanation.searches.second_light import LEAST_GAIN, TRIED, tried_light
from ashe_live.light.explanation.searches.shadow_search import shadow_candidates

FAINTEST = 8.0  # signal-to-noise ratio of a shadow from which on candidates are measured


@dataclass(frozen=True, slots=True)
class MeasuredPicture:
    """A picture in which a first light is right, and the second ones that were tried beside it."""

    lights: int  # true ones, 1 or 2
    tried: Sequence["MeasuredLight"]


@dataclass(frozen=True, slots=True)
class MeasuredLight:
    """A second light that was tried, and lowers the unary costs enough."""

    signal_to_noise: float  # of its shadow, as ShadowCandidate has it
    clarity: float  # mean, of its shadow's borders, 0 to 1
    is_right: bool


def measured_picture(case: Case, preset: ProxyPreset, judge: Judge) -> MeasuredPicture | None:
    """The second lights of a picture with one light or two, tried beside the likeliest first light that is right.

    From the tracker's own pose. None where the picture has another number of lights, and where no explanation by one
    light is right.
    """
    truths = case.to_lights_marker
    if truths is None or not 1 <= len(truths) <= 2:
        return None
    tracked = case.followed()
    views = scene_views(tracked, *fine_and_coarse(tracked, preset), (), preset)
    known = _right_first(ViewSearch(views[0], preset, judge, StageClock()), truths) if views else None
    if known is None:
        return None
    (view,), tried = views, []
    for found in shadow_candidates(known.proxy, known.lit.lights, view.coarse, view.ground, TRIED, FAINTEST):
        light = tried_light(known, found, view, preset.region_px)
        if light is not None and light.gain() > LEAST_GAIN:
            tried.append(MeasuredLight(found.signal_to_noise, light.clarity, _are_both(light.both, truths)))
    return MeasuredPicture(len(truths), tried)


def _right_first(search: ViewSearch, truths: Float) -> Explanation | None:
    """The likeliest explanation by one light that is right, refined as the estimator does before it tries a second."""
    rough = search.rough()
    log_odds = search.log_odds_among(rough)
    right = [each for each in rough if len(each.lights) == 1 and _is_near_any(each, truths)]
    if not right:
        return None
    (fine,) = refined([max(right, key=log_odds)], search.preset.fine_fit)
    return fine if fine is None else refined_by_tangents(fine)


def _is_near_any(explanation: Explanation, truths: Float) -> bool:
    (light,) = explanation.lights
    return any(angle_between(light.to_light_marker, truth) < GOOD_RAD for truth in truths)


def _are_both(both: Explanation, truths: Float) -> bool:
    """Whether the two lights are the two true ones."""
    if len(truths) != 2:
        return False
    one, other = (light.to_light_marker for light in both.lights)
    orders = ((one, other), (other, one))
    return any(
        all(angle_between(light, truth) < GOOD_RAD for light, truth in zip(order, truths, strict=True))
        for order in orders
    )
