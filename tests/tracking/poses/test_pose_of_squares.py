"""The pose of a frame in which squares lie anywhere, as on the faces of a cube, and how sure it is."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid, transform_points
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.poses.pose import Sighting, estimate_pose, pose_of_squares, poses_of_square
from tests.tracking.conftest import SIDE_M, pose

CAMERA = Camera.from_focal((640, 480), 600, "file")


def turn(*vector: float) -> Float:
    return cv2.Rodrigues(np.array(vector, dtype=np.float64))[0]


# Where squares lie in the frame: on top of a cube, and on two of its upright faces.
TOP = rigid(np.eye(3), (0.0, 0.0, 0.05))
FRONT = rigid(turn(math.pi / 2, 0, 0), (0.0, -0.05, 0.0))
SIDE = rigid(turn(math.pi / 2, 0, 0) @ turn(0, 0, math.pi / 2) @ turn(0, 0.3, 0), (0.06, 0.03, 0.01))
TRUTH = pose(0.6, 50, 25, aside_m=0.05)


def sighting(T_frame_square: Float, truth: Float = TRUTH, noise_px: float = 0.0, seed: int = 0) -> Sighting:
    points = transform_points(T_frame_square, square_corners(SIDE_M))
    corners = project(CAMERA, truth, points) + np.random.default_rng(seed).normal(0, noise_px, (4, 2))
    return Sighting(points, FittedSquare.guessed(corners, max(noise_px, 0.1)))


def error_of(found: MarkerPose | None, truth: Float = TRUTH) -> Float:
    """(6,) of (w, v) as MarkerPose.covariance has them."""
    assert found is not None
    w = cv2.Rodrigues(found.T_cam_marker[:3, :3] @ truth[:3, :3].T)[0].ravel()
    return np.concatenate([w, found.T_cam_marker[:3, 3] - truth[:3, 3]])


@pytest.mark.parametrize(
    "places", [[TOP], [FRONT], [TOP, FRONT], [FRONT, TOP]], ids=["top", "front", "both", "the other way round"]
)
def test_squares_anywhere_in_the_frame_give_its_pose(places: list[Float]) -> None:
    found = pose_of_squares([sighting(each) for each in places], CAMERA, SIDE_M)
    assert np.abs(error_of(found)).max() < 1e-5
    # The corners that are told are those of a square in the frame's own plane.
    np.testing.assert_allclose(found.corners_px, project(CAMERA, TRUTH, square_corners(SIDE_M)), atol=0.01)


@pytest.mark.parametrize("place", [np.eye(4), TOP, FRONT])
def test_one_of_the_poses_of_a_single_square_is_its_own(place: Float) -> None:
    nearest = min(poses_of_square(sighting(place), CAMERA), key=lambda T: float(np.abs(T - TRUTH).max()))
    np.testing.assert_allclose(nearest, TRUTH, atol=1e-4)


def test_what_faces_away_counts_for_nothing() -> None:
    away = sighting(rigid(turn(0, math.pi, 0), (0.0, 0.0, 0.0)))
    assert pose_of_squares([away], CAMERA, SIDE_M) is None
    alone, beside = (pose_of_squares(each, CAMERA, SIDE_M) for each in ([sighting(TOP)], [away, sighting(TOP)]))
    np.testing.assert_array_equal(alone.T_cam_marker, beside.T_cam_marker)


@pytest.mark.parametrize("places", [[np.eye(4)], [TOP, FRONT]], ids=["one", "two"])
def test_the_noise_of_the_pose_is_as_large_as_is_stated(places: list[Float]) -> None:
    """The squared errors in standard deviations are 6 in the mean, as of a chi-squared of 6."""
    squared = []
    for seed in range(60):
        seen = [sighting(each, noise_px=0.3, seed=10 * seed + n) for n, each in enumerate(places)]
        found = pose_of_squares(seen, CAMERA, SIDE_M)
        error = error_of(found)
        squared.append(float(error @ np.linalg.solve(found.noise_covariance, error)))
        whole, noise = np.diag(found.covariance), np.diag(found.noise_covariance)
        assert (whole >= noise).all()
    assert 4 < np.mean(squared) < 9


def test_a_focal_length_that_is_not_known_is_part_of_the_whole_uncertainty_alone() -> None:
    known, assumed = (Camera(CAMERA.size, CAMERA.K, CAMERA.dist, source) for source in ("file", "assumed"))
    of_known, of_assumed = (pose_of_squares([sighting(TOP)], camera, SIDE_M) for camera in (known, assumed))
    np.testing.assert_allclose(of_known.noise_covariance, of_assumed.noise_covariance)
    distance_m = TRUTH[2, 3]
    stated_m = math.sqrt(of_assumed.covariance[5, 5])
    assert stated_m == pytest.approx(distance_m * assumed.focal_sigma_px / assumed.K[0, 0], rel=0.2)
    assert math.sqrt(of_known.covariance[5, 5]) < 0.1 * stated_m


def test_more_perspective_than_a_square_can_have_is_refused_where_the_camera_is_known() -> None:
    """A camera that is only assumed may have a shorter focal length, as the one that has seen this."""
    corners = project(Camera.from_focal(CAMERA.size, 150), pose(0.15, 55), square_corners(SIDE_M))
    assert estimate_pose(corners, CAMERA, SIDE_M) is None
    assert estimate_pose(corners, Camera(CAMERA.size, CAMERA.K, CAMERA.dist, "assumed"), SIDE_M) is not None


def test_the_last_pose_is_followed_without_asking_for_a_second_one() -> None:
    seen = [sighting(TOP, noise_px=0.2), sighting(FRONT, noise_px=0.2, seed=1)]
    first = pose_of_squares(seen, CAMERA, SIDE_M)
    again = pose_of_squares(seen, CAMERA, SIDE_M, previous=first)
    assert first.other_rms_px is not None
    assert again.other_rms_px is None
    np.testing.assert_allclose(again.T_cam_marker, first.T_cam_marker, atol=1e-5)


@pytest.mark.parametrize("refines", [False, True])
def test_with_a_last_pose_a_single_square_is_refined_if_asked_for(refines: bool) -> None:
    last = MarkerPose(pose(0.61, 51, 24), square_corners(SIDE_M)[:, :2] + 9, SIDE_M, 0.1, None)
    wrong = []
    for seed in range(20):
        noise = np.random.default_rng(seed).normal(0, 1.0, (4, 2))
        corners = project(CAMERA, TRUTH, square_corners(SIDE_M)) + noise
        with_last = estimate_pose(corners, CAMERA, SIDE_M, last, refines)
        without = estimate_pose(corners, CAMERA, SIDE_M, None, refines)
        wrong.append(np.abs(with_last.T_cam_marker - without.T_cam_marker).max())
    assert max(wrong) < 1e-4
