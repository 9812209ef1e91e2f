"""The lights that a known body stands in, from its shadows and its lit sides, each with its probability."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.candidates import APART_RAD, Directions, refined
from ashe_live.light.known_body.evidence import Evidence, Scan
from ashe_live.light.known_body.found_light import FoundLight, darkenings_rgb, room_beside
from ashe_live.light.known_body.lamps import as_lamps
from ashe_live.light.known_body.outline.fit import fitted
from ashe_live.light.known_body.outline.odds import PALE, PALEST, edge_log_odds, with_edges
from ashe_live.light.known_body.seen import Seen

NEAR_RAD = math.radians(10)  # of an answer, within which it counts as right
# Weight before the picture is seen of "no light casts a shadow", where all directions together have 1.
LOG_NONE = math.log(0.5)
DARK_ELSEWHERE = 6.0  # log likelihood of a shadow, from which on something does darken the table
MOST_LIGHTS = 3
# A further light: what map and sides say for it before it is fitted, and together with its edges afterwards.
LEAST_SCORE, LEAST_MORE = -1.5, 4.5
WORTH = 2.0  # what a direction may gain by being moved, in log likelihood of map and sides
# It must take that part of the table's light; and if its edges are what tells it, so many must be steps, and so near.
LEAST_DARKENING, LEAST_CLEAR, MOST_MISFIT_PX = 0.06, 0.75, 0.7


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a picture of a known body says of its lights."""

    lights: tuple[FoundLight, ...]  # the strongest first
    is_dark_elsewhere: bool  # the table is darkened as if by a shadow, of whatever


def lights_of(seen: Seen) -> Found | None:
    """None where nothing says that there is a light."""
    directions = Directions.of(seen)
    alone = seen.beside(np.zeros((0, 4)), directions.lit)
    candidates = refined(seen, directions, alone.everywhere.log_likelihood, alone, seen.room)
    scored = [(_log_likelihood(seen, each, alone), each) for each in candidates]
    if not scored:
        return None
    likelihood, first = max(scored, key=lambda pair: pair[0])
    found = [first]
    while len(found) < MOST_LIGHTS:
        further = _further(seen, directions, found)
        if further is None:
            break
        both = _refitted(seen, [*found, further])
        if not are_apart(both):
            break  # what was taken for another shadow is the rest of one that is known
        found = both
    found = as_lamps(seen, [_with_confidence(seen, directions, each, found, alone) for each in found])
    found.sort(key=lambda each: -each.darkening)
    return Found(tuple(found), likelihood > DARK_ELSEWHERE)


def _points(found: Sequence[FoundLight]) -> Float:
    """(l, 4)"""
    return np.array([each.light for each in found])


def _log_likelihood(seen: Seen, one: FoundLight, beside: Evidence) -> float:
    """By map, sides and edges."""
    return float(beside.scanned(seen.lit(one.light[None])).log_likelihood[0]) + edge_log_odds(one.fit)


def _with_confidence(
    seen: Seen, directions: Directions, one: FoundLight, among: Sequence[FoundLight], alone: Evidence
) -> FoundLight:
    """`one` of the lights `among` which it is, with the posterior of the directions near it, and what its edges say.

    alone: the picture without lights that are known.
    """
    others = [other for other in among if other is not one]
    beside, palest, pale = alone, PALEST, PALE
    if others:
        beside = seen.beside(_points(others), directions.lit)
        palest = pale = LEAST_DARKENING
    near = _posterior_near(directions, beside.everywhere, one.light)
    # Beside the foot the hidden sky's gradient looks like a step, and map and sides know better.
    by_all = float(beside.scanned(seen.lit(one.light[None])).darkenings[0, -1])
    step = min(by_all, float(darkenings_rgb(seen, [one, *others])[0].mean()))
    return replace(one, confidence=with_edges(near, one.fit, step, palest, pale))


def _posterior_near(directions: Directions, scan: Scan, light: Float) -> float:
    """Posterior probability, before any edge is looked at, of the directions within NEAR_RAD of a light (4,)."""
    by_light = scan.log_likelihood + np.log(directions.solid_angle)
    most = max(float(by_light.max()), LOG_NONE)
    posterior = np.exp(by_light - most)
    near = directions.lights[:, :3] @ normalised(light[:3]) > math.cos(NEAR_RAD)
    return float(posterior[near].sum() / (posterior.sum() + math.exp(LOG_NONE - most)))


def are_apart(found: Sequence[FoundLight]) -> bool:
    """Whether no two lights are as near to each other as the map tells none apart."""
    to_lights = np.array([normalised(each.light[:3]) for each in found])
    return bool((to_lights @ to_lights.T - 2 * np.eye(len(found)) < math.cos(APART_RAD)).all())


def _further(seen: Seen, directions: Directions, known: Sequence[FoundLight]) -> FoundLight | None:
    """Another light, which map and sides show beside those that are known."""
    beside = seen.beside(_points(known), directions.lit)
    score = beside.everywhere.log_likelihood
    for each in known:
        to_light = normalised(each.light[:3])
        score = np.where(directions.lights[:, :3] @ to_light > math.cos(APART_RAD), -np.inf, score)
    if not score.max() > LEAST_SCORE:
        return None
    best, likeliest = LEAST_MORE, None
    for one in refined(seen, directions, score, beside, room_beside(seen, known), LEAST_MORE - WORTH):
        more = _log_likelihood(seen, one, beside)
        by_edges = edge_log_odds(one.fit)
        is_clear = one.fit is None or (one.fit.clear > LEAST_CLEAR and one.fit.misfit_px < MOST_MISFIT_PX)
        is_clear = is_clear or more - by_edges > LEAST_MORE
        if is_clear and one.darkening > LEAST_DARKENING and more > best:
            best, likeliest = more, one
    return likeliest


def _refitted(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """Each light fitted again, beside the others' shadows."""
    dark = darkenings_rgb(seen, found).mean(axis=1)
    fitted_again = []
    for number, (one, darkening) in enumerate(zip(found, dark, strict=True)):
        room = room_beside(seen, [*found[:number], *found[number + 1 :]])
        fit = None if one.fit is None else fitted(seen.body, one.light, float(darkening), seen.light, room, seen.view)
        if fit is None or normalised(fit.light[:3]) @ normalised(one.light[:3]) < math.cos(APART_RAD):
            fitted_again.append(replace(one, darkening=float(darkening)))
        else:
            fitted_again.append(FoundLight(fit.light, fit.covariance, fit, float(darkening)))
    return fitted_again
