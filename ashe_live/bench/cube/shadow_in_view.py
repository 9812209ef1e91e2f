"""How much of a painted cube's shadow the camera sees: none if the cube hides all of it."""

import cv2
import numpy as np

from ashe_live.bench.cube.painted_scene import CubeScene, hull_of
from ashe_live.bench.cube.painter import cast_on_table, projected
from ashe_live.core.arrays import Float

# Of the cube's area in the picture, from which on a shadow is seen: less is a sliver beside the cube's foot.
SEEN = 0.05


def is_seen(scene: CubeScene, light: Float) -> bool:
    """Whether enough of the shadow on the table in a light (4,) lies in the picture and not behind the cube."""
    body = hull_of(scene)
    cube, shadow = (_painted(scene, points) for points in (body, cast_on_table(body, light)))
    return int(np.count_nonzero(shadow & ~cube)) > SEEN * int(np.count_nonzero(cube))


def _painted(scene: CubeScene, points: Float) -> np.ndarray:
    """(h, w) where the hull of points (n, 3), the cube's frame, lies in the picture."""
    mask = np.zeros(scene.camera.size[::-1], np.uint8)
    pixels = projected(scene.camera, scene.T_cam_cube, points).astype(np.float32)
    cv2.fillConvexPoly(mask, np.round(cv2.convexHull(pixels)[:, 0]).astype(np.int32), 1)
    return mask > 0
