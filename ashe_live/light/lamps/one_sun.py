"""A sun's direction from all objects in its light, each of which measures it with errors of its own.

What a body's model cannot show of an object, and labels that are a little off, move that object's answer by degrees.
Another object errs independently, so that their mean, weighted by informations, is nearer to the truth and surer.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import normalised, on_tangent_basis, radius_of_68_percent, tangent_basis
from ashe_live.light.lamps.place import Place
from ashe_live.light.shape.directions import FittedLight, displacement_of, information_on_displacement

AT_INFINITY = 1e-3  # 1/m, sigma of a sun's nearness
LEAST_RAD = math.radians(0.1)  # sigma of an object's own error, below which rounding would decide


def place_of_sun(sun: FittedLight) -> Place:
    """Where a light is that is at infinity."""
    information = np.zeros((3, 3))
    information[:2, :2] = information_on_displacement(sun)
    information[2, 2] = AT_INFINITY**-2
    return Place(np.append(displacement_of(sun.to_light_marker), 0.0), information)


def by_all_objects(light: Light, objects: Sequence[FittedLight], shared_rad2: Callable[[Float], Float]) -> Light:
    """The light, as one object shows it, where several objects show it together.

    objects: the light as each of them shows it, that one first, with covariances of all causes. shared_rad2: of a
    direction (3,) the part of these, (2, 2) on its tangent basis, that all objects err by alike, as by the marker's
    pose; more of them make it no smaller.
    """
    east_and_up = tangent_basis(light.to_light_marker)
    pull, information = np.zeros(2), np.zeros((2, 2))
    for each in objects:
        # A turned marker moves lights from elsewhere otherwise: what is an object's own is left of all by its own.
        sigmas2, axes = np.linalg.eigh(each.covariance_rad2 - shared_rad2(each.to_light_marker))
        own_there = (axes * np.maximum(sigmas2, LEAST_RAD**2)) @ axes.T
        own = np.linalg.inv(on_tangent_basis(light.to_light_marker, own_there, each.to_light_marker))
        information += own
        pull += own @ (east_and_up @ each.to_light_marker)
    own_rad2 = np.asarray(np.linalg.inv(information), dtype=np.float64)
    towards = normalised(light.to_light_marker + (own_rad2 @ pull) @ east_and_up)
    covariance = on_tangent_basis(towards, own_rad2, light.to_light_marker) + shared_rad2(towards)
    sigma_rad = radius_of_68_percent(covariance)
    return replace(light, to_light_marker=towards, covariance_rad2=covariance, sigma_rad=sigma_rad)
