"""The probability that a light is where it was found: by map and sides among all directions, and by its edges."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from ashe_live.core.arrays import Float, without
from ashe_live.light.known_body.candidates import APART_RAD
from ashe_live.light.known_body.found_light import FoundLight, hidden_step, images_beside, points_of
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood
from ashe_live.light.known_body.outline.confirmed import confirmed
from ashe_live.light.known_body.outline.elsewhere import most_log_odds
from ashe_live.light.known_body.outline.odds import OF_ONLY_LIGHT, ShadowDepths, with_edges
from ashe_live.light.known_body.rims import LEAST_DARKENING
from ashe_live.light.known_body.seen import Seen

NEAR_RAD = math.radians(10)  # within which of a true light an answer counts as right
# Where a light surely exists, that is the probability of none is below MOST_NONE, it is stated with its large
# uncertainty if it is as likely within AROUND_RAD as an answer has to be within NEAR_RAD.
AROUND_RAD, MOST_NONE = 2 * NEAR_RAD, 0.05
# Log of the prior weight of "no light casts a shadow", where all directions together have the weight 1; and of "there
# is no further light", whose shadow the body would hide, beside one sun whose edges are seen: one of four suns has
# another light beside it, as the generator of scenes draws them.
LOG_NONE, LOG_NONE_FURTHER = math.log(0.5), math.log(3.0)
AMONG_OTHERS = ShadowDepths(least=LEAST_DARKENING, pale=LEAST_DARKENING)  # for a light beside others
# Of the standard normal distribution, the middles of a hundred equal shares.
QUANTILES = [NormalDist().inv_cdf((number + 0.5) / 100) for number in range(100)]
SURE_BY_TABLE = 0.95  # probability of a direction by map and sides, from which on edges need not be rare on the table


@dataclass(frozen=True, slots=True)
class _Posterior:
    """Posterior probabilities by map and sides, before any edges are looked at."""

    near: float  # of a light within NEAR_RAD of a direction
    around: float  # of a light within AROUND_RAD of it
    none: float  # of no light at all


def with_confidence(
    seen: Seen,
    one: FoundLight,
    dark_rgb: Float,
    among: Sequence[FoundLight],
    alone: MarginalLikelihood,
    ruled_out: Sequence[Float],
) -> FoundLight:
    """`one` of the lights in `among`, with the probabilities that it exists, and that it is where it was found.

    By the posterior of the directions near it given map and sides, and by what its shadow's edges say.

    dark_rgb: (3,) part of the table's light that it gives. alone: what is seen before any light was known. ruled_out:
    lights (4,) that there are not.
    """
    others = without(among, [one])
    darkening = float(dark_rgb.mean())
    images = images_beside(seen, others)
    if others and one.fit is not None:
        seen_again = one.fit.seen_again_in(images.of(one.fit.view), darkening)
        one = replace(one, fit=confirmed(seen_again, images, darkening))
    beside = seen.beside(points_of(others)) if others else alone
    posterior = _posterior(seen, one, others, beside, ruled_out)
    depths = AMONG_OTHERS if others else OF_ONLY_LIGHT
    depth = _depth(seen, one, darkening, depths)
    if one.fit is None:
        depth = min(depth, float(beside.scanned(seen.lit(one.casting[None])).darkenings[0, -1]))
        near, around = (with_edges(each, None, depth, depths) for each in (posterior.near, posterior.around))
        return _rated(one, near, around, posterior.none)
    is_sure = posterior.near >= SURE_BY_TABLE
    most = math.inf if is_sure else most_log_odds(one.fit, images.of(one.fit.view), darkening)
    exists = with_edges(posterior.near, one.fit, depth, depths, most)
    near, around = (exists * _shares(one)).tolist()
    return _rated(replace(one, exists=exists), near, around, 1 - exists)


def _rated(one: FoundLight, near: float, around: float, none: float) -> FoundLight:
    """The light with its probabilities to be within NEAR_RAD and AROUND_RAD; none: that there is no light."""
    return replace(one, confidence=near, around=around if none < MOST_NONE else near)


def _posterior(
    seen: Seen,
    one: FoundLight,
    others: Sequence[FoundLight],
    beside: MarginalLikelihood,
    ruled_out: Sequence[Float],
) -> _Posterior:
    """Of the directions near a light, and of there being none, by map and sides beside the others."""
    scan, templates = beside.everywhere, seen.templates
    is_further = bool(others) and one.exists is not None
    log_none = LOG_NONE_FURTHER if is_further else LOG_NONE
    to_lights = templates.lights[:, :3]
    cosines = to_lights @ one.sun_alike(seen.body.height_m)
    is_near, is_around = cosines > math.cos(NEAR_RAD), cosines > math.cos(AROUND_RAD)
    by_light = scan.log_likelihood + np.log(templates.solid_angle)
    # Steps only count against directions elsewhere, whose shadows would be seen.
    by_light = by_light + np.where(is_around, 0.0, np.minimum(seen.rims(points_of(others)).log_odds, 0.0))
    for rival in ruled_out:
        by_light[~is_near & (to_lights @ rival[:3] > math.cos(APART_RAD))] = -np.inf
    # A lamp's light falls off as that of no direction does.
    lamp = float(beside.scanned(seen.lit(one.casting[None])).log_likelihood[0]) if one.is_lamp else -math.inf
    by_lamp = lamp + math.log(1 - math.cos(NEAR_RAD))
    most = max(float(by_light.max()), by_lamp, log_none)
    posterior = np.exp(by_light - most)
    near, around = float(posterior[is_near].sum()), float(posterior[is_around & ~is_near].sum())
    elsewhere, none = float(posterior[~is_around].sum()), math.exp(log_none - most)
    near = max(near, math.exp(by_lamp - most))
    whole = near + around + elsewhere + none
    return _Posterior(near / whole, (near + around) / whole, none / whole)


def _depth(seen: Seen, one: FoundLight, darkening: float, depths: ShadowDepths) -> float:
    """The part of the table's light that a light's shadow lacks, without what the body hides of the sky there.

    Beside the body's foot, the gradient of the hidden sky looks like a shadow's edge.
    """
    least = darkening - (1 - darkening) / 2  # no body hides more than half of a sky
    if least > depths.pale:
        return least
    return darkening - (1 - darkening) * hidden_step(seen, one)


def _shares(one: FoundLight) -> Float:
    """(2,) probabilities that the light which casts the shadow is within NEAR_RAD, AROUND_RAD, by its covariance."""
    covariance = one.fitted.covariance_rad2
    return np.array([probability_within(NEAR_RAD, covariance), probability_within(AROUND_RAD, covariance)])


def probability_within(radius_rad: float, covariance_rad2: Float) -> float:
    """The probability that an error, normally distributed with a covariance (2, 2), is within a radius."""
    smaller, larger = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance_rad2), 1e-12)).tolist()
    left = [max(radius_rad**2 - (larger * quantile) ** 2, 0.0) for quantile in QUANTILES]
    return sum(math.erf(math.sqrt(each / 2) / smaller) for each in left) / len(left)
