"""What one view of a marker tells of the focal length."""

import math

import numpy as np
import pytest

from ashe_live.bench.track.frames import PrintedMarker
from ashe_live.bench.track.takes import CELLS, SIDE_M, SPEC, pose_at
from ashe_live.core.camera import FOCAL_SIGMA, Camera
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.focal_tracker import FocalTracker

SIZE = (640, 480)


def found(hfov_deg: float, tilt_deg: float, side_px: float = 120, stated_px: float | None = None) -> TrackedFrame:
    """A first frame by a camera that sees `hfov_deg`, of which nothing is found, or what a photo states."""
    camera = Camera.from_hfov(SIZE, hfov_deg)
    truth = pose_at(camera.K[0, 0] * SIDE_M / side_px, tilt_deg, 25)
    image = PrintedMarker(parse_marker(SPEC).bitmap(CELLS), SIDE_M, camera).painted([truth], np.random.default_rng(2))
    tracker = FocalTracker(
        parse_marker(SPEC), lambda size: Camera.from_hfov(size, 60, "assumed"), SIDE_M, BALANCED.tracking
    )
    if stated_px is not None:
        tracker.use_stated(Camera.from_focal(SIZE, stated_px, "exif"))
    return tracker.track(Frame(image, 0, 0.0))


@pytest.mark.parametrize("hfov_deg", [45, 60, 75])
def test_an_oblique_marker_determines_the_focal_length(hfov_deg: float) -> None:
    camera, truth_px = found(hfov_deg, 45).camera, Camera.from_hfov(SIZE, hfov_deg).K[0, 0]
    assert camera.source == "estimated"
    assert camera.K[0, 0] == pytest.approx(truth_px, rel=0.03)
    assert camera.focal_sigma_px < 0.03 * truth_px
    assert abs(camera.K[0, 0] - truth_px) < 3 * camera.focal_sigma_px


def test_a_marker_seen_from_above_does_not_constrain_it() -> None:
    camera = found(75, 0, side_px=60).camera
    assert camera.source == "assumed"
    assert camera.focal_sigma_px == pytest.approx(FOCAL_SIGMA["assumed"] * camera.K[0, 0])


def test_what_is_not_known_of_the_focal_length_is_not_known_of_the_pose() -> None:
    """Seen from above, a marker is as far away as its focal length has it."""
    marker = found(60, 0, side_px=60).marker
    assert marker is not None
    sigma = math.sqrt(marker.covariance[5, 5]) / marker.T_cam_marker[2, 3]
    assert sigma == pytest.approx(FOCAL_SIGMA["assumed"], rel=0.1)
    # Between two frames it is the same error.
    assert math.sqrt(marker.noise_covariance[5, 5]) < 0.01 * marker.T_cam_marker[2, 3]


def test_what_a_photo_states_is_believed_before_what_is_assumed() -> None:
    tracker = FocalTracker(
        parse_marker(SPEC), lambda size: Camera.from_hfov(size, 60, "assumed"), SIDE_M, BALANCED.tracking
    )
    tracker.use_stated(Camera.from_focal(SIZE, 700.0, "exif"))
    empty = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    camera = tracker.track(Frame(empty, 0, 0.0)).camera
    assert (camera.source, camera.K[0, 0]) == ("exif", 700.0)
    # Of another size are other pictures.
    assert tracker.track(Frame(np.zeros((100, 100, 3), np.uint8), 1, 0.1)).camera.source == "assumed"


@pytest.mark.parametrize("share", [0.5, 0.75])
def test_the_focal_length_of_the_photo_that_it_was_cut_from_is_not_believed(share: float) -> None:
    """A cut photo keeps the angle of view that the whole one states, which in its own fewer pixels is too short."""
    truth_px = Camera.from_hfov(SIZE, 60).K[0, 0]
    tracked = found(60, 45, stated_px=share * truth_px)
    assert tracked.camera.source == "estimated"
    assert tracked.camera.K[0, 0] == pytest.approx(truth_px, rel=0.03)
    assert tracked.note is not None
    assert "does not fit the marker" in tracked.note


@pytest.mark.parametrize(("error", "tilt_deg"), [(0.97, 45), (1.0, 45), (1.03, 45), (1.0, 20)])
def test_one_that_is_as_true_as_cameras_state_it_is_kept(error: float, tilt_deg: float) -> None:
    stated_px = error * Camera.from_hfov(SIZE, 60).K[0, 0]
    tracked = found(60, tilt_deg, stated_px=stated_px)
    assert (tracked.camera.source, tracked.camera.K[0, 0], tracked.note) == ("exif", stated_px, None)


def test_a_marker_seen_from_above_contradicts_nothing() -> None:
    tracked = found(60, 0, side_px=60, stated_px=0.6 * Camera.from_hfov(SIZE, 60).K[0, 0])
    assert tracked.camera.source == "exif"
