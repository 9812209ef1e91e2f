"""A light's place as a normal distribution, to which every source of evidence adds with its own variance.

Its parameters are those in which shadows are linear: the displacement s of a shadow at the marker's centre per unit of
height, and the nearness w / z, one over the light's height. At any other point p of the plane the displacement is
s - p w / z, so that what is measured at several objects, or in several views, is a sum of informations.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.ground.glint import Glint
from ashe_live.light.lamps.lamp_borders import LampBorders
from ashe_live.light.shape.directions import (
    FittedLight,
    direction_by_displacement,
    displacement_of,
    information_on_displacement,
)
from ashe_live.light.shape.layout import light_parameters, nearness_of
from ashe_live.light.views.joint.aligned import views_per_sample

# Sigma of the ray that a glint shows, on either axis: the ground's relief and its rough reflection move the peak. Three
# of a generated set's four glints are 0.1 to 0.4 degrees off, the other is not the lamp's.
GLINT_SIGMA_RAD = math.radians(1.0)
LAMPS_NEARNESS = 1.5  # 1/m, sigma of the nearness of lamps before a picture is seen: it counts only where that is open
MOST_APART = 9.2  # squared distance of a glint from where its light would show one, in sigmas: 99 % of two dimensions


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A normal distribution of a light's place, in the marker frame."""

    mean: Float  # (3,) displacement s_x, s_y at the marker's centre, and the nearness w / z in 1/m: 0 at infinity
    information: Float  # (3, 3) its inverse covariance, positive definite but for a glint's, which leaves its ray free

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
    def by_nearness(self) -> Float:
        """(3,) how the likeliest parameters change with the nearness, once that is known: the last changes by 1."""
        covariance = self.covariance
        return np.asarray(covariance[:, 2] / covariance[2, 2])

    @property
    def at_infinity(self) -> Float:
        """(3,) the likeliest parameters of a sun."""
        return np.asarray(self.mean - self.by_nearness * self.mean[2])

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
    """The product of independent distributions of one light's place."""
    information = np.sum([place.information for place in places], axis=0)
    pull = np.sum([place.information @ place.mean for place in places], axis=0)
    return Place(np.linalg.solve(information, pull), np.asarray(information))


def place_by_borders(fitted: FittedLight, borders: LampBorders) -> Place:
    """A light's place by one object's borders.

    fitted: the light as it was fitted with its nearness held. borders: what nearness the same borders ask for, and by
    how much the displacement changes with it.
    """
    held = float(nearness_of(fitted.light))
    line = np.column_stack([np.eye(2), -borders.by_nearness])  # the displacement's offset from its line over nearness
    information = line.T @ information_on_displacement(fitted) @ line
    information[2, 2] += 1 / borders.nearness_sigma**2
    at = light_parameters(fitted.light) + borders.by_nearness * (borders.nearness - held)
    return Place(np.append(at, borders.nearness), np.asarray(0.5 * (information + information.T)))


def places_by_glints(glints: Sequence[Glint], light: Place) -> list[Place]:
    """The places by those of some views' mirror images that may be of a light whose place is known roughly."""
    own = [each for each in glints if _is_of(each, light)]
    return [place_by_glint(each, views_per_sample(len(own))) for each in own]


def place_by_glint(glint: Glint, glints_per_sample: float = 1.0) -> Place:
    """A light's place by its mirror image in the ground: it is on the ray which is reflected there.

    glints_per_sample: the number of such glints over their effective sample size.
    """
    line = _seen_from(glint)
    seen = FittedLight(np.append(glint.to_light_marker, 0.0), glints_per_sample * GLINT_SIGMA_RAD**2 * np.eye(2))
    at = np.append(displacement_of(glint.to_light_marker), 0.0)
    return Place(at, np.asarray(line.T @ information_on_displacement(seen) @ line))


def _is_of(glint: Glint, light: Place) -> bool:
    by_displacement = direction_by_displacement(displacement_of(glint.to_light_marker))
    by_place = by_displacement @ _seen_from(glint)
    offset = by_displacement @ displacement_of(glint.to_light_marker) - by_place @ light.mean
    spread = by_place @ light.covariance @ by_place.T + GLINT_SIGMA_RAD**2 * np.eye(2)
    return float(offset @ np.linalg.solve(spread, offset)) < MOST_APART


def _seen_from(glint: Glint) -> Float:
    """(2, 3) derivative of the displacement at a glint by that at the marker's centre and by the nearness."""
    return np.column_stack([np.eye(2), -glint.place_marker])
