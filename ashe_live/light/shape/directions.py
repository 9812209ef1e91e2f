"""Directions towards lights, from the displacements by which their shadows fall."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, frozen_floats, set_frozen
from ashe_live.core.transforms import normalised, tangent_basis
from ashe_live.light.shape.layout import Layout, numbers_of
from ashe_live.light.shape.light_points import at_infinity

HEMISPHERE_RAD = 0.7  # how far a light may be from where it is found, if the outlines tell nothing
# By how much its height may be off where its shadow's far end is out of the picture: other borders tell lengths by the
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

    @property
    def point(self) -> Float:
        """(1, 4) as homogeneous points are stacked."""
        return at_infinity(self.to_light_marker[None])


def fitted_lights(lights: Float, covariance: Float) -> tuple[FittedLight, ...]:
    """Lights (l, 4), all of them directions, and their numbers' covariance (split, split)."""
    fitted, layout = [], Layout(len(lights))
    for i, slant in enumerate(numbers_of(lights)):
        own, slope = layout.light(i), direction_by_slant(slant)
        spread = slope @ covariance[own, own] @ slope.T
        fitted.append(FittedLight(np.array([*slant, 1.0]), 0.5 * (spread + spread.T)))
    return tuple(fitted)


def slant_of(to_light_marker: Float) -> Float:
    """(2,) displacement s by which a light above the ground throws shadows, for a unit of height."""
    return np.asarray(to_light_marker[:2] / to_light_marker[2])


def information_on_slant(light: FittedLight) -> Float:
    """(2, 2) on its displacement; its covariance must be positive definite."""
    slope = direction_by_slant(slant_of(light.to_light_marker))
    return np.asarray(slope.T @ np.linalg.solve(light.covariance_rad2, slope))


def above_the_ground(information: Float, lights: Float) -> Float:
    """Information (split, split) on the numbers of lights (l, 4), and that each is on the hemisphere."""
    total, layout = information.copy(), Layout(len(lights))
    for i, slant in enumerate(numbers_of(lights)):
        own, slope = layout.light(i), direction_by_slant(slant)
        total[own, own] += slope.T @ slope / HEMISPHERE_RAD**2
    return total


def with_end_in_view(light: FittedLight, share: float) -> FittedLight:
    """What is known of it when so much, 0 to 1, of its shadow's far end is in the picture.

    Out of it, a shadow may be longer than found but not shorter, and the light as much lower. How low is told by what
    else told its height, the covariance, which must be positive definite; and long ends out of the picture are rarer
    than short ones.
    """
    height, deviation = math.asin(light.to_light_marker[2]), math.sqrt(light.covariance_rad2[1, 1])
    lowest = max(0.0, height - 5 * deviation)
    heights = lowest + (np.arange(HEIGHTS) + 0.5) / HEIGHTS * (height - lowest)
    likelihood = heights * np.exp(-0.5 * ((heights - height) / deviation) ** 2)
    mean = np.average(heights, weights=likelihood)
    variance = np.average((heights - mean) ** 2, weights=likelihood) + UNSEEN_END_RAD**2
    down = (1 - share) ** 2 * (height - mean)
    lowered = math.cos(down) * light.to_light_marker - math.sin(down) * tangent_basis(light.to_light_marker)[1]
    # The compass azimuth is as sure as before: the same angle is a longer arc lower down.
    wider = max(1.0, math.cos(height - down) / max(math.cos(height), math.sqrt(light.covariance_rad2[0, 0])))
    change = np.array([wider, share + (1 - share) * math.sqrt(variance) / deviation])
    return FittedLight(lowered, light.covariance_rad2 * np.outer(change, change))


def direction_by_slant(slant: Float) -> Float:
    """(2, 2) derivative of the direction (s, 1) / |(s, 1)|, on its tangent basis, by s."""
    towards = np.array([*slant, 1.0])
    return np.asarray(tangent_basis(towards)[:, :2] / np.linalg.norm(towards))
