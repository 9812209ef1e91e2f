"""What happens between frames: losses bridged, edges of the frame, a second marker, bad light, other sizes."""

import cv2
import numpy as np
import pytest

from ashe_live.bench.track.frames import CLEAN_CAMERA, Flaws, PrintedMarker
from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import MarkerPose, TrackedFrame
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import BRIDGED_FRAMES, MarkerTracker
from tests.tracking.conftest import SIDE_M, frame, pose

SPEC = "aruco:4x4_50:3"
CAMERA = Camera.from_focal((640, 480), 900)
PLACE = pose(0.6, 30, 10)


def shot(T_cam_marker: Float, flaws: Flaws = CLEAN_CAMERA, camera: Camera = CAMERA) -> Image:
    bitmap = parse_marker(SPEC).bitmap(6)
    return PrintedMarker(bitmap, SIDE_M, camera, flaws).painted([T_cam_marker], np.random.default_rng(5))


def tracker(camera: Camera = CAMERA) -> MarkerTracker:
    return MarkerTracker(parse_marker(SPEC), camera, SIDE_M, BALANCED.tracking)


def followed(images: list[Image]) -> list[TrackedFrame]:
    one = tracker()
    return [one.track(frame(image, index)) for index, image in enumerate(images)]


def aside(metres: float) -> Float:
    moved = PLACE.copy()
    moved[0, 3] += metres
    return moved


def unreadable(image: Image) -> Image:
    """A reflection over the middle of the marker: its cells are gone, the paper around it is not."""
    glared = image.copy()
    centre = CAMERA.K @ PLACE[:3, 3]
    place = tuple(np.round(centre[:2] / centre[2]).astype(int).tolist())
    cv2.circle(glared, place, 38, (255, 255, 255), -1)
    return np.asarray(cv2.GaussianBlur(glared, (0, 0), 1.0), dtype=np.uint8)


def test_a_short_loss_is_bridged_and_marked() -> None:
    clear = shot(PLACE)
    seen = followed([clear, clear, *[unreadable(clear)] * 3, clear])
    assert [one.marker is not None and one.marker.bridged for one in seen] == [False, False, True, True, True, False]
    for one in seen:
        assert one.marker is not None
        assert np.abs(one.marker.corners_px - seen[0].marker.corners_px).max() < 2  # type: ignore[union-attr]


def test_a_longer_loss_is_one() -> None:
    clear = shot(PLACE)
    seen = followed([clear, clear, *[unreadable(clear)] * (BRIDGED_FRAMES + 2)])
    assert sum(one.marker is not None and one.marker.bridged for one in seen) == BRIDGED_FRAMES
    assert seen[-1].marker is None


@pytest.mark.parametrize("instead", [0, 128, 255])
def test_nothing_is_bridged_into_an_empty_picture(instead: int) -> None:
    seen = followed([shot(PLACE), shot(PLACE), np.full((480, 640, 3), instead, np.uint8)])
    assert seen[2].marker is None


def test_a_marker_that_leaves_the_frame_is_followed_by_three_sides() -> None:
    seen = followed([shot(aside(metres)) for metres in np.arange(0.12, 0.19, 0.01)])
    reach = [one.marker.corners_px[:, 0].max() for one in seen if one.marker is not None]
    assert max(reach) > 645
    for metres, one in zip(np.arange(0.12, 0.19, 0.01), seen, strict=True):
        if one.marker is not None:
            assert turn_deg(one.marker.T_cam_marker, aside(metres)) < 2


def test_of_two_equal_markers_the_tracked_one_is_kept_and_it_is_said() -> None:
    # The other one is nearer and larger: found afresh, it would be taken.
    other = pose(0.45, 20, 60)
    other[:2, 3] = -0.08, -0.05
    nearer, empty = shot(other), shot(pose(50.0, 30))
    is_paper = cv2.dilate((np.abs(nearer.astype(int) - empty).max(axis=2) > 40).astype(np.uint8), np.ones((9, 9))) > 0
    one, said = tracker(), []
    for index in range(6):
        image = shot(aside(0.1 + 0.003 * index))
        both = np.where(is_paper[:, :, None], nearer, image) if index else image
        seen = one.track(frame(np.asarray(both, dtype=np.uint8), 8 * index))
        assert seen.marker is not None
        assert turn_deg(seen.marker.T_cam_marker, aside(0.1 + 0.003 * index)) < 1
        said.append(seen.note)
    assert said[0] is None
    assert said[-1] is not None
    assert said[-1].startswith("2 equal markers")


def test_rolling_brightness_is_followed() -> None:
    gains = [float(2.0 ** -abs(index - 4)) for index in range(9)]
    for one in followed([shot(PLACE, Flaws(gain=gain)) for gain in gains]):
        assert one.marker is not None
        assert turn_deg(one.marker.T_cam_marker, PLACE) < 0.3


@pytest.mark.parametrize("focal_px", [100.0, 1000.0, 100_000.0])
def test_every_focal_length(focal_px: float) -> None:
    camera = Camera.from_focal((640, 480), focal_px)
    truth = pose(focal_px * SIDE_M / 110, 40, 10)
    truth[1, 3] = 0
    found = tracker(camera).track(frame(shot(truth, camera=camera))).marker
    assert found is not None
    assert np.abs(found.corners_px - project(camera, truth, square_corners(SIDE_M))).max() < 0.3
    # From far away a tilt's sign is not to be told; from above is taken, which is right here.
    assert turn_deg(found.T_cam_marker, truth) < 1


def test_a_lens_that_bends_lines() -> None:
    """What is measured along straight lines in ideal pixels is exact where the picture's edges are bowed by pixels."""
    camera = Camera((640, 480), Camera.from_focal((640, 480), 350).K, np.array((-0.4, 0.2, 0, 0, -0.05)), "file")
    truth = pose(0.25, 30, 10)
    truth[:2, 3] = 0.1, 0.07
    found = tracker(camera).track(frame(shot(truth, camera=camera))).marker
    assert found is not None
    assert turn_deg(found.T_cam_marker, truth) < 0.1
    assert found.reprojection_rms_px < 0.05


@pytest.mark.parametrize("side_px", [12, 20, 400])
def test_tiny_and_filling_the_frame(side_px: int) -> None:
    truth = pose(CAMERA.K[0, 0] * SIDE_M / side_px, 8, 5)
    truth[:2, 3] = 0
    found = tracker().track(frame(shot(truth))).marker
    assert found is not None
    assert np.linalg.norm(found.T_cam_marker[:3, 3] - truth[:3, 3]) < 0.03 * truth[2, 3]


@pytest.mark.parametrize("tilt_deg", [80, 85, 88, 89.9])
def test_edge_on_it_is_right_or_not_found(tilt_deg: float) -> None:
    truth = pose(0.3, tilt_deg, 10)
    for one in followed([shot(truth)] * 2):
        assert one.marker is None or turn_deg(one.marker.T_cam_marker, truth) < 1


def test_tiny_frames() -> None:
    camera = Camera.from_focal((64, 48), 90)
    truth = pose(90 * SIDE_M / 24, 30, 10)
    truth[:2, 3] = 0
    found = tracker(camera).track(frame(shot(truth, camera=camera))).marker
    assert found is not None
    assert turn_deg(found.T_cam_marker, truth) < 3


def test_the_covariance_says_how_far_off_the_pose_is() -> None:
    """The squared error in its own covariance has six degrees of freedom: 5.3 in the median.

    These pictures have noise and no other errors; what else a photo may hold is allowed for beside it.
    """
    rng, squares = np.random.default_rng(8), []
    bitmap = parse_marker(SPEC).bitmap(6)
    camera = Camera.from_focal((320, 240), 900)
    for _ in range(30):
        truth = pose(0.6, rng.uniform(20, 60), rng.uniform(0, 360))
        image = PrintedMarker(bitmap, SIDE_M, camera).painted([truth], rng)
        found = tracker(camera).track(frame(image)).marker
        assert isinstance(found, MarkerPose)
        turn = cv2.Rodrigues(found.T_cam_marker[:3, :3] @ truth[:3, :3].T)[0].ravel()
        error = np.concatenate([turn, found.T_cam_marker[:3, 3] - truth[:3, 3]])
        squares.append(error @ np.linalg.solve(found.noise_covariance, error))
        assert (np.linalg.eigvalsh(found.covariance - found.noise_covariance) > 0).all()
    assert 2.5 < np.median(squares) < 11


@pytest.mark.parametrize("side_px", [60, 120])
@pytest.mark.parametrize("tilt_deg", [-20, -45, 20, 45])
def test_a_surface_that_leans_over_the_camera_is_distinguished_from_one_below_it(side_px: int, tilt_deg: float) -> None:
    """Straight edges say that the paper is flat: then far smaller errors are decisive than of curled paper."""
    truth = pose(CAMERA.K[0, 0] * SIDE_M / side_px, tilt_deg, 15)
    truth[:2, 3] = 0
    found = tracker().track(frame(shot(truth))).marker
    assert found is not None
    assert turn_deg(found.T_cam_marker, truth) < 1
