"""The nearness of a light as a further parameter of an alignment with steps of light."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE
from ashe_live.light.outline_fit.search import offset_of_lights
from ashe_live.light.shape.layout import ParameterLayout

# Sigma of the distance by which all steps around an object itself are off together: its sides blend into a ground that
# is brighter or darker than they are, and sharpening moves either border. The means around the objects of 40 generated
# pictures with lamps vary by 0.31 px, those around their shadows, which are ground on both sides, by half as much. A
# lamp's shadow is wider than its silhouette by a few percent, which may be less than that.
OFFSET_PX = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class NearnessBySteps:
    """The first light's displacement and nearness by steps of light, the shape marginalised out, in the body frame."""

    offset: Float  # (3,) of displacement and nearness from those aligned with, that the steps ask for
    information: Float  # (3, 3) on it

    @staticmethod
    def of(normal: Float, gradient: Float) -> "NearnessBySteps":
        """By normal equations of a body with one light, whose nearness is among the parameters."""
        return NearnessBySteps(*offset_of_lights(normal, gradient, ParameterLayout(1, with_nearness=True)))

    def over(self, points_per_sample: float) -> "NearnessBySteps":
        """The same with the information divided by the number of points over their effective sample size."""
        return NearnessBySteps(self.offset, self.information / points_per_sample)


def without_offset(normal: Float, gradient: Float) -> tuple[Float, Float]:
    """Normal matrices (n, t, t) and gradients (n, t) of n bodies, the last parameter marginalised out.

    That parameter is the steps' common offset in pixels.
    """
    stiff, coupled = normal[:, -1, -1] + BORDERS_PER_SAMPLE / OFFSET_PX**2, normal[:, :-1, -1]
    share = coupled / stiff[:, None]
    of_rest = normal[:, :-1, :-1] - share[:, :, None] * coupled[:, None]
    return np.asarray(of_rest), np.asarray(gradient[:, :-1] - share * gradient[:, -1:])
