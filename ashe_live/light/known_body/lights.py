"""The lights that a known body stands in, from its shadows and its lit sides, each with its probability."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from ashe_live.core.arrays import Float, Mask, without
from ashe_live.core.transforms import normalised
from ashe_live.light.known_body.candidates import APART_RAD, MOST_IN_VIEW, Candidates, mean_near
from ashe_live.light.known_body.confidence import LOG_NONE_FURTHER, NEAR_RAD, with_confidence
from ashe_live.light.known_body.found_light import FoundLight, darkenings_rgb, images_beside, points_of
from ashe_live.light.known_body.lamps import as_lamps
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.outline.fit import ShadowFit, fitted
from ashe_live.light.known_body.outline.odds import edge_log_odds
from ashe_live.light.known_body.outline.profiles import SHOWN
from ashe_live.light.known_body.rims import LEAST_DARKENING
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.shape.light_points import NO_LIGHTS

DARK_ELSEWHERE = 6.0  # log likelihood of a shadow, from which on something does darken the table
MOST_LIGHTS = 3  # that are looked for
# The evidence for a further light, as log likelihoods by map and sides: what the best direction of the scan must have
# for one to be looked for; what one must have that was found; and below what they are evidence against it, as a light
# explains something by its freedom alone.
LEAST_SCORE, LEAST_MORE, AGAINST = -1.5, 4.5, -1.0
LEAST_BY_EDGES = 6.5  # the same with the odds of its edges added, of a light that rests on these
GAIN_BY_MOVING = 2.0  # log likelihood by map and sides that a direction may gain as it is moved onto edges
# Clear edges: the least share of their places that show a step, and how far these may be from where they are predicted.
LEAST_CLEAR, MOST_MISFIT_PX = 0.75, 0.7
LEAST_KNOWN = 0.5  # confidence of a light, from which on its direction counts as known
LEAST_EXISTS = 0.5  # probability that the body hides another light's shadow, from which on one is stated


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What pictures of a known body say of its lights."""

    seen: Seen  # the pictures as these lights explain them
    lights: tuple[FoundLight, ...]  # the strongest of those whose direction is known first
    dark_rgb: Float  # (l, 3) part of the table's light that each gives, R, G, B
    is_dark_elsewhere: bool  # the table is darkened as if by a shadow, of whatever


def lights_of(seen: Seen) -> Found:
    """The lights of one picture or several, found one after the other; none where nothing says that there is one."""
    alone = seen.beside(NO_LIGHTS)
    steps = seen.rims(NO_LIGHTS).cautious
    first = Candidates(seen, alone, seen.edge_images, alone.everywhere.log_likelihood, steps)
    candidates, ruled_out = first.refined()
    scored = [(_log_likelihood(seen, each, alone), each) for each in candidates]
    # Also that of a shadow which cannot be the body's, as its edges should be seen and are not.
    darkest = max([float(alone.everywhere.log_likelihood.max()), *(each for each, _ in scored)])
    if not scored:
        return Found(seen, (), np.empty((0, 3)), darkest > DARK_ELSEWHERE)
    _, likeliest = max(scored, key=itemgetter(0))
    seen, found = _with_further(seen, likeliest)
    found.sort(key=lambda each: (each.exists is not None, -each.darkening))
    dark = darkenings_rgb(seen, found)
    found = [with_confidence(seen, *each, found, alone, ruled_out) for each in zip(found, dark, strict=True)]
    # One that surely is there, but may be anywhere, comes after those that are known, however strong it is.
    order = sorted(range(len(found)), key=lambda number: found[number].confidence < LEAST_KNOWN)
    return Found(seen, tuple(found[number] for number in order), dark[order], darkest > DARK_ELSEWHERE)


def _with_further(seen: Seen, first: FoundLight) -> tuple[Seen, list[FoundLight]]:
    """The picture as all its lights explain it, and these: the first one with those that are found beside it.

    Each time it is decided which are lamps before another is looked for: a lamp's fan of a shadow and the fall of its
    light, taken for a sun's, would look like a further light.
    """
    found = as_lamps(seen, [first])
    seen = _in_light_of(seen, found)
    while len(found) < MOST_LIGHTS:
        further = _further(seen, found)
        if further is None:
            break
        if further.fit is not None and found[0].fit is None:
            # Beside a light that rests on a shadow's edges, one that rests on none has to be found anew.
            found = as_lamps(seen, [further])
            seen = _in_light_of(seen, found)
            continue
        together = as_lamps(seen, _refitted(seen, [*found, further]), len(found))
        if not are_apart(together, seen.body.height_m) or _is_unseen(together[-1]):
            break  # what was taken for another shadow is the rest of one that is known, or another thing's
        found, seen = together, _in_light_of(seen, together)
    return seen, found


def _in_light_of(seen: Seen, found: Sequence[FoundLight]) -> Seen:
    """The picture measured in the light of those that were found, of which lamps give more to some of the table."""
    if not any(each.is_lamp for each in found):
        return seen
    return seen.in_light_of(points_of(found), darkenings_rgb(seen, found).mean(axis=1))


def _log_likelihood(seen: Seen, one: FoundLight, beside: MarginalLikelihood) -> float:
    """By map, sides and edges."""
    return float(beside.scanned(seen.lit(one.light[None])).log_likelihood[0]) + edge_log_odds(one.fit)


def are_apart(found: Sequence[FoundLight], height: float) -> bool:
    """Whether the map resolves all lights' shadows, of a body of some height."""
    to_suns = np.array([each.sun_alike(height) for each in found])
    return bool((to_suns @ to_suns.T - 2 * np.eye(len(found)) < math.cos(APART_RAD)).all())


def _further(seen: Seen, known: Sequence[FoundLight]) -> FoundLight | None:
    """Another light beside those that are known; None where the picture shows no other."""
    beside = seen.beside(points_of(known))
    score = beside.everywhere.log_likelihood
    for each in known:
        to_sun = each.sun_alike(seen.body.height_m)
        score = np.where(seen.templates.lights[:, :3] @ to_sun > math.cos(APART_RAD), -np.inf, score)
    if not score.max() > LEAST_SCORE:
        return None
    best, likeliest = LEAST_MORE, None
    rims = seen.rims(points_of(known))
    # A known light without edges may be a mixture of this one and others, and is then found anew beside it.
    is_vague = known[0].fit is None
    least = (0.0 if is_vague else LEAST_MORE) - GAIN_BY_MOVING
    images = images_beside(seen, known)
    candidates = Candidates(seen, beside, images, score, rims.by_depth(), least=least, least_around=AGAINST)
    likely, _ = candidates.refined()
    for one in likely:
        if one.fit is None:
            continue
        more = _log_likelihood(seen, one, beside)
        by_table = more - edge_log_odds(one.fit)
        if _is_supported(one.fit, by_table, more, is_vague) and more > best:
            best, likeliest = more, one
    # The fall of a lamp's light over table and sides, which is known less well, looks like more light from elsewhere.
    if likeliest is None and len(known) == 1 and _is_surely_sun(known[0]):
        return _hidden(seen, score, rims.in_view > MOST_IN_VIEW, beside)
    return likeliest


def _is_supported(fit: ShadowFit, by_table: float, more: float, is_vague: bool) -> bool:
    """Whether there is evidence enough for a further light: log likelihoods by map and sides, and with its edges too.

    Edges alone are not enough against map and sides: beside the foot the hidden sky's gradient looks like a step. Nor
    are map and sides against edges that are in view: some other thing is dark, or casts a shadow. is_vague: whether no
    edges determine the light that is known.
    """
    is_edged = fit.clear > LEAST_CLEAR or (more > by_table and fit.misfit_px < MOST_MISFIT_PX)
    by_map = by_table > LEAST_MORE and (fit.seen <= MOST_IN_VIEW or is_edged)
    by_edges = by_table > AGAINST and more > LEAST_BY_EDGES and _is_clear(fit)
    return by_map or by_edges or (is_vague and by_table > 0 and _is_clear(fit))


def _is_surely_sun(one: FoundLight) -> bool:
    """Whether its edges are seen and determine its direction: they do not if its shadow leaves the picture.

    Else they leave open as well how its light falls off, and how much of it each side gets.
    """
    if one.fit is None or one.is_lamp or one.may_be_lamp:
        return False
    return float(np.linalg.eigvalsh(one.fitted.covariance_rad2)[-1]) < (NEAR_RAD / 2) ** 2


def _is_clear(fit: ShadowFit) -> bool:
    """Whether its edges are steps, and where they are predicted, or as many steps as true edges show.

    On a mottled table a pale shadow's edges scatter by as much as what is none.
    """
    return fit.clear > (LEAST_CLEAR if fit.misfit_px < MOST_MISFIT_PX else SHOWN)


def _is_unseen(one: FoundLight) -> bool:
    """Whether its shadow should be seen, and its edges are evidence against it."""
    return one.fit is not None and one.fit.seen > MOST_IN_VIEW and edge_log_odds(one.fit) < 0


def _hidden(seen: Seen, score: Float, would_be_seen: Mask, beside: MarginalLikelihood) -> FoundLight | None:
    """The light whose shadow the body hides, if map and sides say that there is one, averaged over where it may be.

    By the ratio of the marginal likelihoods with and without it, so that directions that explain little pay for those
    that explain much. If directions whose shadow's edges would be seen, and are not, explain more, it is another thing,
    such as a stain.

    score: (m,) log likelihood of each direction; -inf where none is looked for. would_be_seen: (m,) whether the edges
    of its shadow would be.
    """
    odds = seen.templates.solid_angle * np.exp(score - LOG_NONE_FURTHER)
    of_hidden, of_others = float(odds[~would_be_seen].sum()), float(odds[would_be_seen].sum())
    exists = of_hidden / (1 + of_hidden)
    if exists < LEAST_EXISTS or of_others > of_hidden:
        return None
    score = np.where(would_be_seen, -np.inf, score)
    best = seen.templates.lights[int(score.argmax())]
    hidden = mean_near(seen.templates, score, beside.everywhere.darkenings[:, -1], best)
    if hidden.darkening < LEAST_DARKENING or seen.edge_images.shown(hidden.light) > MOST_IN_VIEW:
        return None
    return replace(hidden, exists=exists)


def _refitted(seen: Seen, found: Sequence[FoundLight]) -> list[FoundLight]:
    """Each light fitted again, beside the others' shadows."""
    dark = darkenings_rgb(seen, found).mean(axis=1)
    fitted_again = []
    for one, darkening in zip(found, dark, strict=True):
        fit = None
        if one.fit is not None and one.fit.light[3] == 0:  # lamps are fitted as such afterwards
            image = images_beside(seen, without(found, [one])).of(one.fit.view)
            fit = fitted(image, one.casting, float(darkening), size_rad=one.size_rad)
        if fit is None or normalised(fit.light[:3]) @ normalised(one.casting[:3]) < math.cos(APART_RAD):
            fitted_again.append(replace(one, darkening=float(darkening)))
        else:
            fitted_again.append(FoundLight(fit.light, fit.covariance, fit, float(darkening)))
    return fitted_again
