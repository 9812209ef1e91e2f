"""The pose from four corners: exact where corners are, None where they cannot be, and the right one of two."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, project
from ashe_live.core.types import MarkerPose
from ashe_live.tracking.poses.pose import estimate_pose
from tests.tracking.conftest import SIDE_M, pose

CAMERA = Camera.from_focal((640, 480), 600)
WIDE = Camera((640, 480), CAMERA.K, np.array((-0.3, 0.1, 0.001, -0.002, 0.01)), "file")


def projected(T_cam_marker: Float, camera: Camera = CAMERA) -> Float:
    rvec = cv2.Rodrigues(T_cam_marker[:3, :3])[0]
    corners, _ = cv2.projectPoints(square_corners(SIDE_M), rvec, T_cam_marker[:3, 3], camera.K, camera.dist)
    return np.asarray(corners.reshape(4, 2), dtype=np.float64)


@pytest.mark.parametrize("camera", [CAMERA, WIDE])
@pytest.mark.parametrize("tilt_deg", [15, 40, 65, 80])
@pytest.mark.parametrize("turn_deg", [0, 33, 90, 180, 270])
@pytest.mark.parametrize("refines", [False, True])
def test_exact_corners_give_the_exact_pose(camera: Camera, tilt_deg: float, turn_deg: float, refines: bool) -> None:
    truth = pose(0.5, tilt_deg, turn_deg, aside_m=0.05)
    found = estimate_pose(projected(truth, camera), camera, SIDE_M, refines=refines)
    assert found is not None
    assert found.T_cam_marker == pytest.approx(truth, abs=2e-4)
    assert found.reprojection_rms_px < 0.02
    assert found.other_rms_px is not None
    assert found.other_rms_px > found.reprojection_rms_px


@pytest.mark.parametrize("turn_deg", [0, 45, 90, 180, 180.01, 270])
def test_a_print_seen_exactly_from_above_is_no_singularity(turn_deg: float) -> None:
    truth = pose(0.5, 0, turn_deg)
    truth[:3, 3] = (0, 0, 0.5)
    found = estimate_pose(projected(truth), CAMERA, SIDE_M)
    assert found is not None
    # Straight down, a tilt hardly moves the corners: hence the wide bound.
    assert _tilt_error_deg(found, truth) < 3
    assert found.reprojection_rms_px < 0.2


def test_the_error_is_the_root_mean_square_distance_of_the_corners() -> None:
    rng = np.random.default_rng(1)
    corners = projected(pose(0.5, 40)) + rng.normal(0, 1, (4, 2))
    found = estimate_pose(corners, CAMERA, SIDE_M)
    assert found is not None
    misses = projected(found.T_cam_marker) - corners
    assert found.reprojection_rms_px == pytest.approx(math.sqrt((misses**2).sum() / 4), rel=1e-6)


def test_refinement_never_makes_the_error_larger() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        corners = projected(pose(0.6, rng.uniform(0, 75), rng.uniform(0, 360))) + rng.normal(0, 0.5, (4, 2))
        plain = estimate_pose(corners, CAMERA, SIDE_M, refines=False)
        refined = estimate_pose(corners, CAMERA, SIDE_M, refines=True)
        assert plain is not None
        assert refined is not None
        assert refined.reprojection_rms_px <= plain.reprojection_rms_px


def test_without_a_previous_pose_the_surface_is_seen_from_above() -> None:
    """A small marker on a table: with noise the smaller error is wrong about every third time."""
    rng = np.random.default_rng(3)
    truth = pose(2.0, 20, 30)
    for _ in range(60):
        corners = projected(truth) + rng.normal(0, 0.15, (4, 2))
        assert _tilt_error_deg(estimate_pose(corners, CAMERA, SIDE_M), truth) < 20


def test_the_previous_pose_settles_what_the_corners_leave_open() -> None:
    """The same on a surface that leans over the camera, where from above is wrong."""
    rng = np.random.default_rng(3)
    truth = pose(2.0, -20, 30)
    previous = MarkerPose(truth, projected(truth), SIDE_M, 0.0, None)
    alone, together = 0, 0
    for _ in range(60):
        corners = projected(truth) + rng.normal(0, 0.15, (4, 2))
        alone += _tilt_error_deg(estimate_pose(corners, CAMERA, SIDE_M), truth) > 20
        together += _tilt_error_deg(estimate_pose(corners, CAMERA, SIDE_M, previous), truth) > 20
    assert alone > 5
    assert together == 0


def test_a_surface_that_leans_over_the_camera_is_seen_when_the_error_is_decisive() -> None:
    truth = pose(0.3, -55)
    assert _tilt_error_deg(estimate_pose(projected(truth), CAMERA, SIDE_M), truth) < 0.1


def test_a_wrong_previous_pose_gives_way_to_a_decisive_error() -> None:
    truth = pose(0.3, 55)
    mirrored = MarkerPose(pose(0.3, -55), projected(truth), SIDE_M, 0.0, None)
    found = estimate_pose(projected(truth), CAMERA, SIDE_M, mirrored)
    assert _tilt_error_deg(found, truth) < 0.1


def _tilt_error_deg(found: MarkerPose | None, truth: Float) -> float:
    assert found is not None
    return math.degrees(angle_between(found.T_cam_marker[:3, 2], truth[:3, 2]))


SQUARE = np.array([(100, 100), (200, 100), (200, 200), (100, 200)], dtype=np.float64)


@pytest.mark.parametrize(
    "corners",
    [
        np.zeros((4, 2)),
        SQUARE * (1, 0) + (0, 7),
        np.array([(0, 0), (1, 1), (2, 2), (3, 3)]) * 50.0,
        np.array([(100, 100), (200, 100), (200, 100), (100, 200)], dtype=np.float64),
        np.array([(100, 100), (200, 100), (120, 120), (100, 200)], dtype=np.float64),
        SQUARE[[0, 2, 1, 3]],
        SQUARE[::-1],
        SQUARE / 100,
        np.where(SQUARE == 200, np.nan, SQUARE),
        np.where(SQUARE == 200, np.inf, SQUARE),
        np.array([(0, 0), (100, 0), (200, 0.5), (100, 1)], dtype=np.float64),
    ],
    ids=["point", "line", "diagonal", "doubled", "dent", "crossed", "from behind", "tiny", "nan", "inf", "flat"],
)
def test_corners_that_no_square_can_have_give_none(corners: Float) -> None:
    assert estimate_pose(corners, CAMERA, SIDE_M) is None


@pytest.mark.parametrize("hfov_deg", [60, 70, 80])
def test_what_a_longer_focal_length_leaves_open_is_not_decided_by_an_assumed_one(hfov_deg: float) -> None:
    """Corners of a table that hangs over the camera, or of curled paper on a table that does not: a lens of 47 degrees
    shows too little perspective to tell. One that is only taken to see more must not tell, either.
    """
    size = CAMERA.size
    corners = project(Camera.from_hfov(size, 47), pose(1.0, -40, 20), square_corners(SIDE_M))
    for camera in (Camera.from_hfov(size, 47, "flag"), Camera.from_hfov(size, hfov_deg, "assumed")):
        found = estimate_pose(corners, camera, SIDE_M)
        assert found is not None
        assert found.T_cam_marker[1, 2] < 0
