import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project
from ashe_live.render.camera.in_frame import project_distorted, tangents_of_pixels

LENSES = [(-0.3, 0.1, 0.002, -0.001, 0.0), (-0.25, 0.0, 0.0, 0.0, 0.0), (0.25, 0.0, 0.0, 0.0, 0.0)]
POSE = np.diag([1.0, -1.0, -1.0, 1.0])
POSE[2, 3] = 0.4


def _camera(lens: tuple[float, ...]) -> Camera:
    return Camera((480, 360), np.array([[420.0, 0, 239.5], [0, 420, 179.5], [0, 0, 1]]), np.array(lens), "file")


@pytest.mark.parametrize("lens", LENSES)
def test_what_is_in_the_picture_is_where_the_lens_puts_it(lens: tuple[float, ...]) -> None:
    camera = _camera(lens)
    border = np.array([(x, y) for x in (-0.5, 239.5, 479.5) for y in (-0.5, 179.5, 359.5)])
    tangents = tangents_of_pixels(camera, border)
    points = np.column_stack([tangents * (0.4, -0.4), np.zeros(len(tangents))])
    np.testing.assert_allclose(project_distorted(camera, POSE, points), border, atol=0.05)


@pytest.mark.parametrize("lens", LENSES)
def test_nothing_beyond_the_picture_is_folded_back_into_it(lens: tuple[float, ...]) -> None:
    angles = np.linspace(0, 2 * np.pi, 40)
    around = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(40)])
    for distance in (0.5, 1.0, 3.0, 100.0):
        pixels = project_distorted(_camera(lens), POSE, distance * around)
        assert not ((pixels > 0) & (pixels < (479, 359))).all(axis=1).any()


def test_behind_the_camera_is_nowhere() -> None:
    points = np.array([(0.1, 0.1, 0.5), (0.05, 0.02, 0.0)])
    pixels = project_distorted(_camera(LENSES[0]), POSE, points)
    assert np.isnan(pixels).all(axis=1).tolist() == [True, False]


def test_without_distortion_it_is_the_pinhole_camera() -> None:
    points = np.random.default_rng(1).uniform(-0.2, 0.2, (20, 3))
    camera = _camera(LENSES[0]).without_distortion()
    np.testing.assert_array_equal(project_distorted(camera, POSE, points), project(camera, POSE, points))
