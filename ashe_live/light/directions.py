"""Directions towards lights, from the displacements by which their shadows fall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, frozen_floats, set_frozen
from ashe_live.core.transforms import normalised, tangent_basis

HEMISPHERE_RAD = 0.7  # how far a light may be from where it is found, if the outlines tell nothing
# By how much its height may be off where nothing of its shadow's far end is seen: other borders tell lengths by the
# body's shape alone. Measured on pictures cut through their shadows.
UNSEEN_END_RAD = math.radians(6)
HEIGHTS = 64  # at which a density is looked at


@dataclass(frozen=True, slots=True)
class FittedLight:
    """A direction towards a light, and how well the outlines determine it."""

    to_light_marker: Float  # (3,) unit
    covariance_rad2: Float  # (2, 2) on the tangent basis: larger azimuth, larger elevation

    def __post_init__(self) -> None:
        set_frozen(
            self,
            to_light_marker=frozen_floats(normalised(self.to_light_marker), (3,), "to_light_marker"),
            covariance_rad2=frozen_floats(self.covariance_rad2, (2, 2), "covariance_rad2"),
        )


def fitted_lights(slants: Float, covariance: Float) -> tuple[FittedLight, ...]:
    """Displacements (l, 2) and their covariance (2 l, 2 l) as directions."""
    lights = []
    for i, slant in enumerate(slants):
        own, slope = np.s_[2 * i : 2 * i + 2], _direction_by_slant(slant)
        spread = slope @ covariance[own, own] @ slope.T
        lights.append(FittedLight(np.array([*slant, 1.0]), 0.5 * (spread + spread.T)))
    return tuple(lights)


def slants_of(lights: Sequence[FittedLight]) -> tuple[Float, Float]:
    """Displacements (l, 2) of lights, each found for itself, and the information (2 l, 2 l) on them."""
    towards = np.array([light.to_light_marker for light in lights])
    slants, information = towards[:, :2] / towards[:, 2:], np.zeros((2 * len(lights), 2 * len(lights)))
    for i, (light, slant) in enumerate(zip(lights, slants, strict=True)):
        own, slope = np.s_[2 * i : 2 * i + 2], _direction_by_slant(slant)
        information[own, own] = slope.T @ np.linalg.solve(light.covariance_rad2, slope)
    return slants, information


def above_the_ground(information: Float, slants: Float) -> Float:
    """Information (2 l, 2 l) on slants (l, 2) and that a light is on the hemisphere."""
    total = information.copy()
    for i, slant in enumerate(slants):
        own, slope = np.s_[2 * i : 2 * i + 2], _direction_by_slant(slant)
        total[own, own] += slope.T @ slope / HEMISPHERE_RAD**2
    return total


def with_end_seen(light: FittedLight, seen: float) -> FittedLight:
    """What is known of it when so much, 0 to 1, of its shadow's far end is seen.

    Unseen, a shadow may be longer than found but not shorter, and the light as much lower. How low is told by what else
    told its height, the covariance; and long ends out of the picture are rarer than short ones.
    """
    height, deviation = math.asin(light.to_light_marker[2]), math.sqrt(light.covariance_rad2[1, 1])
    heights = np.linspace(max(0.0, height - 5 * deviation), height, HEIGHTS)
    likelihood = heights * np.exp(-0.5 * ((heights - height) / deviation) ** 2)
    mean = np.average(heights, weights=likelihood)
    variance = np.average((heights - mean) ** 2, weights=likelihood) + UNSEEN_END_RAD**2
    change = np.array([1.0, seen + (1 - seen) * math.sqrt(variance) / deviation])
    down = (1 - seen) ** 2 * (height - mean)
    lowered = math.cos(down) * light.to_light_marker - math.sin(down) * tangent_basis(light.to_light_marker)[1]
    return FittedLight(lowered, light.covariance_rad2 * np.outer(change, change))


def _direction_by_slant(slant: Float) -> Float:
    """(2, 2) derivative of the direction (s, 1) / |(s, 1)|, on its tangent basis, by s."""
    towards = np.array([*slant, 1.0])
    return np.asarray(tangent_basis(towards)[:, :2] / np.linalg.norm(towards))
