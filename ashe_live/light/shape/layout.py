"""The layout of theta, the parameter vector of a fit: those of the lights, one after the other, then the shape's."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ashe_live.core.arrays import Float


@dataclass(frozen=True, slots=True)
class ParameterLayout:
    """The positions of parameters in theta (..., split + q) for a number of lights and any shape."""

    lights: int
    with_nearness: bool = False  # whether the nearness w / z of each light is varied too, its third parameter
    # The displacement s of a shadow per unit of height.
    PER_DIRECTION: ClassVar[int] = 2

    @property
    def per_light(self) -> int:
        """The number of parameters of one light."""
        return self.PER_DIRECTION + self.with_nearness

    @property
    def split(self) -> int:
        """The number of the lights' parameters, and the index of the shape's first."""
        return self.per_light * self.lights

    def light(self, number: int) -> slice:
        """The parameters of light `number`."""
        return slice(self.per_light * number, self.per_light * (number + 1))

    def lights_of(self, theta: Float, nearness: Float | float = 0.0) -> Float:
        """(..., l, 4) the lights as homogeneous points with z = 1.

        nearness: (l,) their w / z where it is no part of theta; 0 for lights at infinity.
        """
        parameters = theta[..., : self.split].reshape(*theta.shape[:-1], self.lights, self.per_light)
        points = np.zeros((*parameters.shape[:-1], 4))
        points[..., :2], points[..., 2] = parameters[..., :2], 1.0
        points[..., 3] = parameters[..., 2] if self.with_nearness else nearness
        return points

    def shape_of(self, theta: Float) -> Float:
        """(..., q) the shape's parameters."""
        return theta[..., self.split :]

    def theta(self, lights: Float, shape: Float) -> Float:
        """(split + q,) the parameter vector of lights (l, 4) and a shape (q,)."""
        parameters = lamp_parameters(lights) if self.with_nearness else light_parameters(lights)
        return np.concatenate([parameters.ravel(), shape])


def nearness_of(lights: Float) -> Float:
    """(..., l) the nearness w / z of lights (..., l, 4): 0 at infinity, else one over a lamp's height."""
    return np.asarray(lights[..., 3] / lights[..., 2])


def light_parameters(lights: Float) -> Float:
    """(..., l, 2) the parameters of lights (..., l, 4): the displacement s = (x, y) / z of each."""
    return np.asarray(lights[..., : ParameterLayout.PER_DIRECTION] / lights[..., 2:3])


def lamp_parameters(lights: Float) -> Float:
    """(..., l, 3) the parameters of lights (..., l, 4) that may be lamps: the displacement and the nearness of each."""
    return np.concatenate([light_parameters(lights), nearness_of(lights)[..., None]], axis=-1)
