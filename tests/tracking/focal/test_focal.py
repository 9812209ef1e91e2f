"""The focal length from a marker's squareness: right, sure only where it may be, and honest about how sure."""

import cv2
import numpy as np
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import shipped_clip
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal.focal import KNOWN_SIGMA, FocalEstimate, FocalEstimator
from ashe_live.tracking.focal.focal_fit import fit_focal
from ashe_live.tracking.focal.focal_model import SQUARE
from ashe_live.tracking.poses.pose import estimate_pose
from ashe_live.tracking.tracker import MarkerTracker

SIZE = (640, 480)
SIDE_M = 0.08
PICTURE = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
ASSUMED = Camera.from_hfov(SIZE, 60, "assumed")


def hand_held(
    focal_px: float, tilt_deg: float, sway_deg: float, seed: int, side_px: float = 130, frames: int = 300
) -> list[Float]:
    """T_cam_marker at 30 frames a second: a camera in a hand that sways about a marker on a table."""
    random = np.random.default_rng(seed)
    phases, rates_hz = random.uniform(0, 2 * np.pi, 6), random.uniform(0.15, 0.6, 6)
    poses = []
    for frame in range(frames):
        sways = np.sin(2 * np.pi * rates_hz * frame / 30 + phases)
        turns = np.radians(
            [(0, 0, 0.4 * sway_deg * sways[2]), (180 - tilt_deg - sway_deg * sways[0], 0, 0), (0, 0, 25 * sways[1])]
        )
        roll, tilt, heading = (cv2.Rodrigues(turn)[0] for turn in turns)
        distance = SIDE_M * focal_px / side_px * (1 + 0.25 * sways[3])
        at = np.array((0.25 * sways[4], 0.2 * sways[5])) * SIZE / focal_px
        poses.append(rigid(roll @ tilt @ heading, (*(at * distance), distance)))
    return poses


def estimated(camera: Camera, poses: list[Float], noise_px: float, print_m: Float, seed: int = 0) -> FocalEstimator:
    """What follows from corners (4, 3) `print_m`, seen by `camera` and tracked without knowing it."""
    random = np.random.default_rng(seed)
    estimator = FocalEstimator(SIZE)
    pose: MarkerPose | None = None
    for index, T_cam_marker in enumerate(poses):
        corners = project(camera, T_cam_marker, print_m) + random.normal(0, noise_px, (4, 2))
        pose = estimate_pose(corners, ASSUMED, SIDE_M, pose)
        estimator.add(TrackedFrame(Frame(PICTURE, index, index / 30), ASSUMED, pose))
    return estimator


@pytest.mark.parametrize("share", [0.3, 1.0], ids=["some mirrored", "all mirrored"])
def test_poses_that_were_taken_for_their_mirror_images_change_nothing(share: float) -> None:
    # Without perspective, a square that is mirrored in depth looks the same.
    poses = hand_held(620, 40, 10, 6)[::10]
    bent_m = SIDE_M * (SQUARE + 0.01 * np.array([(0, 0, 1), (0, 0, -1), (0, 0, 1), (0, 0, -1)]))
    camera, random = Camera.from_focal(SIZE, 620), np.random.default_rng(6)
    corners = np.array([project(camera, pose, bent_m) + random.normal(0, 0.1, (4, 2)) for pose in poses])
    R, depth = np.array([pose[:3, :3] for pose in poses]), np.diag((1.0, 1.0, -1.0))
    is_mirrored = random.permutation(len(R)) < share * len(R)
    found, other = (
        fit_focal(corners, np.where(mirrored[:, None, None], depth @ R @ depth, R), 400, SIZE)
        for mirrored in (np.zeros(len(R), np.bool_), is_mirrored)
    )
    assert found.relative_sigma < 0.05
    assert abs(found.focal_px / 620 - 1) < 3 * found.relative_sigma
    assert other.focal_px == pytest.approx(found.focal_px, rel=0.01)
    assert other.relative_sigma == pytest.approx(found.relative_sigma, rel=0.3)


@pytest.mark.parametrize(
    ("focal_px", "tilt_deg", "sway_deg"), [(120, 40, 12), (400, 40, 6), (620, 40, 12), (620, 20, 12), (1000, 45, 10)]
)
def test_ten_seconds_in_a_hand_are_enough(focal_px: float, tilt_deg: float, sway_deg: float) -> None:
    """With a lens off-centre and bent, and a print that is neither quite square nor flat."""
    K = np.array([(focal_px, 0, 313.0), (0, focal_px, 244.0), (0, 0, 1)])
    camera = Camera(SIZE, K, np.array((-0.02 * (focal_px / 400) ** 2, 0, 0, 0, 0)), "file")
    print_m = SIDE_M * (SQUARE + 0.002 * np.array([(1, 0, 4), (0, 1, -4), (-1, 0, 4), (0, 1, -4)]))
    found = estimated(camera, hand_held(focal_px, tilt_deg, sway_deg, 1), 0.1, print_m).estimate
    assert found is not None
    assert found.relative_sigma < 0.03
    assert found.focal_px == pytest.approx(focal_px, rel=0.03)
    assert abs(found.focal_px - focal_px) < 2.5 * found.sigma_px


def test_its_sigma_is_that_of_its_errors() -> None:
    in_sigmas = []
    for seed in range(8):
        random = np.random.default_rng(100 + seed)
        K = np.array([(620, 0, 319.5 + random.normal(0, 8)), (0, 620, 239.5 + random.normal(0, 8)), (0, 0, 1)])
        camera = Camera(SIZE, K, np.array((random.normal(0, 0.04), 0, 0, 0, 0)), "file")
        print_m = SIDE_M * (SQUARE + random.normal(0, 0.003, (4, 3)))
        found = estimated(camera, hand_held(620, 40, 10, seed, frames=150), 0.1, print_m, seed).estimate
        assert found is not None
        in_sigmas.append((found.focal_px - 620) / found.sigma_px)
    assert 0.2 < np.sqrt(np.mean(np.square(in_sigmas))) < 1.5


def test_the_shipped_clip() -> None:
    clip = shipped_clip()
    tracker = MarkerTracker(parse_marker(clip.marker_spec), ASSUMED, clip.marker_side_m, BALANCED.tracking)
    estimator = FocalEstimator(SIZE)
    with ClipSource(clip.path) as source:
        while (frame := source.read()) is not None:
            estimator.add(tracker.track(frame))
    assert estimator.estimate is not None
    assert estimator.estimate.focal_px == pytest.approx(clip.camera.K[0, 0], rel=0.03)
    assert estimator.estimate.relative_sigma < 0.05


def never_sure(estimate: FocalEstimate | None) -> bool:
    return estimate is None or estimate.relative_sigma > KNOWN_SIGMA


def test_without_perspective_it_is_never_sure() -> None:
    for focal_px in (20_000, 100_000):
        camera = Camera.from_focal(SIZE, focal_px)
        poses = hand_held(focal_px, 40, 12, 2, frames=150)
        assert never_sure(estimated(camera, poses, 0.1, SIDE_M * SQUARE).estimate)


def test_frontal_views_are_never_sure() -> None:
    camera = Camera.from_focal(SIZE, 620)
    assert never_sure(estimated(camera, hand_held(620, 0, 2, 3), 0.1, SIDE_M * SQUARE).estimate)


def test_corners_of_no_square_are_never_sure() -> None:
    random = np.random.default_rng(4)
    estimator = FocalEstimator(SIZE)
    for index in range(150):
        corners = np.array([(250, 180), (390, 180), (390, 320), (250, 320)]) + random.uniform(-40, 40, (4, 2))
        pose = estimate_pose(corners, ASSUMED, SIDE_M)
        estimator.add(TrackedFrame(Frame(PICTURE, index, index / 30), ASSUMED, pose))
    assert never_sure(estimator.estimate)


def test_a_camera_at_rest_adds_no_information_and_costs_nothing() -> None:
    camera = Camera.from_focal(SIZE, 620)
    estimator = estimated(camera, hand_held(620, 40, 12, 5)[:1] * 200, 0.05, SIDE_M * SQUARE)
    assert estimator.estimate is None


def test_frames_without_a_marker_are_passed_over_and_other_sizes_refused() -> None:
    estimator = FocalEstimator(SIZE)
    assert estimator.add(TrackedFrame(Frame(PICTURE, 0, 0.0), ASSUMED, None)) is None
    small = Frame(np.zeros((48, 64, 3), np.uint8), 0, 0.0)
    with pytest.raises(ValueError, match="64, 48"):
        estimator.add(TrackedFrame(small, Camera.from_hfov((64, 48), 60), None))


def test_the_camera_says_where_it_comes_from_and_how_sure_it_is() -> None:
    camera = FocalEstimate(SIZE, 600.0, 12.0, 20).camera()
    assert (camera.source, camera.K[0, 0], camera.focal_sigma_px) == ("estimated", 600.0, 12.0)
    assert camera.resized((1280, 960)).focal_sigma_px == pytest.approx(24.0)


def test_corners_that_follow_from_the_pose_tell_nothing_of_the_focal_length() -> None:
    """As where the marker reaches out of the picture, or is one of several: the assumed camera sees them so."""
    estimator = FocalEstimator(SIZE)
    for index, T_cam_marker in enumerate(hand_held(620, 40, 12, 1)):
        corners = project(ASSUMED, T_cam_marker, SIDE_M * SQUARE)
        pose = MarkerPose(T_cam_marker, corners, SIDE_M, 0.1, None)
        assert estimator.add(TrackedFrame(Frame(PICTURE, index, index / 30), ASSUMED, pose)) is None
    assert estimator.estimate is None
