"""The paper's geometry on perfect points: exact where its assumptions hold."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, direction_from_angles, project, rigid
from ashe_live.light.paper import geometry
from ashe_live.light.paper.masks import hull_of_points

SIDE = 0.08
CAMERA = Camera.from_hfov((640, 480), 60)

azimuths = st.floats(0, 2 * np.pi)
elevations = st.floats(np.radians(20), np.radians(89))


def shadow_point(point, to_light):
    return point - to_light * (point[2] / to_light[2])


@given(azimuths, elevations)
def test_an_object_in_the_virtual_ones_place_gives_the_exact_light(azimuth, elevation):
    T = rigid(np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 0.6))
    to_light = direction_from_angles(azimuth, elevation)
    centre = geometry.cube_centre(SIDE)
    object_px, shadow_px = project(CAMERA, T, [centre, shadow_point(centre, to_light)])
    answer = geometry.to_light_from_centres(CAMERA, T, SIDE, object_px, shadow_px, 1.0)
    assert angle_between(answer, to_light) < 1e-6


@pytest.mark.parametrize("size_ratio", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("azimuth_deg", [10, 130, 250])
def test_a_similar_cube_anywhere_gives_the_light_of_a_far_camera(pose_above, size_ratio, azimuth_deg):
    # Far away, perspective is as good as parallel, which is what moving the vector in the picture assumes.
    T = pose_above((-100.0, -180.0, 170.0))
    camera = Camera.from_focal((640, 480), 250_000)
    to_light = direction_from_angles(np.radians(azimuth_deg), np.radians(35))
    shift = np.array([0.15, 0.1, 0.0])
    real = geometry.cube_corners(size_ratio * SIDE) + shift
    centre = geometry.cube_centre(size_ratio * SIDE) + shift
    areas = [
        cv2.contourArea(hull_of_points(camera, T, corners).astype(np.float32))
        for corners in (geometry.cube_corners(SIDE), real)
    ]
    scale = geometry.real_to_virtual_scale(*areas)
    assert scale == pytest.approx(1 / size_ratio, rel=2e-3)
    object_px, shadow_px = project(camera, T, [centre, shadow_point(centre, to_light)])
    answer = geometry.to_light_from_centres(camera, T, SIDE, object_px, shadow_px, scale)
    assert np.degrees(angle_between(answer, to_light)) < 0.5


def test_turning_the_marker_turns_the_answer(pose_above):
    T = pose_above((-0.1, -0.45, 0.4))
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    object_px, shadow_px = np.array([400.0, 200.0]), np.array([450.0, 260.0])
    answer = geometry.to_light_from_centres(CAMERA, T, SIDE, object_px, shadow_px, 0.7)
    turned = geometry.to_light_from_centres(CAMERA, T @ rigid(quarter, np.zeros(3)), SIDE, object_px, shadow_px, 0.7)
    np.testing.assert_allclose(quarter @ turned, answer, atol=1e-9)


def test_a_shadow_above_the_horizon_has_no_answer(pose_above):
    T = pose_above((0.0, -0.5, 0.1))
    nothing = geometry.to_light_from_centres(CAMERA, T, SIDE, np.array([320.0, 240.0]), np.array([320.0, -900.0]), 1.0)
    assert nothing is None


@given(st.floats(0, 640), st.floats(0, 480), st.floats(0.1, 5))
def test_no_answer_lies_below_the_ground(x, y, scale):
    T = rigid(np.array([[1.0, 0.0, 0.0], [0.0, -0.5, -(0.75**0.5)], [0.0, 0.75**0.5, -0.5]]), (0.0, 0.0, 0.6))
    answer = geometry.to_light_from_centres(CAMERA, T, SIDE, np.array([320.0, 240.0]), np.array([x, y]), scale)
    assert answer is None or (answer[2] > 0 and np.linalg.norm(answer) == pytest.approx(1))


def test_the_cube_stands_on_the_marker():
    corners = geometry.cube_corners(SIDE)
    np.testing.assert_allclose(corners.mean(axis=0), geometry.cube_centre(SIDE))
    assert corners[:, 2].min() == 0
    np.testing.assert_allclose(np.ptp(corners, axis=0), SIDE)
    square = square_corners(SIDE)
    bottom = {tuple(corner) for corner in corners if corner[2] == 0}
    assert {tuple(corner) for corner in square} == bottom
