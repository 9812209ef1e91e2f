"""The direction at the marker of a light that may be a sun or a lamp, where the picture tells neither for sure.

A sun that explains an object's shadow is right at the object. Beside it a lamp is elsewhere: half a metre away, 15 cm
beside the object, by 17 degrees. The evidence that is too weak to state a lamp still tells what to expect there.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import Light
from ashe_live.light.explanation.judgement.judge import GOOD_RAD, probability_of_good
from ashe_live.light.lamps.place import Place
from ashe_live.light.shape.directions import (
    FittedLight,
    direction_by_displacement,
    displacement_of,
    information_on_displacement,
)

# Sigma of the nearness of lamps (1/m), and the probability of a lamp before a picture is seen: both count only where
# the evidence leaves it open, in what the direction is at the marker.
LAMPS_NEARNESS, LAMPS_SHARE = 1.5, 0.5
# That chance exceeds once in twenty, as lamps are on one side of a sun: below it a sun's direction stays as it was
# measured.
CHANCE_DEVIANCE = 2.71
MOST_LOG_ODDS = 20.0  # of a lamp against a sun, either way
FAR_TAIL = -5.0  # argument of erf, below which its asymptote is used
CIRCLES, POINTS = 24, 24  # of equal probability, that stand for a normal distribution; and on each of them


def with_doubt(light: Light, place: Place, from_sun: Place, deviance: float) -> Light:
    """The direction at the marker's centre, expected over a sun and a lamp, of which neither is certain.

    light: as a sun's. place: the light's, if it is a lamp; from_sun: to first order about a light at infinity, by which
    the two are weighed. deviance: of a sun beside that lamp, if unevenness is at its worst.
    """
    assert light.covariance_rad2 is not None
    log_odds = min(_log_ratio(from_sun), _log_ratio_at(place, deviance)) + math.log(LAMPS_SHARE / (1 - LAMPS_SHARE))
    probability = 1 / (1 + math.exp(-min(max(log_odds, -MOST_LOG_ODDS), MOST_LOG_ODDS)))
    nearness, variance = _positive(*_with_prior(place))
    line = place.covariance[:2, 2] / place.covariance[2, 2]
    as_lamp = place.mean[:2] + line * (nearness - place.mean[2])
    of_lamp = place.covariance[:2, :2] - (place.nearness_sigma**2 - variance) * np.outer(line, line)
    sun = FittedLight(np.append(light.to_light_marker, 0.0), light.covariance_rad2)
    as_sun, of_sun = displacement_of(light.to_light_marker), np.linalg.inv(information_on_displacement(sun))
    moved = probability if deviance > CHANCE_DEVIANCE else 0.0
    expected = as_sun + moved * (as_lamp - as_sun)
    slope = direction_by_displacement(expected)
    shares = np.array([1 - probability, probability])
    offsets = np.stack([as_sun - expected, as_lamp - expected]) @ slope.T
    spreads = np.stack([slope @ each @ slope.T for each in (of_sun, of_lamp)])
    covariance = np.einsum("i,ijk->jk", shares, spreads + offsets[:, :, None] * offsets[:, None, :])
    errors = _errors(offsets, spreads, shares)
    alone = _errors(np.zeros((1, 2)), light.covariance_rad2[None], np.ones(1))
    good = min(errors.within(GOOD_RAD) / max(alone.within(GOOD_RAD), 1e-9), 1.0)
    return replace(
        light,
        to_light_marker=np.array([*expected, 1.0]) / math.hypot(*expected, 1.0),
        covariance_rad2=0.5 * (covariance + covariance.T),
        sigma_rad=min(errors.radius(0.68), math.pi),
        confidence=None if light.confidence is None else light.confidence * good,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Errors:
    """The distribution of a direction's error, by samples."""

    radii: Float  # (n,) radians, increasing
    probability: Float  # (n,) that an error is no larger

    def radius(self, probability: float) -> float:
        return float(np.interp(probability, self.probability, self.radii))

    def within(self, radius_rad: float) -> float:
        return float(np.interp(radius_rad, self.radii, self.probability))


def _errors(offsets: Float, spreads: Float, shares: Float) -> _Errors:
    """Of a mixture of normal distributions: offsets (n, 2) from the answer, covariances (n, 2, 2), shares (n,)."""
    turns = (np.arange(POINTS) + 0.5) * (2 * math.pi / POINTS)
    radii = np.sqrt(-2 * np.log1p(-(np.arange(CIRCLES) + 0.5) / CIRCLES))  # quantiles of Rayleigh's distribution
    samples = (radii[:, None, None] * np.column_stack([np.cos(turns), np.sin(turns)])).reshape(-1, 2)
    values, vectors = np.linalg.eigh(spreads)
    along = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    errors = np.linalg.norm(offsets[:, None] + samples @ along.transpose(0, 2, 1), axis=2)
    order = np.argsort(errors, axis=None)
    cumulated = np.cumsum(np.repeat(shares / len(samples), len(samples))[order])
    return _Errors(np.append(0.0, errors.ravel()[order]), np.append(0.0, cumulated))


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
    return 0.5 * deviance + volume - 0.5 * (mean / LAMPS_NEARNESS) ** 2


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


def confidence_within(light: Light, covariance_rad2: Float) -> float | None:
    """The light's confidence, lowered by what a wider covariance leaves of directions within 10 degrees."""
    if light.confidence is None or light.covariance_rad2 is None:
        return None
    before, after = (probability_of_good(each) for each in (light.covariance_rad2, covariance_rad2))
    return light.confidence * min(after / before, 1.0)
