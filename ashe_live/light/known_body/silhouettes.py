"""What is said of lights that were found: masks of the body and its shadows, and covariances of directions."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.directions import direction_by_displacement
from ashe_live.light.shape.predicted import predicted


def masks_of(view: View, body: Proxy, lights: Sequence[Float]) -> tuple[Mask, Mask]:
    """(h, w) of the view each: the body, and its shadows in lights (4,)."""
    silhouettes = predicted(body, np.array(lights), view)
    return silhouettes.body, silhouettes.shadow


def direction_covariance(light: Float, covariance: Float) -> Float:
    """(2, 2) rad^2, on its tangent basis, of a light (4,) whose s = (x, y) / z has a `covariance` (2, 2)."""
    slope = direction_by_displacement(light[:2] / light[2])
    spread = slope @ covariance @ slope.T
    return np.asarray(0.5 * (spread + spread.T))
