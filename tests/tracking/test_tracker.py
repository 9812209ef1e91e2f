"""The tracker on pictures of a known pose, and on pictures without a marker."""

from collections.abc import Callable

import numpy as np
import pytest

from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera, Size
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import MarkerPose
from ashe_live.errors import UserError
from ashe_live.quality import BALANCED, FAST, QUALITIES, Quality
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import SIDE_M, SPECS, frame, picture, pose

CAMERA = Camera.from_focal((640, 480), 600)
ARUCO = parse_marker("aruco:4x4_50:3")


def tracker(marker: Marker = ARUCO, quality: Quality = BALANCED, camera: Camera = CAMERA) -> MarkerTracker:
    return MarkerTracker(marker, camera, SIDE_M, quality.tracking)


def check(found: MarkerPose | None, truth: Float, camera: Camera, within_deg: float = 1.0) -> None:
    assert found is not None
    assert turn_deg(found.T_cam_marker, truth) < within_deg
    assert found.T_cam_marker[:3, 3] == pytest.approx(truth[:3, 3], rel=0.02, abs=0.002)
    assert np.abs(found.corners_px - project(camera, truth, square_corners(SIDE_M))).max() < 0.4
    assert found.reprojection_rms_px < 0.3


@pytest.mark.parametrize("spec", SPECS)
@pytest.mark.parametrize(("tilt_deg", "turn"), [(30, 0), (60, 90), (30, 180), (60, 270)])
def test_the_pose_is_the_one_that_was_drawn(
    marker_of: Callable[[str], Marker], spec: str, tilt_deg: float, turn: float
) -> None:
    marker = marker_of(spec)
    truth = pose(0.45, tilt_deg, turn + 10, aside_m=0.04)
    check(tracker(marker).track(frame(picture(marker, CAMERA, truth))).marker, truth, CAMERA)


@pytest.mark.parametrize("quality", QUALITIES.values(), ids=QUALITIES.keys())
def test_every_preset_refines_at_full_resolution(quality: Quality) -> None:
    camera = Camera.from_focal((1440, 1080), 1350)
    truth = pose(0.45, 45, 25)
    image = picture(ARUCO, camera, truth)
    check(tracker(quality=quality, camera=camera).track(frame(image)).marker, truth, camera, 0.5)


def test_followed_from_frame_to_frame_and_found_again_after_a_jump() -> None:
    followed = tracker()
    for index, aside in enumerate((-0.10, -0.09, -0.08, 0.12, 0.13)):
        truth = pose(0.5, 40, 5.0 * index, aside_m=aside)
        check(followed.track(frame(picture(ARUCO, CAMERA, truth), index)).marker, truth, CAMERA)


def test_the_region_alone_finds_what_has_hardly_moved() -> None:
    """The search near the last place must answer by itself: the whole frame would only hide that it does not."""
    followed = tracker()
    truth = pose(0.5, 40)
    followed.track(frame(picture(ARUCO, CAMERA, truth)))
    followed._find_anywhere = lambda _: pytest.fail("searched the whole frame")  # type: ignore[method-assign]
    moved = pose(0.5, 42, 4, aside_m=0.01)
    check(followed.track(frame(picture(ARUCO, CAMERA, moved), 1)).marker, moved, CAMERA)


def test_after_a_jump_the_last_pose_decides_between_the_two_of_a_square() -> None:
    """A print over the camera, from far: taken for one on a table, unless it was seen from near before."""
    near, far = pose(0.4, -40), pose(1.5, -14)
    image = frame(picture(ARUCO, CAMERA, far), 900)
    followed = tracker()
    assert turn_deg(followed.track(image).marker.T_cam_marker, far) > 15
    for is_right, forget in ((True, MarkerTracker.jump), (False, MarkerTracker.reset)):
        followed.reset()
        followed.track(frame(picture(ARUCO, CAMERA, near)))
        forget(followed)
        assert (turn_deg(followed.track(image).marker.T_cam_marker, far) < 8) is is_right


def test_reset_and_rewind_forget_the_last_pose() -> None:
    truth = pose(0.5, 40)
    image = picture(ARUCO, CAMERA, truth)
    for forget in (MarkerTracker.reset, lambda followed: followed.track(frame(image, 90))):
        followed = tracker()
        followed.track(frame(image, 30))
        forget(followed)
        followed._find_near = lambda *_: pytest.fail("remembered")  # type: ignore[method-assign]
        check(followed.track(frame(image, 0)).marker, truth, CAMERA)


def test_frames_of_another_size_get_a_camera_of_their_size() -> None:
    followed = tracker()
    for size in ((640, 480), (320, 240), (640, 480)):
        camera = CAMERA.resized(size)
        truth = pose(0.35, 40)
        tracked = followed.track(frame(picture(ARUCO, camera, truth)))
        assert tracked.camera.size == size
        assert tracked.marker is not None
        assert turn_deg(tracked.marker.T_cam_marker, truth) < 1.5


def test_the_camera_may_be_asked_for_by_size() -> None:
    asked: list[Size] = []

    def camera_for(size: Size) -> Camera:
        asked.append(size)
        return Camera.from_hfov(size, 60)

    followed = MarkerTracker(ARUCO, camera_for, SIDE_M, FAST.tracking)
    for index in range(3):
        followed.track(frame(np.zeros((48, 64, 3), dtype=np.uint8), index))
    assert asked == [(64, 48)]


def test_a_camera_of_another_shape_is_refused_in_one_line() -> None:
    with pytest.raises(UserError, match="aspect ratio"):
        tracker().track(frame(np.zeros((100, 100, 3), dtype=np.uint8)))


def test_the_preset_may_change_while_running() -> None:
    followed = tracker(quality=FAST)
    truth = pose(0.5, 40)
    image = picture(ARUCO, CAMERA, truth)
    for index, quality in enumerate(QUALITIES.values()):
        followed.preset = quality.tracking
        check(followed.track(frame(image, index)).marker, truth, CAMERA)


def test_the_pose_scales_with_the_side() -> None:
    image = picture(ARUCO, CAMERA, pose(0.5, 40))
    small, large = (
        MarkerTracker(ARUCO, CAMERA, side, FAST.tracking).track(frame(image)).marker for side in (0.08, 1.6)
    )
    assert small is not None
    assert large is not None
    assert large.T_cam_marker[:3, 3] == pytest.approx(20 * small.T_cam_marker[:3, 3], rel=1e-3)


def _pictures_without_a_marker() -> dict[str, Image]:
    rng = np.random.default_rng(5)
    tile = np.kron(np.indices((8, 8)).sum(axis=0) % 2, np.ones((40, 40))).astype(np.uint8) * 255
    return {
        "black": np.zeros((240, 320, 3), dtype=np.uint8),
        "white": np.full((240, 320, 3), 255, dtype=np.uint8),
        "grey": np.full((240, 320, 3), 119, dtype=np.uint8),
        "noise": rng.integers(0, 256, (240, 320, 3), dtype=np.uint8),
        "chessboard": np.repeat(tile[:, :, None], 3, axis=2),
        "pixel": np.full((1, 1, 3), 9, dtype=np.uint8),
        "row": np.full((1, 300, 3), 9, dtype=np.uint8),
        "column": np.full((300, 2, 3), 200, dtype=np.uint8),
    }


@pytest.mark.parametrize("spec", SPECS)
@pytest.mark.parametrize("name", _pictures_without_a_marker().keys())
def test_no_marker_is_a_value(marker_of: Callable[[str], Marker], spec: str, name: str) -> None:
    image = _pictures_without_a_marker()[name]
    height, width = image.shape[:2]
    tracked = tracker(marker_of(spec), camera=Camera.from_focal((width, height), 300)).track(frame(image))
    assert tracked.marker is None
    assert tracked.detect_ms >= 0
