"""How far an answer's ambient light is off: on a white ball beside the painted cube, in the shade of its lights."""

import math

import numpy as np

from ashe_live.bench.cube.painter import CubeScene, level_of
from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.core.types import Illumination

NORMALS = 400  # of the ball, evenly spread


def ambient_errors(scene: CubeScene, found: Illumination) -> tuple[float, float]:
    """Root mean square error of the irradiance over all normals, over its own: by an even sky, and by one that leans.

    What the table sends back is as painted in all of them. The answer must have its sky.
    """
    assert found.ambient_rgb_ratio is not None
    level = level_of(scene)
    sky = scene.sky_rgb / level
    true = _irradiance(sky, 0.5 * np.outer(scene.sky_slope[:2], sky), scene.table_rgb)
    slope = np.zeros((2, 3)) if found.sky_slope_rgb is None else found.sky_slope_rgb
    answers = (_irradiance(found.ambient_rgb_ratio, one, scene.table_rgb) for one in (np.zeros((2, 3)), slope))
    even, leaning = (math.sqrt(float(((one - true) ** 2).mean() / (true**2).mean())) for one in answers)
    return even, leaning


def _irradiance(sky: Float, slope: Float, table: Float) -> Float:
    """(n, 3) over pi and over that of all light on level ground, of facets turned every way."""
    normals = directions_on_spiral(NORMALS)
    across, up = normals[:, :2], normals[:, 2:]
    return np.asarray(np.maximum(sky * (1 + up) / 2 + across @ slope, 0.0) + table * (1 - up) / 2)
