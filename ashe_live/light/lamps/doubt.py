"""The direction at the marker of a light that may be a sun or a lamp, where the picture tells neither for sure.

A sun that explains an object's shadow is right at the object. Beside it a lamp is elsewhere: half a metre away, 15 cm
beside the object, by 17 degrees. The evidence that is too weak to state a lamp still tells what to expect there.
"""

import math
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.core.types import Light
from ashe_live.light.explanation.judgement.judge import probability_of_good
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
# Deviance of a sun that leaves sun and lamp even: 3 sigmas, which ground that is uneven in another way shows, too.
EVEN_DEVIANCE = 9.0
CHANCE_DEVIANCE = 3.84  # that chance exceeds once in twenty: below it a sun's direction stays as it was measured
MOST_LOG_ODDS = 20.0  # of a lamp against a sun, either way


def with_doubt(light: Light, place: Place, from_sun: Place, deviance: float) -> Light:
    """The direction at the marker's centre, expected over a sun and a lamp, of which neither is certain.

    light: as a sun's. place: the light's, if it is a lamp; from_sun: to first order about a light at infinity, by which
    the two are weighed. deviance: of a sun beside that lamp, if unevenness is at its worst.
    """
    assert light.covariance_rad2 is not None
    *_, log_ratio = _if_lamp(from_sun)
    log_odds = min(log_ratio, 0.5 * (deviance - EVEN_DEVIANCE)) + math.log(LAMPS_SHARE / (1 - LAMPS_SHARE))
    probability = 1 / (1 + math.exp(-min(max(log_odds, -MOST_LOG_ODDS), MOST_LOG_ODDS)))
    mean, left, _ = _if_lamp(place)
    line = place.covariance[:2, 2] / place.covariance[2, 2]
    as_lamp = place.mean[:2] + line * (max(mean, 0.0) - place.mean[2])
    of_lamp = place.covariance[:2, :2] - (place.nearness_sigma**2 - left) * np.outer(line, line)
    sun = FittedLight(np.append(light.to_light_marker, 0.0), light.covariance_rad2)
    as_sun, of_sun = displacement_of(light.to_light_marker), np.linalg.inv(information_on_displacement(sun))
    apart = as_lamp - as_sun
    moved = probability if deviance > CHANCE_DEVIANCE and mean > 0 else 0.0
    expected = as_sun + moved * apart
    about_it = probability * (1 - moved) ** 2 + (1 - probability) * moved**2
    spread = probability * of_lamp + (1 - probability) * of_sun + about_it * np.outer(apart, apart)
    slope = direction_by_displacement(expected)
    covariance = slope @ spread @ slope.T
    return replace(
        light,
        to_light_marker=np.array([*expected, 1.0]) / math.hypot(*expected, 1.0),
        covariance_rad2=0.5 * (covariance + covariance.T),
        sigma_rad=radius_of_68_percent(covariance),
        confidence=confidence_within(light, covariance),
    )


def _if_lamp(place: Place) -> tuple[float, float, float]:
    """Mean and variance of a lamp's nearness at a place, and the log of its likelihood over that of a sun."""
    nearness, variance = float(place.mean[2]), place.nearness_sigma**2
    total = variance + LAMPS_NEARNESS**2
    mean, left = nearness * LAMPS_NEARNESS**2 / total, variance * LAMPS_NEARNESS**2 / total
    apart = mean / math.sqrt(2 * left)
    # Lamps are nearer than infinity, not farther: exp(x²) (1 + erf(x)), by its asymptote where rounding leaves none.
    log_side = apart**2 + math.log1p(math.erf(apart)) if apart > -5 else -math.log(-apart * math.sqrt(math.pi))
    return mean, left, 0.5 * math.log(variance / total) + log_side


def confidence_within(light: Light, covariance_rad2: Float) -> float | None:
    """The light's confidence, lowered by what a wider covariance leaves of directions within 10 degrees."""
    if light.confidence is None or light.covariance_rad2 is None:
        return None
    before, after = (probability_of_good(each) for each in (light.covariance_rad2, covariance_rad2))
    return light.confidence * min(after / before, 1.0)
