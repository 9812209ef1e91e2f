"""The direction at the marker of a light that may be a sun or a lamp, where the picture does not decide for sure.

A sun that explains an object's shadow is right at the object. Beside it the direction of a lamp differs: half a metre
away, 15 cm beside the object, by 17 degrees. Evidence too weak to state a lamp still gives an expectation there.
"""

import math
from dataclasses import replace

import numpy as np

from ashe_live.core.light import Light
from ashe_live.light.explanation.judgement.judge import GOOD_RAD
from ashe_live.light.lamps.mixture import covariance_of, errors_of
from ashe_live.light.lamps.place import LAMPS_NEARNESS, Place
from ashe_live.light.shape.directions import (
    FittedLight,
    direction_by_displacement,
    displacement_of,
    information_on_displacement,
)

# Prior probability of a lamp. It counts only for the direction at the marker, and only where the evidence leaves open
# which of the two the light is.
LAMPS_SHARE = 0.5
# Deviance of a sun that chance alone exceeds once in twenty (chi-squared, one-sided, as a lamp is only nearer than a
# sun): below it a sun's direction stays as it was measured.
CHANCE_DEVIANCE = 2.71
MOST_LOG_ODDS = 20.0  # of a lamp against a sun, either way
FAR_TAIL = -5.0  # argument of erf, below which its asymptote is used


def with_doubt(light: Light, place: Place, from_sun: Place, deviance: float, by_outlines: float = 0.0) -> Light:
    """The direction at the marker's centre, expected over a sun and a lamp, of which neither is certain.

    light: as a sun's. place: the light's, if it is a lamp; from_sun: to first order about a light at infinity, by which
    the two are weighted. deviance: of a sun beside that lamp, if unevenness is at its worst. by_outlines: the same by
    the outlines in several views, where bodies were fitted to both.
    """
    assert light.covariance_rad2 is not None
    by_ground = min(_log_ratio(from_sun), _log_ratio_at(place, deviance))
    log_odds = by_ground + 0.5 * by_outlines + math.log(LAMPS_SHARE / (1 - LAMPS_SHARE))
    probability = 1 / (1 + math.exp(-min(max(log_odds, -MOST_LOG_ODDS), MOST_LOG_ODDS)))
    nearness, variance = _positive(*_with_prior(place))
    line = place.by_nearness[:2]
    as_lamp = place.mean[:2] + line * (nearness - place.mean[2])
    of_lamp = place.covariance[:2, :2] - (place.nearness_sigma**2 - variance) * np.outer(line, line)
    sun = FittedLight(np.append(light.to_light_marker, 0.0), light.covariance_rad2)
    as_sun, of_sun = displacement_of(light.to_light_marker), np.linalg.inv(information_on_displacement(sun))
    moved = probability if deviance + by_outlines > CHANCE_DEVIANCE else 0.0
    expected = as_sun + moved * (as_lamp - as_sun)
    slope = direction_by_displacement(expected)
    shares = np.array([1 - probability, probability])
    offsets = np.stack([as_sun - expected, as_lamp - expected]) @ slope.T
    spreads = np.stack([slope @ each @ slope.T for each in (of_sun, of_lamp)])
    covariance = covariance_of(offsets, spreads, shares)
    errors = errors_of(offsets, spreads, shares)
    alone = errors_of(np.zeros((1, 2)), light.covariance_rad2[None], np.ones(1))
    good = min(errors.within(GOOD_RAD) / max(alone.within(GOOD_RAD), 1e-9), 1.0)
    return replace(
        light,
        to_light_marker=np.array([*expected, 1.0]) / math.hypot(*expected, 1.0),
        covariance_rad2=0.5 * (covariance + covariance.T),
        sigma_rad=min(errors.radius(0.68), math.pi),
        confidence=None if light.confidence is None else light.confidence * good,
    )


def _with_prior(place: Place) -> tuple[float, float]:
    """Mean and variance of a lamp's nearness at a place, with the prior on lamps but for its sign."""
    variance = place.nearness_sigma**2
    total = variance + LAMPS_NEARNESS**2
    return float(place.mean[2]) * LAMPS_NEARNESS**2 / total, variance * LAMPS_NEARNESS**2 / total


def _log_ratio(place: Place) -> float:
    """Log of the likelihood of a lamp over that of a sun, by a nearness that is normally distributed about 0."""
    mean, variance = _with_prior(place)
    apart = mean / math.sqrt(2 * variance)
    return 0.5 * math.log(variance / LAMPS_NEARNESS**2) + apart**2 + _log_side(apart)


def _log_ratio_at(place: Place, deviance: float) -> float:
    """The same by Laplace's approximation about a lamp's place, by the deviance of a sun from it."""
    mean, variance = _with_prior(place)
    volume = 0.5 * math.log(variance / LAMPS_NEARNESS**2) + _log_side(mean / math.sqrt(2 * variance))
    # A lamp's nearness lies as far from 0 as its own sigma and the prior's allow together.
    return 0.5 * deviance + volume - 0.5 * float(place.mean[2]) ** 2 / (place.nearness_sigma**2 + LAMPS_NEARNESS**2)


def _log_side(x: float) -> float:
    """ln(1 + erf(x)): lamps are nearer than infinity, not farther."""
    return math.log(math.erfc(-x)) if x > FAR_TAIL else -(x**2) - math.log(-x * math.sqrt(math.pi))


def _positive(mean: float, variance: float) -> tuple[float, float]:
    """Mean and variance of a normal distribution where it is positive."""
    sigma = math.sqrt(variance)
    x = mean / (sigma * math.sqrt(2))
    if x <= FAR_TAIL:
        return variance / -mean, (variance / mean) ** 2
    hazard = math.sqrt(2 / math.pi) * math.exp(-(x**2) - _log_side(x))
    return mean + sigma * hazard, variance * (1 - hazard * (mean / sigma + hazard))
