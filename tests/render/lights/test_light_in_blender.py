"""The lines for Blender in docs/export.md, by what Blender makes of the values that they set (tried in 4.2 as well)."""

import json
import math
import re
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.contract import camera_json, light_by_hand_json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import direction_from_angles
from ashe_live.render.lights.lighting import lighting_of
from tests.checkout import CHECKOUT

PAGE = (CHECKOUT / "docs" / "export.md").read_text(encoding="utf-8")
LIGHT, CAMERA = (
    body for body in re.findall(r"^```text\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL) if "bpy.data.objects" in body
)
RATIO = np.array((0.3, 0.4, 0.5))
TOWARDS = direction_from_angles(math.radians(-130), math.radians(35))


class Matrix(np.ndarray):
    """As much of mathutils.Matrix as these lines make use of."""

    def __new__(cls, rows):
        return np.array(rows, np.float64).view(cls)

    def inverted(self):
        return np.linalg.inv(self)

    @classmethod
    def Diagonal(cls, diagonal):
        return np.diag(diagonal).view(cls)


def ran(lines: str, known: dict, folder, monkeypatch) -> dict:
    """The names that the lines leave, with a Blender that keeps what is set."""
    monkeypatch.chdir(folder)
    (folder / "ashe-live-DATE.json").write_text(json.dumps(known))
    bpy = MagicMock()
    bpy.data.lights.new = lambda _, kind: SimpleNamespace(type=kind)
    bpy.data.cameras.new = lambda _: SimpleNamespace(sensor_width=36.0)
    bpy.data.objects.new = lambda _, data: SimpleNamespace(data=data)
    names = {"bpy": bpy, "math": math, "json": json, "mathutils": SimpleNamespace(Matrix=Matrix), "known": known}
    exec(lines, names)  # of our own page
    return names


@pytest.mark.parametrize(
    "light",
    [
        Light(TOWARDS, shadow_rgb_ratio=RATIO, angular_size_rad=math.radians(2)),
        Light(TOWARDS, shadow_rgb_ratio=RATIO),
        Light(TOWARDS),
        Light(TOWARDS, shadow_rgb_ratio=RATIO, inverse_distance=2.5, intensity_rgb_ratio=1 / RATIO - 1, radius_m=0.05),
        Light(TOWARDS, shadow_rgb_ratio=RATIO, inverse_distance=2.5),
    ],
)
@pytest.mark.parametrize("knows_ambient", [True, False], ids=["estimated", "by hand"])
def test_its_lamps_give_the_table_what_models_get(light: Light, knows_ambient: bool, tmp_path, monkeypatch) -> None:
    lit = Illumination((light,), ambient_rgb_ratio=light.shadow_rgb_ratio if knows_ambient else None)
    names = ran(LIGHT, {"estimate": light_by_hand_json(lit, 0)}, tmp_path, monkeypatch)
    shown, lamp = names["shown"], names["lamp"]
    nodes = names["bpy"].context.scene.world.node_tree.nodes
    rest = np.array(nodes["Background"].inputs["Color"].default_value)[:3]
    energy = np.array(lamp.color) * lamp.energy
    (expected,) = lighting_of(lit.lights, lit.ambient_rgb_ratio).lights
    if light.inverse_distance:  # an isotropic lamp of so many watts
        distance_m = np.linalg.norm(shown.location)
        np.testing.assert_allclose(shown.location / distance_m, TOWARDS)
        assert lamp.type == "POINT"
        assert distance_m == pytest.approx(0.4)
        facing = energy / (4 * math.pi) / distance_m**2
        assert 2 * math.atan(lamp.shadow_soft_size / distance_m) == pytest.approx(expected.angular_size_rad)
    else:  # W/m^2 on what faces a sun, which shines along its own -z
        _, tilt, turn = shown.rotation_euler
        towards = np.array((math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), math.cos(tilt)))
        np.testing.assert_allclose(towards, TOWARDS, atol=1e-9)
        facing = energy
        assert lamp.type == "SUN"
        assert lamp.angle == pytest.approx(expected.angular_size_rad)
    np.testing.assert_allclose(facing / math.pi, expected.irradiance, rtol=1e-6)
    np.testing.assert_allclose(facing * TOWARDS[2] / math.pi + rest, 1.0)  # lit white ground


def test_its_camera_sees_what_the_saved_frame_shows(tmp_path, monkeypatch) -> None:
    camera = Camera((640, 360), np.array([[500.0, 0, 300.0], [0, 500.0, 200.0], [0, 0, 1]]), np.zeros(5), "file")
    T_cam_marker = np.eye(4)
    T_cam_marker[:3, :3] = np.diag((1.0, -1.0, -1.0)) @ [[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]
    T_cam_marker[:3, 3] = 0.02, -0.03, 0.5
    known = {"camera": camera_json(camera), "marker": {"T_cam_marker": T_cam_marker.tolist()}}
    names = ran(CAMERA, known, tmp_path, monkeypatch)
    lens, render = names["shown"].data, names["bpy"].context.scene.render
    assert (render.resolution_x, render.resolution_y) == (640, 360)
    for point in ((0.0, 0.0, 0.0, 1.0), (0.05, 0.02, 0.1, 1.0)):
        # Blender's camera: x right, y up, along -z; shifts are in widths, and move what is seen to the other side.
        x, y, z, _ = np.asarray(np.linalg.inv(names["shown"].matrix_world)) @ point
        across = lens.lens / lens.sensor_width * x / -z - lens.shift_x
        up = lens.lens / lens.sensor_width * y / -z - lens.shift_y
        seen = (639 / 2 + 640 * across, 359 / 2 - 640 * up)
        expected = camera.K @ (T_cam_marker @ point)[:3]
        np.testing.assert_allclose(seen, expected[:2] / expected[2], atol=1e-9)
