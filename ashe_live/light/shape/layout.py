"""The layout of theta, the numbers that a fit varies: the lights', one light after the other, then the shape's."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ashe_live.core.arrays import Float


@dataclass(frozen=True, slots=True)
class Layout:
    """Where in theta (..., split + q) which numbers stand, of so many lights and any shape."""

    lights: int
    # The displacement s of its shadow for a unit of height: lights are varied as directions.
    PER_LIGHT: ClassVar[int] = 2

    @property
    def split(self) -> int:
        """How many numbers are the lights'; the shape's follow."""
        return self.PER_LIGHT * self.lights

    def light(self, number: int) -> slice:
        """Those of one light."""
        return slice(self.PER_LIGHT * number, self.PER_LIGHT * (number + 1))

    def lights_of(self, theta: Float) -> Float:
        """(..., l, 4) homogeneous points, their z one."""
        numbers = theta[..., : self.split].reshape(*theta.shape[:-1], self.lights, self.PER_LIGHT)
        points = np.zeros((*numbers.shape[:-1], 4))
        points[..., : self.PER_LIGHT], points[..., 2] = numbers, 1.0
        return points

    def shape_of(self, theta: Float) -> Float:
        """(..., q)"""
        return theta[..., self.split :]

    @classmethod
    def theta(cls, lights: Float, shape: Float) -> Float:
        """(split + q,) of lights (l, 4), which are directions, and a shape (q,)."""
        return np.append(numbers_of(lights), shape)


def numbers_of(lights: Float) -> Float:
    """(..., l, 2) what theta holds of lights (..., l, 4)."""
    return np.asarray(lights[..., : Layout.PER_LIGHT] / lights[..., 2:3])
