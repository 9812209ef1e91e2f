"""Where the border of a shadow is in a picture."""

import numpy as np

from ashe_live.bench.render.borders import shadow_border
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project, rigid

CAMERA = Camera.from_hfov((640, 480), 60.0)
# 0.2 m above the plane, looking along +y and 10 degrees down: the plane behind it is behind the camera.
DOWN_RAD = np.radians(10)
LEVEL = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
TILTED = np.array([[1, 0, 0], [0, np.cos(DOWN_RAD), -np.sin(DOWN_RAD)], [0, np.sin(DOWN_RAD), np.cos(DOWN_RAD)]])
POST = np.array([[x, y, z] for x in (-0.02, 0.02) for y in (0.5, 0.54) for z in (0.0, 0.2)])


def _border(to_light) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rotation = TILTED @ LEVEL
    T_cam_marker = rigid(rotation, -rotation @ (0.0, 0.0, 0.2))
    return *shadow_border(POST, np.asarray(to_light), CAMERA, T_cam_marker), T_cam_marker


def test_a_border_surrounds_the_shadow_and_its_normals_point_out_of_it() -> None:
    places, outward, T_cam_marker = _border(np.array([0.5, -0.5, 0.7]) / np.linalg.norm([0.5, -0.5, 0.7]))
    inside = project(CAMERA, T_cam_marker, np.array([[-0.05, 0.6, 0.0]]))[0]
    assert np.isfinite(places).all()
    assert (((places - inside) * outward).sum(axis=1) > 0).all()


def test_of_a_shadow_that_reaches_behind_the_camera_what_lies_before_it_is_left() -> None:
    low_sun = np.array([0.02, 1.0, 0.1])
    places, outward, _ = _border(low_sun / np.linalg.norm(low_sun))
    assert len(places) > 0
    assert np.isfinite(places).all()
    assert np.isfinite(outward).all()
