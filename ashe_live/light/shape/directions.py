"""Directions towards lights, and their covariances, from the displacements s of their shadows."""

import math
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float, frozen_floats, set_frozen
from ashe_live.core.transforms import normalised, tangent_basis
from ashe_live.light.shape.layout import ParameterLayout, light_parameters

HEMISPHERE_RAD = 0.7  # sigma of the prior that a light is somewhere on the hemisphere
# Sigma of a light's height if its shadow's far end is out of the picture, as the other borders determine lengths only
# through the body's shape. Measured on pictures cut through their shadows.
UNSEEN_END_RAD = math.radians(6)
HEIGHTS = 64  # at which a probability density is sampled


@dataclass(frozen=True, slots=True)
class FittedLight:
    """A light, and the covariance of the direction towards it by the outlines."""

    light: Float  # (4,) homogeneous point, marker frame, scaled to a unit vector (x, y, z)
    covariance_rad2: Float  # (2, 2) on the tangent basis: larger azimuth, larger elevation
    # Of the elevation's variance, the share that comes from a shadow's end out of view: errors of outlines are no part.
    unseen_end: float = 0.0

    def __post_init__(self) -> None:
        light = frozen_floats(self.light, (4,), "light")
        unit = np.append(normalised(light[:3]), light[3] / np.linalg.norm(light[:3]))
        set_frozen(
            self,
            light=frozen_floats(unit, (4,), "light"),
            covariance_rad2=frozen_floats(self.covariance_rad2, (2, 2), "covariance_rad2"),
        )

    @property
    def is_lamp(self) -> bool:
        """Whether it is near by."""
        return bool(self.light[3] > 0)

    @property
    def to_light_marker(self) -> Float:
        """(3,) the unit vector from the marker's centre towards the light."""
        return self.light[:3]


def fitted_lights(lights: Float, covariance: Float) -> tuple[FittedLight, ...]:
    """Lights (l, 4), with the covariance of their directions from that (split, split) of their displacements s."""
    fitted, layout = [], ParameterLayout(len(lights))
    for i, (light, displacement) in enumerate(zip(lights, light_parameters(lights), strict=True)):
        block, slope = layout.light(i), direction_by_displacement(displacement)
        spread = slope @ covariance[block, block] @ slope.T
        fitted.append(FittedLight(light / light[2], 0.5 * (spread + spread.T)))
    return tuple(fitted)


def displacement_of(to_light_marker: Float) -> Float:
    """(2,) displacement s, per unit of height, of the shadows in a light above the ground."""
    return np.asarray(to_light_marker[:2] / to_light_marker[2])


def information_on_displacement(light: FittedLight) -> Float:
    """(2, 2) information on the displacement s of a light, whose covariance must be positive definite."""
    slope = direction_by_displacement(displacement_of(light.to_light_marker))
    return np.asarray(slope.T @ np.linalg.solve(light.covariance_rad2, slope))


def with_hemisphere_prior(information: Float, lights: Float) -> Float:
    """`information` (split, split) on the displacements of lights (l, 4), plus the prior on the hemisphere."""
    total, layout = information.copy(), ParameterLayout(len(lights))
    for i, displacement in enumerate(light_parameters(lights)):
        block, slope = layout.light(i), direction_by_displacement(displacement)
        total[block, block] += slope.T @ slope / HEMISPHERE_RAD**2
    return total


def corrected_for_cut_shadow(light: FittedLight, visible_fraction: float) -> FittedLight:
    """The light with its height corrected for a shadow whose far end is only partly in the picture.

    visible_fraction: that of the far end in the picture, 0 to 1. Outside of it a shadow may be longer than was fitted
    but not shorter, so the light may be lower but not higher. The posterior of its height combines the covariance,
    which must be positive definite, with a prior by which long ends out of view are rarer than short ones ((22b) of
    docs/maths).
    """
    height, deviation = math.asin(light.to_light_marker[2]), math.sqrt(light.covariance_rad2[1, 1])
    lowest = max(0.0, height - 5 * deviation)
    heights = lowest + (np.arange(HEIGHTS) + 0.5) / HEIGHTS * (height - lowest)
    likelihood = heights * np.exp(-0.5 * ((heights - height) / deviation) ** 2)
    mean = np.average(heights, weights=likelihood)
    variance = np.average((heights - mean) ** 2, weights=likelihood) + UNSEEN_END_RAD**2
    down = (1 - visible_fraction) ** 2 * (height - mean)
    lowered = math.cos(down) * light.to_light_marker - math.sin(down) * tangent_basis(light.to_light_marker)[1]
    # The azimuth keeps its uncertainty as an angle, which is a longer arc at a lower elevation.
    wider = max(1.0, math.cos(height - down) / max(math.cos(height), math.sqrt(light.covariance_rad2[0, 0])))
    by_outlines, by_unseen_end = visible_fraction, (1 - visible_fraction) * math.sqrt(variance) / deviation
    change = np.array([wider, by_outlines + by_unseen_end])
    unseen_end = 1 - (by_outlines / (by_outlines + by_unseen_end)) ** 2
    covariance = light.covariance_rad2 * np.outer(change, change)
    return FittedLight(np.append(lowered, light.light[3]), covariance, unseen_end)


def direction_by_displacement(displacement: Float) -> Float:
    """(2, 2) derivative by s of the direction (s, 1) / |(s, 1)|, on its tangent basis."""
    to_light = np.array([*displacement, 1.0])
    return np.asarray(tangent_basis(to_light)[:, :2] / np.linalg.norm(to_light))
