"""Where a light is shown: by a bulb where its lamp is in the picture, else by an arrow."""

import numpy as np
import pytest

from ashe_live.core.arrays import box_corners
from ashe_live.core.camera import Camera
from ashe_live.core.light import Light
from ashe_live.core.transforms import inverse_rigid, normalised, transform_points
from ashe_live.render.camera.in_frame import tangents_of_pixels
from ashe_live.render.passes.light_sign import ARROW, BULB, light_sign

CORNERS = box_corners(np.array([(-0.03, -0.03, 0.0), (0.03, 0.03, 0.06)]))
LENSES = [(0.0,) * 5, (-0.3, 0.1, 0.0, 0.0, 0.0), (0.2, 0.0, 0.0, 0.0, 0.0)]


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize(("from_left", "profile"), [(0.02, BULB), (0.5, BULB), (0.98, BULB), (1.03, ARROW)])
def test_a_bulb_is_shown_where_the_lens_puts_the_lamp_into_the_picture(
    stage, lens: tuple[float, ...], from_left: float, profile: tuple
) -> None:
    straight = stage.camera()
    camera = Camera(straight.size, straight.K, np.array(lens), "file")
    T_cam_marker = stage.pose(-90, 30, 0.5)
    width, height = camera.size
    (tangents,) = tangents_of_pixels(camera, np.array([(from_left * width - 0.5, height / 3)]))
    place = transform_points(inverse_rigid(T_cam_marker), 0.3 * normalised([*tangents, 1.0])[None])[0]
    light = Light(normalised(place), inverse_distance=1 / float(np.linalg.norm(place)))
    assert light_sign(CORNERS, light, camera, T_cam_marker).profile == profile
