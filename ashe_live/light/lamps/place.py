"""What is known of a light's place: a normal distribution, to which every source adds with its own variance.

Its parameters are those in which shadows are linear: the displacement s of a shadow at the marker's centre per unit of
height, and the nearness w / z, one over the light's height. At any other point p of the plane the displacement is
s - p w / z, so that what is measured at several objects, or in several views, is a sum of informations.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.lamps.borders import LampBorders
from ashe_live.light.shape.directions import FittedLight, direction_by_displacement, information_on_displacement
from ashe_live.light.shape.layout import light_parameters, nearness_of


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A normal distribution of a light's place, in the marker frame."""

    mean: Float  # (3,) displacement s_x, s_y at the marker's centre, and the nearness w / z in 1/m: 0 at infinity
    information: Float  # (3, 3) its inverse covariance, positive definite

    @property
    def light(self) -> Float:
        """(4,) the homogeneous point, scaled to a unit vector (x, y, z)."""
        x, y, nearness = self.mean
        return np.array([x, y, 1.0, nearness]) / math.sqrt(x * x + y * y + 1)

    @property
    def covariance(self) -> Float:
        """(3, 3) of displacement and nearness."""
        scale = np.sqrt(np.diag(self.information))
        return np.asarray(np.linalg.inv(self.information / np.outer(scale, scale)) / np.outer(scale, scale))

    @property
    def nearness_sigma(self) -> float:
        """1/m"""
        return math.sqrt(self.covariance[2, 2])

    @property
    def standard_errors(self) -> float:
        """By how many of them the nearness differs from a sun's; negative for one beyond infinity."""
        return float(self.mean[2]) / self.nearness_sigma

    @property
    def lamp_covariance(self) -> Float:
        """(3, 3) on (larger azimuth, larger elevation, larger inverse distance), at the marker's centre."""
        x, y, nearness = self.mean
        squared = x * x + y * y + 1
        slope = np.zeros((3, 3))
        slope[:2, :2] = direction_by_displacement(self.mean[:2])
        slope[2] = np.array([-x * nearness / squared, -y * nearness / squared, 1.0]) / math.sqrt(squared)
        spread = slope @ self.covariance @ slope.T
        return np.asarray(0.5 * (spread + spread.T))


def combined(places: Sequence[Place]) -> Place:
    """What independent sources tell together."""
    information = np.sum([place.information for place in places], axis=0)
    pull = np.sum([place.information @ place.mean for place in places], axis=0)
    return Place(np.linalg.solve(information, pull), np.asarray(information))


def place_by_borders(fitted: FittedLight, borders: LampBorders) -> Place:
    """What one object's borders tell.

    fitted: the light as it was fitted with its nearness held. borders: what nearness the same borders ask for, and by
    how much the displacement changes with it.
    """
    held = float(nearness_of(fitted.light))
    line = np.column_stack([np.eye(2), -borders.by_nearness])  # the displacement's offset from its line over nearness
    information = line.T @ information_on_displacement(fitted) @ line
    information[2, 2] += 1 / borders.nearness_sigma**2
    at = light_parameters(fitted.light) + borders.by_nearness * (borders.nearness - held)
    return Place(np.append(at, borders.nearness), np.asarray(0.5 * (information + information.T)))
