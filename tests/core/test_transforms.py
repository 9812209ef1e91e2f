"""Laws of the transforms, and the one bridge from OpenCV to OpenGL."""

import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.core import transforms as tf
from ashe_live.core.camera import Camera

angles = st.floats(-math.pi, math.pi)
elevations = st.floats(-math.pi / 2, math.pi / 2)


def rotation(rotation_vector: tuple[float, float, float]) -> np.ndarray:
    return cv2.Rodrigues(np.array(rotation_vector))[0]


def looking_down(distance: float = 0.6) -> np.ndarray:
    return tf.rigid(rotation((2.3, 0.2, -0.1)), (0.01, -0.02, distance))


OBLONG = Camera((640, 480), np.array([[500, 0, 300.25], [0, 510, 255.5], [0, 0, 1]]), np.zeros(5), "file")


def test_opengl_draws_a_point_where_opencv_projects_it() -> None:
    points = np.random.default_rng(1).uniform(-0.1, 0.1, (50, 3))
    T_cam_marker = looking_down()
    expected = tf.project(OBLONG, T_cam_marker, points)
    clip = tf.gl_projection(OBLONG, 0.01, 10) @ tf.T_gl_cam @ T_cam_marker @ np.column_stack([points, np.ones(50)]).T
    ndc = (clip[:3] / clip[3]).T
    # The window's y counts upwards, its pixel centres are at halves.
    pixels = np.column_stack([(ndc[:, 0] + 1) / 2 * 640 - 0.5, (1 - ndc[:, 1]) / 2 * 480 - 0.5])
    np.testing.assert_allclose(pixels, expected, atol=1e-6)
    assert (np.abs(ndc) < 1).all()


def test_project_agrees_with_opencv() -> None:
    camera = Camera.from_hfov((640, 480), 60)
    points = np.random.default_rng(2).uniform(-0.1, 0.1, (50, 3))
    T = looking_down()
    expected = cv2.projectPoints(points, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)[0][:, 0]
    np.testing.assert_allclose(tf.project(camera, T, points), expected, atol=1e-9)


def test_points_behind_the_camera_have_no_pixel() -> None:
    assert np.isnan(tf.project(OBLONG, np.eye(4), [[0, 0, -1]])).all()


def test_the_lens_is_taken_back_up_to_the_pictures_corners() -> None:
    """After OpenCV's default of five iterations they are half a pixel off."""
    camera = Camera(OBLONG.size, OBLONG.K, np.array([-0.28, 0.08, 0.001, -0.001, 0.0]), "file")
    points = np.array([[-0.6, 0.45, 1.0], [0.65, -0.5, 1.0], [0.25, -0.15, 1.0], [0.0, 0.0, 1.0]])
    pixels, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), camera.K, camera.dist)
    straight = tf.undistorted(camera, pixels.reshape(-1, 2))
    np.testing.assert_allclose(straight, tf.project(OBLONG, np.eye(4), points), atol=1e-4)
    assert tf.undistorted(OBLONG, straight) is straight


def test_pixels_move_with_points_and_pose_as_they_are_projected() -> None:
    points, T = np.random.default_rng(4).uniform(-0.1, 0.1, (20, 3)), looking_down()
    turned, step = points @ T[:3, :3].T, 1e-5
    by_points = tf.pixels_by_points(turned + T[:3, 3], OBLONG.K)
    by_pose = tf.pixels_by_pose(turned, turned + T[:3, 3], OBLONG.K)
    for parameter, each in enumerate(step * np.eye(6)):
        ahead, behind = (
            tf.project(OBLONG, tf.rigid(rotation(sign * each[:3]) @ T[:3, :3], T[:3, 3] + sign * each[3:]), points)
            for sign in (1, -1)
        )
        np.testing.assert_allclose(by_pose[..., parameter], (ahead - behind) / (2 * step), atol=1e-5)
    np.testing.assert_array_equal(by_pose[..., 3:], by_points)


def test_the_homography_of_the_plane_projects_its_points_and_gives_their_depths() -> None:
    places, T = np.random.default_rng(3).uniform(-0.1, 0.1, (20, 2)), looking_down()
    points = np.column_stack([places, np.zeros(20)])
    image = np.column_stack([places, np.ones(20)]) @ tf.image_from_plane(OBLONG, T).T
    np.testing.assert_allclose(image[:, :2] / image[:, 2:], tf.project(OBLONG, T, points), atol=1e-9)
    np.testing.assert_allclose(image[:, 2], tf.transform_points(T, points)[:, 2])


def test_the_camera_is_seen_from_the_marker_where_its_own_frame_begins() -> None:
    T = looking_down(0.6)
    np.testing.assert_allclose(tf.transform_points(T, [tf.camera_centre(T)]), 0, atol=1e-12)
    np.testing.assert_allclose(tf.view_direction(T) * np.linalg.norm(T[:3, 3]), tf.camera_centre(T))


def test_raycast_is_the_inverse_of_projection_on_the_plane() -> None:
    on_plane = np.column_stack([np.random.default_rng(3).uniform(-0.2, 0.2, (40, 2)), np.zeros(40)])
    T = looking_down()
    np.testing.assert_allclose(tf.raycast_to_plane(OBLONG, T, tf.project(OBLONG, T, on_plane)), on_plane, atol=1e-12)


def test_raycast_above_the_horizon_finds_nothing() -> None:
    level = tf.rigid([[1, 0, 0], [0, 0, -1], [0, 1, 0]], (0, 0.1, 0.5))
    above, below = tf.raycast_to_plane(OBLONG, level, [[300, 10], [300, 470]])
    assert np.isnan(above).all()
    assert np.isfinite(below).all()


@given(angles, elevations)
def test_angles_and_direction_are_inverse(azimuth: float, elevation: float) -> None:
    direction = tf.direction_from_angles(azimuth, elevation)
    back = tf.direction_from_angles(*tf.angles_from_direction(direction))
    np.testing.assert_allclose(back, direction, atol=1e-12)
    assert 0 <= tf.angles_from_direction(direction)[0] < 2 * math.pi


@pytest.mark.parametrize("zeros", [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)])
def test_straight_overhead_the_azimuth_is_0_whatever_the_signs_of_zero(zeros: tuple[float, float]) -> None:
    assert tf.angles_from_direction((*zeros, 1.0)) == (0.0, math.pi / 2)
    np.testing.assert_allclose(tf.tangent_basis((*zeros, 1.0)), [(0, 1, 0), (-1, 0, 0)], atol=1e-15)


@given(angles, elevations)
def test_tangent_basis_is_orthonormal_and_points_where_the_angles_grow(azimuth: float, elevation: float) -> None:
    direction = tf.direction_from_angles(azimuth, elevation)
    frame = np.vstack([tf.tangent_basis(direction), direction])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1)


def test_a_covariance_is_the_same_in_space_on_the_tangent_basis_of_another_direction() -> None:
    here, there = (tf.direction_from_angles(np.radians(azimuth), np.radians(89.0)) for azimuth in (10.0, 130.0))
    covariance = np.array([[4e-4, 1e-4], [1e-4, 9e-4]])
    moved = tf.on_tangent_basis(there, covariance, here)
    in_space = [tf.tangent_basis(at).T @ on @ tf.tangent_basis(at) for at, on in ((here, covariance), (there, moved))]
    np.testing.assert_allclose(in_space[1][:2, :2], in_space[0][:2, :2], rtol=0.01, atol=1e-6)
    np.testing.assert_allclose(tf.on_tangent_basis(here, covariance, here), covariance)


def test_tangent_basis_is_the_derivative_of_the_direction() -> None:
    azimuth, elevation, step = 2.0, 0.6, 1e-6
    here = tf.direction_from_angles(azimuth, elevation)
    east, up = tf.tangent_basis(here)
    by_azimuth = (tf.direction_from_angles(azimuth + step, elevation) - here) / step / math.cos(elevation)
    by_elevation = (tf.direction_from_angles(azimuth, elevation + step) - here) / step
    np.testing.assert_allclose(by_azimuth, east, atol=1e-5)
    np.testing.assert_allclose(by_elevation, up, atol=1e-5)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 1.0, math.pi - 1e-6, math.pi])
def test_angle_between_is_exact_also_where_arccos_is_not(angle: float) -> None:
    other = (math.cos(angle), math.sin(angle), 0.0)
    assert tf.angle_between((1, 0, 0), other) == pytest.approx(angle, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("vector", [(0, 0, 0), (math.nan, 0, 1), (math.inf, 0, 0)])
def test_a_vector_without_a_direction_is_refused(vector: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="no direction"):
        tf.normalised(vector)


@given(angles, st.floats(0.001, math.pi / 2))
def test_light_view_is_a_rotation_whose_z_points_to_the_light(azimuth: float, elevation: float) -> None:
    to_light = tf.direction_from_angles(azimuth, elevation)
    view = tf.light_view(to_light)
    np.testing.assert_allclose(view[:3, :3] @ view[:3, :3].T, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(view[:3, :3] @ to_light, (0, 0, 1), atol=1e-9)
    np.testing.assert_array_equal(view[:3, 3], 0)


@pytest.mark.parametrize("to_light", [(0, 0, 1), (0, 1, 0), (0, -1, 0), (1, 0, 0)])
def test_light_view_stands_firm_along_every_axis(to_light: tuple[float, float, float]) -> None:
    assert np.isfinite(tf.light_view(np.array(to_light, dtype=float))).all()


def test_orthographic_maps_its_box_onto_the_clip_cube() -> None:
    lower, upper = np.array([-1.0, -2.0, -3.0]), np.array([4.0, 5.0, 6.0])
    matrix = tf.orthographic(lower, upper)
    corners = matrix @ np.array([[*lower, 1], [*upper, 1]]).T
    # Nearest to the light (largest z) comes first in depth.
    np.testing.assert_allclose(corners[:3].T, [[-1, -1, 1], [1, 1, -1]], atol=1e-12)


def test_inverse_rigid() -> None:
    T = looking_down()
    np.testing.assert_allclose(tf.inverse_rigid(T) @ T, np.eye(4), atol=1e-14)


@pytest.mark.parametrize("vector", [(3.0, 4.0, 0.0), (3e200, 4e200, 0.0), (3e-200, 4e-200, 0.0), (5e-324, 5e-324, 0.0)])
def test_any_length_is_made_one(vector: tuple[float, float, float]) -> None:
    x, y, z = tf.normalised(vector)
    assert math.hypot(x, y, z) == pytest.approx(1, abs=1e-15)
    assert math.atan2(y, x) == pytest.approx(math.atan2(vector[1], vector[0]), abs=1e-15)


@pytest.mark.parametrize("smaller", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_the_radius_of_68_percent_holds_as_many_samples(smaller: float) -> None:
    covariance = rotation((0, 0, 0.7))[:2, :2] @ np.diag([4e-4, smaller * 4e-4]) @ rotation((0, 0, -0.7))[:2, :2]
    samples = np.random.default_rng(0).multivariate_normal((0, 0), covariance, 100_000)
    radius = tf.radius_of_68_percent(covariance)
    assert (np.linalg.norm(samples, axis=1) < radius).mean() == pytest.approx(0.68, abs=0.01)
    assert tf.radius_of_68_percent(1e6 * covariance) == math.pi


def test_a_motion_leads_from_where_the_marker_lay_to_where_it_lies() -> None:
    before, now = tf.rigid(rotation((0, 0, 0.3)), (0.1, 0.2, 0)), tf.rigid(rotation((0.1, 0.2, -1)), (0.3, 0.1, 0.02))
    point = np.array([(0.05, -0.02, 0.01)])
    in_room = tf.transform_points(before, point)
    motion = tf.motion_between(before, now)
    np.testing.assert_allclose(tf.transform_points(now, tf.transform_points(motion, point)), in_room)
    assert tf.motion_between(before, before) is tf.motion_between(None, now) is tf.motion_between(before, None) is None


@pytest.mark.parametrize(
    ("turn_deg", "shift_sides", "elsewhere"),
    [(0.0, 0.0, False), (0.9, 0.029, False), (1.1, 0.0, True), (0.0, 0.031, True), (-1.1, -0.031, True)],
)
def test_a_marker_lies_elsewhere_when_turned_or_shifted(turn_deg: float, shift_sides: float, elsewhere: bool) -> None:
    side_m = 0.08
    before = tf.rigid(rotation((0, 0, 2.0)), (0.3, -0.2, 0))
    moved = before @ tf.rigid(rotation((0, 0, math.radians(turn_deg))), (0, shift_sides * side_m, 0))
    assert tf.lies_elsewhere(before, moved, side_m) is elsewhere
    assert not tf.lies_elsewhere(None, moved, side_m)


def test_what_is_shifted_is_then_scaled() -> None:
    T = tf.translated_and_scaled((1, 2, 3), (2, 3, -4))
    assert tf.transform_points(T, [(0, 0, 0), (1, 1, 1)]).tolist() == [[2, 6, -12], [4, 9, -16]]
