"""A camera with distortion: its own picture is shown, and model and shadow stand in it where the lens puts them."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import box_corners
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED
from ashe_live.render.compositing.lens import straight_from_bent, wide_pinhole
from ashe_live.render.scene import Scene
from tests.render.inside import inside_px

LENSES = [(-0.3, 0.1, 0.002, -0.001, 0.0), (0.25, 0.0, 0.0, 0.0, 0.0)]
WIDE_LENS = (-0.4, 0.2, 0.001, 0.001, -0.05)  # as of an action camera
SIZE = (0.05, 0.05, 0.06)


def _camera(stage, lens: tuple[float, ...]) -> Camera:
    return Camera((480, 360), stage.camera().K, np.array(lens), "file")


def _bent(camera: Camera, T_cam_marker: np.ndarray, points: np.ndarray) -> np.ndarray:
    rvec = cv2.Rodrigues(T_cam_marker[:3, :3])[0]
    return cv2.projectPoints(points, rvec, T_cam_marker[:3, 3], camera.K, camera.dist)[0].reshape(-1, 2)


@pytest.mark.parametrize("off_centre_px", [(0.0, 0.0), (40.0, -25.0)])
@pytest.mark.parametrize("lens", [*LENSES, WIDE_LENS])
def test_grid_undoes_the_lens(stage, lens: tuple[float, ...], off_centre_px: tuple[float, float]) -> None:
    K = stage.camera().K.copy()
    K[:2, 2] += off_centre_px
    camera = Camera((480, 360), K, np.array(lens), "file")
    pinhole = wide_pinhole(camera)
    grid = straight_from_bent(camera, pinhole)
    assert grid.min() > -1e-6
    assert grid.max() < 1 + 1e-6
    if lens[0] < 0:  # a barrel's corners are seen at the border: the pinhole camera is no wider than it must be
        assert max(grid.max(), 1 - grid.min()) == pytest.approx(1)
    pixels = np.stack([grid[..., 0] * 480 - 0.5, (1 - grid[..., 1]) * 360 - 0.5], axis=-1).reshape(-1, 2)
    rays = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(pinhole.K).T
    back = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), camera.K, camera.dist)[0].reshape(grid.shape)
    across, up = np.meshgrid(np.linspace(0, 1, grid.shape[1]), np.linspace(0, 1, grid.shape[0]))
    expected = np.stack([across * 480 - 0.5, (1 - up) * 360 - 0.5], axis=-1)
    assert np.abs(back - expected).max() < 1e-3


@pytest.mark.parametrize("target", [(-0.04, 0.02, 0.0), (-0.08, 0.05, 0.0)], ids=["within", "at the border"])
@pytest.mark.parametrize("lens", LENSES)
def test_model_and_shadow_stand_where_the_lens_puts_them(
    make_renderer, stage, lens: tuple[float, ...], target: tuple[float, ...]
) -> None:
    camera = _camera(stage, lens)
    T_cam_marker = stage.pose(-70, 40, 0.35, target=target)
    tracked = stage.tracked(200, T_cam_marker, camera)
    light = stage.light(200, 40, (0.2, 0.2, 0.2))
    renderer = make_renderer(BALANCED.render)
    renderer.render(Scene(tracked, stage.placed(stage.glowing_green(box(SIZE))), Illumination((light,))))
    blue, green, red = np.moveaxis(renderer.read_bgr().astype(int), 2, 0)
    is_model = (green > red + 30) & (green > blue + 30)
    is_shadow = ~is_model & (green < 150)
    corners = box_corners(np.array([(-SIZE[0] / 2, -SIZE[1] / 2, 0), (SIZE[0] / 2, SIZE[1] / 2, SIZE[2])]))
    fallen = corners - light.to_light_marker * (corners[:, 2:] / light.to_light_marker[2])
    inside = [inside_px(_bent(camera, T_cam_marker, points)) for points in (corners, fallen)]
    assert is_model[inside[0] > 2].all()
    assert not is_model[inside[0] < -2].any()
    assert (is_shadow | is_model)[inside[1] > 2].all()
    assert not is_shadow[inside[1] < -2].any()
    assert is_shadow.sum() > 300


@pytest.mark.parametrize("size", [(480, 360), (720, 540), (1, 1)])
def test_video_beside_the_model_is_the_frame_as_it_came(make_renderer, stage, size: tuple[int, int]) -> None:
    image = stage.noise()
    tracked = stage.tracked(image, stage.pose(-90, 40, 0.5), _camera(stage, LENSES[0]))
    renderer = make_renderer(BALANCED.render, size)
    renderer.render(Scene(tracked, stage.placed(box((0.02, 0.02, 0.02))), Illumination((stage.light(180, 50),))))
    picture = renderer.read_bgr()
    assert picture.shape == (size[1], size[0], 3)
    if size == (480, 360):
        np.testing.assert_array_equal(picture[:100], image[:100])
        np.testing.assert_array_equal(picture[:, :150], image[:, :150])
        assert (picture != image).any()
