"""The lights that a known body stands in, from its shadows and its lit sides, each with its probability."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.candidates import APART_RAD, refined
from ashe_live.light.known_body.fit import fitted, room_of, without
from ashe_live.light.known_body.found_light import FoundLight, darkenings_rgb
from ashe_live.light.known_body.odds import PALE, PALEST, edge_log_odds, with_edges
from ashe_live.light.known_body.scan import SKY_SHARES, shadows_of, templates_of
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.shadow_edges import shadow_edges

NEAR_RAD = math.radians(10)  # of an answer, within which it counts as right
# Weight before the picture is seen of "no light casts a shadow", where all directions together have 1.
LOG_NONE = math.log(0.5)
DARK_ELSEWHERE = 6.0  # log likelihood of a shadow, from which on something does darken the table
MOST_LIGHTS = 3
# A further light: what the map says for it before it is fitted, and map and edges together afterwards, log likelihood.
LEAST_SCORE, LEAST_MORE = 1.0, 8.0
# It must take that part of the table's light, that part of its edges must be seen as steps, and so near.
LEAST_DARKENING, LEAST_CLEAR, MOST_MISFIT_PX = 0.06, 0.75, 0.7
# Beside another light's edges the table is not clear: pixels, and of that light's penumbra for a light of 1 rad.
OTHER_EDGE_PX, OTHER_PENUMBRA = 3.0, 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a picture of a known body says of its lights."""

    lights: tuple[FoundLight, ...]  # the strongest first
    is_dark_elsewhere: bool  # the table is darkened as if by a shadow, of whatever


def lights_of(seen: Seen) -> Found | None:
    """None where nothing says that there is a light."""
    templates = templates_of(seen.body)
    nothing = np.zeros((0, templates.shadows.shape[1]), np.float32)
    log_likelihood = seen.scan(templates.shadows, nothing).log_likelihood + seen.by_shading(templates.lights)
    candidates = refined(seen, log_likelihood.max(axis=1), templates.lights, seen.clear, nothing)
    if not candidates:
        return None
    scored = [
        (max(likelihood, _log_likelihood(seen, each, nothing)) + edge_log_odds(each.fit), each)
        for likelihood, each in candidates
    ]
    likelihood, first = max(scored, key=lambda pair: pair[0])
    found = [first]
    while len(found) < MOST_LIGHTS:
        further = _further(seen, found)
        if further is None:
            break
        both = _refitted(seen, [*found, further])
        if not are_apart(both):
            break  # what was taken for another shadow is the rest of one that is known
        found = both
    found = [_with_confidence(seen, each, found, log_likelihood) for each in found]
    found.sort(key=lambda each: -each.darkening)
    return Found(tuple(found), likelihood > DARK_ELSEWHERE)


def _with_confidence(seen: Seen, one: FoundLight, among: Sequence[FoundLight], log_likelihood: Float) -> FoundLight:
    """`one` of the lights `among` which it is, with the posterior of the directions near it, and what its edges say.

    log_likelihood: as of `_posterior_near`, of a light that is alone. Beside others, whose shadows are known, the map
    alone tells: shading knows no two lights.
    """
    others = [other for other in among if other is not one]
    none, palest, pale = LOG_NONE + seen.by_shading_of_sky, PALEST, PALE
    if others:
        also = shadows_of(seen.body, np.array([other.light for other in others]))
        log_likelihood = seen.scan(templates_of(seen.body).shadows, also).log_likelihood
        none, palest, pale = LOG_NONE + _without_another(seen, also), LEAST_DARKENING, LEAST_DARKENING
    near = _posterior_near(seen, log_likelihood, none, one.light)
    step = float(darkenings_rgb(seen, [one, *others])[0].mean())
    return replace(one, confidence=with_edges(near, one.fit, step, palest, pale))


def _posterior_near(seen: Seen, log_likelihood: Float, none: float, light: Float) -> float:
    """Posterior probability, before any edge is looked at, of the directions within NEAR_RAD of a light (4,).

    log_likelihood: (m, k) of the templates, under each of SKY_SHARES. none: of no such light, times its prior.
    """
    templates = templates_of(seen.body)
    by_light = log_likelihood + np.log(templates.solid_angle[:, None] / len(SKY_SHARES))
    most = max(float(by_light.max()), none)
    posterior = np.exp(by_light - most)
    near = templates.lights[:, :3] @ normalised(light[:3]) > math.cos(NEAR_RAD)
    return float(posterior[near].sum() / (posterior.sum() + math.exp(none - most)))


def are_apart(found: Sequence[FoundLight]) -> bool:
    """Whether no two lights are as near to each other as the map tells none apart."""
    to_lights = np.array([normalised(each.light[:3]) for each in found])
    return bool((to_lights @ to_lights.T - 2 * np.eye(len(found)) < math.cos(APART_RAD)).all())


def _without_another(seen: Seen, also: Float32) -> float:
    """Log likelihood of the map where only `also` (k, n * n) and the sky's share darken it."""
    # Of a shadow that is nowhere the scan says what the sky's share alone explains.
    nowhere = np.zeros((1, also.shape[1]), np.float32)
    return float(seen.scan(nowhere, also).log_likelihood.max())


def _log_likelihood(seen: Seen, one: FoundLight, also: Float32) -> float:
    """By the map and the facets; also: as in Seen.scan."""
    scan = seen.scan(shadows_of(seen.body, one.light[None]), also)
    return float((scan.log_likelihood + seen.by_shading(one.light[None])).max())


def _further(seen: Seen, known: Sequence[FoundLight]) -> FoundLight | None:
    """Another light, whose shadow the map shows beside those of the lights that are known."""
    templates = templates_of(seen.body)
    also = shadows_of(seen.body, np.array([each.light for each in known]))
    none = _without_another(seen, also)
    score = seen.scan(templates.shadows, also).log_likelihood.max(axis=1) - none
    for each in known:
        to_light = normalised(each.light[:3])
        score = np.where(templates.lights[:, :3] @ to_light > math.cos(APART_RAD), -np.inf, score)
    if not score.max() > LEAST_SCORE:
        return None
    best, likeliest = LEAST_MORE, None
    for _, one in refined(seen, score, templates.lights, _clear_of(seen, known), also):
        is_clear = one.fit is not None and one.fit.clear > LEAST_CLEAR and one.fit.misfit_px < MOST_MISFIT_PX
        with_it = float(seen.scan(shadows_of(seen.body, one.light[None]), also).log_likelihood.max())
        more = with_it - none + edge_log_odds(one.fit)
        if is_clear and one.darkening > LEAST_DARKENING and more > best:
            best, likeliest = more, one
    return likeliest


def _clear_of(seen: Seen, others: Sequence[FoundLight]) -> Mask:
    """The bare table without what lies near the edges of other lights' shadows."""
    clear = seen.clear
    for other in others:
        edges = shadow_edges(seen.body, other.light, seen.view)
        if edges is not None:
            size = (other.fit.size_rad or 0.0) if other.fit is not None else 0.0
            penumbra_px = size * float(np.percentile(edges.by_size, 90))
            clear = without(clear, edges, OTHER_EDGE_PX + OTHER_PENUMBRA * penumbra_px)
    return clear


def _refitted(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """Each light fitted again, beside the others' shadows."""
    dark = darkenings_rgb(seen, found).mean(axis=1)
    fitted_again = []
    for number, (one, darkening) in enumerate(zip(found, dark, strict=True)):
        clear = _clear_of(seen, [*found[:number], *found[number + 1 :]])
        fit = fitted(seen.body, one.light, float(darkening), seen.light, room_of(clear), seen.view)
        if fit is None or normalised(fit.light[:3]) @ normalised(one.light[:3]) < math.cos(APART_RAD):
            fitted_again.append(replace(one, darkening=float(darkening)))
        else:
            fitted_again.append(FoundLight(fit.light, fit.covariance, fit, float(darkening)))
    return fitted_again
