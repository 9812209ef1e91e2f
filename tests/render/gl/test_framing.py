import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.core.arrays import box_corners
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project, transform_points
from ashe_live.render.gl.framing import disjoint, framing, letterbox

SIDES = st.integers(1, 4000)
BOX = np.array([(-0.04, -0.04, 0.0), (0.04, 0.04, 0.1)])


@given(video=st.tuples(SIDES, SIDES), window=st.tuples(SIDES, SIDES))
def test_letterbox_is_the_largest_centred_rectangle_of_the_videos_shape(
    video: tuple[int, int], window: tuple[int, int]
) -> None:
    left, bottom, width, height = letterbox(video, window)
    assert 1 <= width <= window[0]
    assert 1 <= height <= window[1]
    assert width == window[0] or height == window[1]
    assert abs(window[0] - width - 2 * left) <= 1
    assert abs(window[1] - height - 2 * bottom) <= 1
    scale = min(window[0] / video[0], window[1] / video[1])
    assert abs(width - video[0] * scale) <= 1
    assert abs(height - video[1] * scale) <= 1


@pytest.mark.parametrize("viewport", [(0, 0, 480, 360), (37, 11, 960, 720)])
def test_pixels_of_the_ground_lead_back_to_it(stage, viewport: tuple[int, int, int, int]) -> None:
    camera = Camera((480, 360), np.array([[500, 0, 250.3], [0, 510, 171.9], [0, 0, 1]]), np.zeros(5), "file")
    T_cam_marker = stage.pose(-70, 35)
    points = np.column_stack([np.random.default_rng(3).uniform(-0.05, 0.05, (200, 2)), np.zeros(200)])
    seen = project(camera, T_cam_marker, points)
    left, bottom, width, height = viewport
    pixels = (seen + 0.5) * (width / 480, -height / 360) + (left, bottom + height)
    frame = framing(camera, T_cam_marker, BOX, viewport)
    x, y, w = frame.ground_from_pixel @ np.column_stack([pixels, np.ones(200)]).T
    assert (w > 0).all()
    np.testing.assert_allclose(np.column_stack([x, y]) / w[:, None], points[:, :2], atol=1e-9)


@pytest.mark.parametrize("viewport", [(0, 0, 480, 360), (37, 11, 960, 720)])
def test_clip_space_agrees_with_opencv(stage, viewport: tuple[int, int, int, int]) -> None:
    camera = Camera((480, 360), np.array([[500, 0, 250.3], [0, 510, 171.9], [0, 0, 1]]), np.zeros(5), "file")
    T_cam_marker = stage.pose(-70, 35)
    points = np.random.default_rng(3).uniform(-0.05, 0.05, (200, 3))
    frame = framing(camera, T_cam_marker, points, viewport)
    clip = np.column_stack([points, np.ones(200)]) @ frame.clip_from_marker.T
    left, bottom, width, height = viewport
    gl_px = (clip[:, :2] / clip[:, 3:] + 1) / 2 * (width, height)
    # OpenGL's pixel centres are at halves from the bottom, OpenCV's at whole numbers from the top.
    from_top = np.column_stack([gl_px[:, 0] * 480 / width - 0.5, (height - gl_px[:, 1]) * 360 / height - 0.5])
    rvec = cv2.Rodrigues(T_cam_marker[:3, :3])[0]
    expected = cv2.projectPoints(points, rvec, T_cam_marker[:3, 3], camera.K, None)[0].reshape(-1, 2)
    np.testing.assert_allclose(from_top, expected, atol=1e-6)
    inside = (np.abs(clip[:, :3]) <= clip[:, 3:]).all(axis=1)
    on_screen = (np.abs(clip[:, :2]) <= clip[:, 3:]).all(axis=1)
    assert (inside == on_screen).all(), "near or far cuts something away"
    x, y, w, h = frame.region
    seen = gl_px[on_screen] + (left, bottom)
    assert ((seen >= (x, y)) & (seen <= (x + w, y + h))).all()


@pytest.mark.parametrize("distance_m", [1e-4, 0.01, 0.05, 0.2, 1.0, 50.0, 1e4])
@pytest.mark.parametrize("elevation_deg", [-80.0, -1.0, 0.0, 1.0, 89.0])
def test_framing_stays_sound_at_any_distance(stage, distance_m: float, elevation_deg: float) -> None:
    T_cam_marker = stage.pose(20, elevation_deg, distance_m)
    frame = framing(stage.camera(), T_cam_marker, box_corners(BOX), (0, 0, 480, 360))
    assert frame is not None
    assert np.isfinite(frame.clip_from_marker).all()
    centre = transform_points(T_cam_marker, [(0, 0, 0.02)])
    assert centre[0, 2] == pytest.approx(distance_m)
    x, y, w, h = frame.region
    assert 0 <= x <= x + w <= 480
    assert 0 <= y <= y + h <= 360


def test_nothing_is_framed_behind_the_camera_or_beside_the_picture(stage) -> None:
    turned_away = np.diag([-1.0, 1.0, -1.0, 1.0])
    assert framing(stage.camera(), turned_away @ stage.pose(20, 30, 1.0), box_corners(BOX), (0, 0, 480, 360)) is None
    beside = stage.pose(20, 30, 1.0, target=(5.0, math.pi, 0.0))
    assert framing(stage.camera(), beside, box_corners(BOX), (0, 0, 480, 360)) is None


def test_rectangles_that_meet_become_the_one_that_spans_both() -> None:
    some = (10, 20, 30, 40)
    assert disjoint(some, (0, 0, 0, 5)) == [some]
    assert disjoint(some, (40, 20, 5, 5)) == [some, (40, 20, 5, 5)]
    assert disjoint(some, (39, 10, 11, 15)) == [(10, 10, 40, 50)]
