"""The nearness of a light as a further parameter of an alignment with steps of light."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.shape.body import LitBody
from ashe_live.light.shape.layout import nearness_of


@dataclass(frozen=True, slots=True)
class NearnessPrior:
    """A normal distribution of a light's nearness w / z (1/m), before outlines are seen."""

    mean: float
    sigma: float

    def applied(self, bodies: Sequence[LitBody]) -> tuple[Float, Float]:
        """(n,) information on the first light's nearness in each body's frame; (n,) the gradient towards the mean."""
        unit_m = np.array([one.body.frame.unit_m for one in bodies])
        here = np.array([float(nearness_of(one.lights)[0]) for one in bodies])
        information = 1 / (self.sigma * unit_m) ** 2
        return information, information * (self.mean - here) * unit_m


@dataclass(frozen=True, slots=True, eq=False)
class NearnessBySteps:
    """What steps of light tell of the first light as a lamp, whatever the shape, in the body frame."""

    offset: Float  # (3,) of displacement and nearness from those aligned with, that the steps ask for
    information: Float  # (3, 3) on it

    def over(self, count: float) -> "NearnessBySteps":
        """The same, of which so many tell as much as one."""
        return NearnessBySteps(self.offset, self.information / count)
