"""The probability that a light is where it was found: by map and sides among all directions, and by its edges."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.candidates import APART_RAD, LEAST_DARKENING
from ashe_live.light.known_body.found_light import FoundLight, hidden_step, image_beside, points_of
from ashe_live.light.known_body.marginal_likelihood import MarginalLikelihood, Scan
from ashe_live.light.known_body.outline.elsewhere import most_log_odds
from ashe_live.light.known_body.outline.odds import PALE, PALEST, with_edges
from ashe_live.light.known_body.seen import Seen
from ashe_live.light.known_body.templates import Templates

NEAR_RAD = math.radians(10)  # of an answer, within which it counts as right
# Where there surely is a light, by the probability that there is none, it is stated with its large uncertainty if it
# is as likely within twice as much as an answer has to be.
AROUND_RAD, MOST_NONE = 2 * NEAR_RAD, 0.05
# Weight before the picture is seen of "no light casts a shadow", where all directions together have 1.
LOG_NONE = math.log(0.5)
# The same of a light whose shadow the body may hide, beside one sun whose edges are seen.
LOG_NONE_FURTHER = 0.0
# Of a normal distribution, each in the middle of an equal share of it.
QUANTILES = [NormalDist().inv_cdf((number + 0.5) / 100) for number in range(100)]
SURE_BY_TABLE = 0.95  # probability of a direction by map and sides, from which on edges are not needed


def with_confidence(
    seen: Seen,
    one: FoundLight,
    dark_rgb: Float,
    among: Sequence[FoundLight],
    alone: MarginalLikelihood,
    ruled_out: Sequence[Float],
) -> FoundLight:
    """`one` of the lights `among` which it is, with the posterior of the directions near it, and what its edges say.

    dark_rgb: (3,) part of the table's light that it gives. alone: the picture without lights that are known.
    ruled_out: lights (4,) that there are not.
    """
    others = [other for other in among if other is not one]
    beside, palest, pale, log_none = alone, PALEST, PALE, LOG_NONE
    known = points_of(others)
    if others:
        beside = seen.beside(known)
        palest = pale = LEAST_DARKENING
        log_none = LOG_NONE if one.exists is None else LOG_NONE_FURTHER
        if one.fit is not None:
            one = replace(one, fit=one.fit.seen_again_in(image_beside(seen, others), float(dark_rgb.mean())))
    own = one.casting[None]
    lamp = float(beside.scanned(seen.lit(own)).log_likelihood[0]) if one.is_lamp else -math.inf
    to_sun = one.sun_alike(seen.body.height_m)
    steps = seen.rims(known).log_odds
    directions = _Directions(seen.templates, beside.everywhere, steps, log_none, ruled_out)
    posterior = directions.posterior(to_sun, lamp)
    darkening = float(dark_rgb.mean())
    # Beside the foot the hidden sky's gradient looks like a step. No body hides more than half of a sky.
    step = darkening - (1 - darkening) / 2
    if step <= pale:
        step = darkening - (1 - darkening) * hidden_step(seen, one)
    if one.fit is None:
        step = min(step, float(beside.scanned(seen.lit(own)).darkenings[0, -1]))
        confidence, around = (with_edges(each, None, step, palest, pale) for each in (posterior.near, posterior.around))
        return replace(one, confidence=confidence, around=around if posterior.none < MOST_NONE else confidence)
    most = math.inf
    if posterior.near < SURE_BY_TABLE:
        most = most_log_odds(one.fit, image_beside(seen, others), darkening)
    exists = with_edges(posterior.near, one.fit, step, palest, pale, most)
    confidence, around = (exists * _shares(one)).tolist()
    return replace(one, exists=exists, confidence=confidence, around=around if 1 - exists < MOST_NONE else confidence)


def _shares(one: FoundLight) -> Float:
    """(2,) probability that the light is within NEAR_RAD, AROUND_RAD which casts the shadow, by what its edges leave
    open of it.
    """
    covariance = one.fitted.covariance_rad2
    return np.array([probability_within(NEAR_RAD, covariance), probability_within(AROUND_RAD, covariance)])


def probability_within(radius_rad: float, covariance_rad2: Float) -> float:
    """Of an error that is normally distributed with a covariance (2, 2)."""
    smaller, larger = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance_rad2), 1e-12)).tolist()
    left = [max(radius_rad**2 - (larger * quantile) ** 2, 0.0) for quantile in QUANTILES]
    return sum(math.erf(math.sqrt(each / 2) / smaller) for each in left) / len(left)


@dataclass(frozen=True, slots=True)
class _Posterior:
    """Posterior probabilities of lights."""

    near: float  # of one within NEAR_RAD of a direction
    around: float  # of one within AROUND_RAD
    none: float  # of no light at all


@dataclass(frozen=True, slots=True, eq=False)
class _Directions:
    """All directions of the scan, with the evidence on each before its edges are looked at."""

    templates: Templates
    scan: Scan
    steps: Float  # (m,) log odds of each by steps of light in the map
    log_none: float  # prior weight of no light
    ruled_out: Sequence[Float]  # lights (4,) around which there is none

    def posterior(self, to_sun: Float, lamp: float) -> _Posterior:
        """Of a direction (3,).

        lamp: log likelihood of a lamp there, whose light falls off as that of no sun; -inf where it is none.
        """
        to_lights = self.templates.lights[:, :3]
        by_light = self.scan.log_likelihood + np.log(self.templates.solid_angle)
        by_lamp = lamp + math.log(1 - math.cos(NEAR_RAD))
        cosines = to_lights @ to_sun
        is_near, is_around = cosines > math.cos(NEAR_RAD), cosines > math.cos(AROUND_RAD)
        # Steps only count against directions elsewhere, whose shadows would be seen.
        by_light = by_light + np.where(is_around, 0.0, np.minimum(self.steps, 0.0))
        for rival in self.ruled_out:
            by_light[~is_near & (to_lights @ rival[:3] > math.cos(APART_RAD))] = -np.inf
        most = max(float(by_light.max()), by_lamp, self.log_none)
        posterior = np.exp(by_light - most)
        near, around = float(posterior[is_near].sum()), float(posterior[is_around & ~is_near].sum())
        elsewhere, none = float(posterior[~is_around].sum()), math.exp(self.log_none - most)
        near = max(near, math.exp(by_lamp - most))
        whole = near + around + elsewhere + none
        return _Posterior(near / whole, (near + around) / whole, none / whole)
