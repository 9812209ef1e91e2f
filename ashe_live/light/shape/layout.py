"""The layout of theta, the parameter vector of a fit: those of the lights, one after the other, then the shape's."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ashe_live.core.arrays import Float


@dataclass(frozen=True, slots=True)
class Layout:
    """The positions of parameters in theta (..., split + q) for a number of lights and any shape."""

    lights: int
    # The displacement s of a shadow per unit of height: lights are varied as directions.
    PER_LIGHT: ClassVar[int] = 2

    @property
    def split(self) -> int:
        """The number of the lights' parameters, and the index of the shape's first."""
        return self.PER_LIGHT * self.lights

    def light(self, number: int) -> slice:
        """The parameters of light `number`."""
        return slice(self.PER_LIGHT * number, self.PER_LIGHT * (number + 1))

    def lights_of(self, theta: Float, nearness: Float | float = 0.0) -> Float:
        """(..., l, 4) the lights as homogeneous points with z = 1.

        nearness: (l,) their w / z, which is no part of theta; 0 for lights at infinity.
        """
        parameters = theta[..., : self.split].reshape(*theta.shape[:-1], self.lights, self.PER_LIGHT)
        points = np.zeros((*parameters.shape[:-1], 4))
        points[..., : self.PER_LIGHT], points[..., 2], points[..., 3] = parameters, 1.0, nearness
        return points

    def shape_of(self, theta: Float) -> Float:
        """(..., q) the shape's parameters."""
        return theta[..., self.split :]

    @classmethod
    def theta(cls, lights: Float, shape: Float) -> Float:
        """(split + q,) the parameter vector of lights (l, 4), without their nearness, and a shape (q,)."""
        return np.append(light_parameters(lights), shape)


def nearness_of(lights: Float) -> Float:
    """(..., l) the nearness w / z of lights (..., l, 4): 0 at infinity, else one over a lamp's height."""
    return np.asarray(lights[..., 3] / lights[..., 2])


def light_parameters(lights: Float) -> Float:
    """(..., l, 2) the parameters of lights (..., l, 4): the displacement s = (x, y) / z of each."""
    return np.asarray(lights[..., : Layout.PER_LIGHT] / lights[..., 2:3])
