"""Where the end of a model's shadow lies on the table, and which light casts it at a given place."""

import math

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light

LOWEST_RAD = math.radians(5)  # least elevation of a light that is set by hand
LEAST_ABOVE_MODEL = 1.05  # height of a lamp over the model's from which the end of the model's shadow can be dragged


def shadow_of(light: Light, foot: Float, height: float) -> Float | None:
    """(2,) on the plane: the shadow of a point `height` above `foot` (2,); None if the light is not above it."""
    x, y, z = light.to_light_marker
    above = z - light.inverse_distance * height
    return np.asarray((z * foot - height * np.array((x, y))) / above) if above > 0 else None


def light_through(end: Float, foot: Float, height: float, inverse_distance: float) -> Float | None:
    """(3,) the unit vector to a light at this distance for which `shadow_of` is `end` (2,); None if there is none.

    No lower than LOWEST_RAD: a sun then stops there.
    """
    slope = (foot - end) / height
    if inverse_distance == 0:
        steepness = max(float(np.linalg.norm(slope)), 1e-12)
        slope *= min(1.0, 1 / math.tan(LOWEST_RAD) / steepness)
    # With (x, y) = z slope + q end, the larger z for which the vector's length is 1.
    a, b, c = 1 + slope @ slope, inverse_distance * (slope @ end), inverse_distance**2 * (end @ end) - 1
    if b * b < a * c:
        return None
    z = float((math.sqrt(b * b - a * c) - b) / a)
    lowest = max(LEAST_ABOVE_MODEL * inverse_distance * height, math.sin(LOWEST_RAD) - 1e-12)
    return np.array((*(z * slope + inverse_distance * end), z)) if z >= lowest else None
