"""The lights that a known body stands in, from its shadows and its lit sides, each with its probability."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.candidates import APART_RAD, LEAST_DARKENING, MOST_IN_VIEW, mean_near, refined
from ashe_live.light.known_body.evidence import Evidence, Scan
from ashe_live.light.known_body.found_light import FoundLight, darkenings_rgb, hidden_step, room_beside
from ashe_live.light.known_body.lamps import as_lamps
from ashe_live.light.known_body.outline.edges import shadow_edges
from ashe_live.light.known_body.outline.fit import EdgeFit, fitted, looked_at_again
from ashe_live.light.known_body.outline.odds import PALE, PALEST, edge_log_odds, with_edges
from ashe_live.light.known_body.outline.profiles import LEAST_PX
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.table import height_of
from ashe_live.light.known_body.templates import Templates

NEAR_RAD = math.radians(10)  # of an answer, within which it counts as right
# Where there surely is a light, by the probability that there is none, it is stated with its large uncertainty if it
# is as likely within twice as much as an answer has to be.
AROUND_RAD, MOST_NONE = 2 * NEAR_RAD, 0.05
# Weight before the picture is seen of "no light casts a shadow", where all directions together have 1.
LOG_NONE = math.log(0.5)
DARK_ELSEWHERE = 6.0  # log likelihood of a shadow, from which on something does darken the table
MOST_LIGHTS = 3
# A further light: what map and sides say for it before it is fitted, and afterwards; and together with its edges, where
# these are what tells it.
LEAST_SCORE, LEAST_MORE, LEAST_BY_EDGES = -1.5, 4.5, 6.5
AGAINST = -1.0  # log likelihood of map and sides, from which down they speak against it: less is what its freedom costs
WORTH = 2.0  # what a direction may gain by being moved, in log likelihood of map and sides
LEAST_CLEAR, MOST_MISFIT_PX = 0.75, 0.7  # of its edges, if they are what tells it: so many are steps, and so near
# Beside one sun whose edges are seen the body may hide another light's shadow: the weight of "there is none" before the
# picture is seen, where all directions have 1; and the probability from which on there is one.
LOG_NONE_FURTHER, LEAST_EXISTS = 0.0, 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a picture of a known body says of its lights."""

    seen: Seen  # the picture as these lights explain it
    lights: tuple[FoundLight, ...]  # the strongest first, but those whose shadow is hidden last
    dark_rgb: Float  # (l, 3) part of the table's light that each gives, R, G, B
    is_dark_elsewhere: bool  # the table is darkened as if by a shadow, of whatever


def lights_of(seen: Seen) -> Found | None:
    """None where nothing says that there is a light."""
    alone = seen.beside(np.zeros((0, 4)))
    ruled_out: list[Float] = []
    _, steps = seen.rims(np.zeros((0, 4)))
    candidates = refined(seen, alone.everywhere.log_likelihood, alone, seen.room, steps, ruled_out=ruled_out)
    scored = [(_log_likelihood(seen, each, alone), each) for each in candidates]
    if not scored:
        return None
    likelihood, first = max(scored, key=lambda pair: pair[0])
    # A lamp's fan of a shadow and the fall of its light, taken for a sun's, would look like a further light.
    found = as_lamps(seen, [first])
    seen = _in_light_of(seen, found)
    while len(found) < MOST_LIGHTS:
        further = _further(seen, found)
        if further is None:
            break
        if further.fit is not None and found[0].fit is None:
            # Beside what a shadow's edges tell, a light that none of them told has to be found anew.
            found = as_lamps(seen, [further])
            seen = _in_light_of(seen, found)
            continue
        both = as_lamps(seen, _refitted(seen, [*found, further]), len(found))
        if not are_apart(both, height_of(seen.body)) or _is_unseen(both[-1]):
            break  # what was taken for another shadow is the rest of one that is known, or another thing's
        found, seen = both, _in_light_of(seen, both)
    found.sort(key=lambda each: (each.exists is not None, -each.darkening))
    dark = darkenings_rgb(seen, found)
    found = [_with_confidence(seen, *each, found, alone, ruled_out) for each in zip(found, dark, strict=True)]
    return Found(seen, tuple(found), dark, likelihood > DARK_ELSEWHERE)


def _in_light_of(seen: Seen, found: Sequence[FoundLight]) -> Seen:
    """The picture measured in the light of those that were found, of which lamps give more to some of the table."""
    if not any(each.is_lamp for each in found):
        return seen
    return seen.in_light_of(_points(found), darkenings_rgb(seen, found).mean(axis=1))


def _points(found: Sequence[FoundLight]) -> Float:
    """(l, 4)"""
    return np.array([each.casting for each in found])


def _log_likelihood(seen: Seen, one: FoundLight, beside: Evidence) -> float:
    """By map, sides and edges."""
    return float(beside.scanned(seen.lit(one.light[None])).log_likelihood[0]) + edge_log_odds(one.fit)


def _with_confidence(
    seen: Seen,
    one: FoundLight,
    dark_rgb: Float,
    among: Sequence[FoundLight],
    alone: Evidence,
    ruled_out: Sequence[Float],
) -> FoundLight:
    """`one` of the lights `among` which it is, with the posterior of the directions near it, and what its edges say.

    dark_rgb: (3,) part of the table's light that it gives. alone: the picture without lights that are known.
    ruled_out: lights (4,) that there are not.
    """
    others = [other for other in among if other is not one]
    beside, palest, pale, log_none = alone, PALEST, PALE, LOG_NONE
    known = _points(others) if others else np.zeros((0, 4))
    if others:
        beside = seen.beside(known)
        palest = pale = LEAST_DARKENING
        log_none = LOG_NONE if one.exists is None else LOG_NONE_FURTHER
        if one.fit is not None:
            room, darkening = room_beside(seen, others), float(dark_rgb.mean())
            one = replace(one, fit=looked_at_again(one.fit, seen.body, darkening, seen.light, room, seen.view))
    own = beside.scanned(seen.lit(one.casting[None]))
    lamp = float(own.log_likelihood[0]) if one.is_lamp else -math.inf
    to_sun = one.sun_alike(height_of(seen.body))
    _, steps = seen.rims(known)
    near, around, none = _posterior(seen.templates, beside.everywhere, steps, to_sun, lamp, log_none, ruled_out)
    # Beside the foot the hidden sky's gradient looks like a step.
    step = float(dark_rgb.mean()) - (1 - float(dark_rgb.mean())) * hidden_step(seen, one)
    if one.fit is None:
        step = min(step, float(own.darkenings[0, -1]))
        confidence, around = (with_edges(each, None, step, palest, pale) for each in (near, around))
        return replace(one, confidence=confidence, around=around if none < MOST_NONE else confidence)
    exists = with_edges(near, one.fit, step, palest, pale)
    confidence, around = (exists * _share(one, within) for within in (NEAR_RAD, AROUND_RAD))
    return replace(one, exists=exists, confidence=confidence, around=around if 1 - exists < MOST_NONE else confidence)


def _share(one: FoundLight, within_rad: float) -> float:
    """Probability that the light is so near which casts the shadow, by what its edges leave open of it."""
    sigmas = np.sqrt(np.maximum(np.linalg.eigvalsh(one.fitted.covariance_rad2), 1e-12))
    return math.prod(math.erf(within_rad / (math.sqrt(2) * sigma)) for sigma in sigmas.tolist())


def _posterior(
    templates: Templates,
    scan: Scan,
    steps: Float,
    to_sun: Float,
    lamp: float,
    log_none: float,
    ruled_out: Sequence[Float],
) -> tuple[float, float, float]:
    """Posterior probabilities, before its edges are looked at: of the directions within NEAR_RAD of one (3,), of those
    within AROUND_RAD, and of no light.

    steps: (m,) log odds by steps of light in the map, which speak against directions elsewhere whose shadows would be
    seen. lamp: log likelihood of a lamp there, whose light falls off as that of no sun; -inf where it is none.
    log_none: weight of no light before the picture is seen. ruled_out: lights (4,) about which there is none.
    """
    by_light = scan.log_likelihood + np.log(templates.solid_angle)
    by_lamp = lamp + math.log(1 - math.cos(NEAR_RAD))
    cosines = templates.lights[:, :3] @ to_sun
    is_near, is_around = cosines > math.cos(NEAR_RAD), cosines > math.cos(AROUND_RAD)
    by_light = by_light + np.where(is_around, 0.0, np.minimum(steps, 0.0))
    for rival in ruled_out:
        by_light[~is_near & (templates.lights[:, :3] @ rival[:3] > math.cos(APART_RAD))] = -np.inf
    most = max(float(by_light.max()), by_lamp, log_none)
    posterior = np.exp(by_light - most)
    near, around = float(posterior[is_near].sum()), float(posterior[is_around & ~is_near].sum())
    elsewhere, none = float(posterior[~is_around].sum()), math.exp(log_none - most)
    near = max(near, math.exp(by_lamp - most))
    whole = near + around + elsewhere + none
    return near / whole, (near + around) / whole, none / whole


def are_apart(found: Sequence[FoundLight], height: float) -> bool:
    """Whether no two lights' shadows of a body of some height are as near to each other as the map tells none apart."""
    to_suns = np.array([each.sun_alike(height) for each in found])
    return bool((to_suns @ to_suns.T - 2 * np.eye(len(found)) < math.cos(APART_RAD)).all())


def _further(seen: Seen, known: Sequence[FoundLight]) -> FoundLight | None:
    """Another light, which map and sides show beside those that are known."""
    beside = seen.beside(_points(known))
    score = beside.everywhere.log_likelihood
    for each in known:
        to_sun = each.sun_alike(height_of(seen.body))
        score = np.where(seen.templates.lights[:, :3] @ to_sun > math.cos(APART_RAD), -np.inf, score)
    if not score.max() > LEAST_SCORE:
        return None
    best, likeliest = LEAST_MORE, None
    in_view, steps = seen.rims(_points(known))
    for one in refined(seen, score, beside, room_beside(seen, known), steps, LEAST_MORE - WORTH, AGAINST):
        if one.fit is None:
            continue
        more = _log_likelihood(seen, one, beside)
        by_table = more - edge_log_odds(one.fit)
        # Edges alone do not do against map and sides: beside the foot the hidden sky's gradient looks like a step.
        # Nor do map and sides against edges that are in view: some other thing is dark, or throws a shadow.
        is_edged = one.fit.clear > LEAST_CLEAR or (more > by_table and one.fit.misfit_px < MOST_MISFIT_PX)
        is_told = by_table > LEAST_MORE and (one.fit.seen <= MOST_IN_VIEW or is_edged)
        is_told |= by_table > AGAINST and more > LEAST_BY_EDGES and _is_clear(one.fit)
        if is_told and more > best:
            best, likeliest = more, one
    # The fall of a lamp's light over table and sides, which is known less well, looks like more light from elsewhere.
    if likeliest is None and len(known) == 1 and _is_surely_sun(known[0]):
        return _hidden(seen, np.where(in_view > MOST_IN_VIEW, -np.inf, score), beside)
    return likeliest


def _is_surely_sun(one: FoundLight) -> bool:
    """Whether its edges are seen, and tell its direction, as of one whose shadow leaves the picture they do not.

    Then they leave open as well how its light falls off, and how much of it each side gets.
    """
    if one.fit is None or one.is_lamp or one.may_be_lamp:
        return False
    return float(np.linalg.eigvalsh(one.fitted.covariance_rad2)[-1]) < (NEAR_RAD / 2) ** 2


def _is_clear(fit: EdgeFit) -> bool:
    """Whether its edges are steps, and where they are predicted."""
    return fit.clear > LEAST_CLEAR and fit.misfit_px < MOST_MISFIT_PX


def _is_unseen(one: FoundLight) -> bool:
    """Whether its shadow should be seen, and its edges speak against it."""
    return one.fit is not None and one.fit.seen > MOST_IN_VIEW and edge_log_odds(one.fit) < 0


def _hidden(seen: Seen, score: Float, beside: Evidence) -> FoundLight | None:
    """The light whose shadow the body hides, if map and sides say that there is one, averaged over where it may be.

    score: (m,) log likelihood of each of the directions; -inf where none is looked for. By the ratio of the marginal
    likelihoods with and without it, so that directions that explain little pay for those that explain much.
    """
    odds = float(seen.templates.solid_angle @ np.exp(score)) / math.exp(LOG_NONE_FURTHER)
    exists = odds / (1 + odds)
    if exists < LEAST_EXISTS:
        return None
    best = seen.templates.lights[int(score.argmax())]
    mean, spread, darkening = mean_near(seen.templates, score, beside.everywhere.darkenings[:, -1], best)
    edges = shadow_edges(seen.body, mean, seen.view)
    in_view = 0.0 if edges is None else float((seen.room.around(edges.points_px) >= LEAST_PX).mean())
    if darkening < LEAST_DARKENING or in_view > MOST_IN_VIEW:
        return None
    return FoundLight(mean, spread, None, darkening, exists=exists)


def _refitted(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """Each light fitted again, beside the others' shadows."""
    dark = darkenings_rgb(seen, found).mean(axis=1)
    fitted_again = []
    for number, (one, darkening) in enumerate(zip(found, dark, strict=True)):
        room = room_beside(seen, [*found[:number], *found[number + 1 :]])
        fit = None
        if one.fit is not None and not one.is_lamp:  # lamps are fitted as such afterwards
            fit = fitted(seen.body, one.light, float(darkening), seen.light, room, seen.view, size_rad=one.size_rad)
        if fit is None or normalised(fit.light[:3]) @ normalised(one.light[:3]) < math.cos(APART_RAD):
            fitted_again.append(replace(one, darkening=float(darkening)))
        else:
            fitted_again.append(FoundLight(fit.light, fit.covariance, fit, float(darkening)))
    return fitted_again
