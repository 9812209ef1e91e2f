"""How far an answer's ambient light is off: on a white ball beside the cube, in the shade of its lights."""

import math

import numpy as np

from ashe_live.bench.cube.painted_scene import CubeScene, level_of
from ashe_live.core.arrays import Float, directions_on_spiral
from ashe_live.core.light import Illumination

NORMALS = 400  # of the ball, evenly spread


def ambient_errors(sky_on_ball: Float, table_rgb: Float, found: Illumination) -> tuple[float, float]:
    """Root mean square error of the irradiance over all normals, over its own: by an even sky, and by one that leans.

    What the table sends back is the true table's in all of them. The answer must have its sky.

    sky_on_ball: (NORMALS, 3) what the sky gives, over all light on level ground. table_rgb: (3,) reflectance.
    """
    assert found.ambient_rgb_ratio is not None
    true = _with_table(sky_on_ball, table_rgb)
    slope = np.zeros((2, 3)) if found.sky_slope_rgb is None else found.sky_slope_rgb
    skies = (_sky(found.ambient_rgb_ratio, one) for one in (np.zeros((2, 3)), slope))
    answers = (_with_table(sky, table_rgb) for sky in skies)
    even, leaning = (math.sqrt(float(((one - true) ** 2).mean() / (true**2).mean())) for one in answers)
    return even, leaning


def painted_sky(scene: CubeScene) -> Float:
    """(NORMALS, 3) what the sky of a painted scene gives, over all light on level ground."""
    sky = scene.sky_rgb / level_of(scene)
    return _sky(sky, 0.5 * np.outer(scene.sky_slope[:2], sky))


def _sky(sky: Float, slope: Float) -> Float:
    normals = directions_on_spiral(NORMALS)
    return np.asarray(np.maximum(sky * (1 + normals[:, 2:]) / 2 + normals[:, :2] @ slope, 0.0))


def _with_table(sky_on_ball: Float, table: Float) -> Float:
    return np.asarray(sky_on_ball + table * (1 - directions_on_spiral(NORMALS)[:, 2:]) / 2)
