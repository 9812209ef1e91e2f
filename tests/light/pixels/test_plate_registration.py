"""A picture of the empty table is laid over that of the table, as far as one homography can."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, rigid
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.pixels.clean_plate.registration import registered
from tests.light.painted_scenes import BOX, SIDE_M, VIEW, paint, tracked_frame
from tests.light.synthetic_masks import camera_towards

POINTS = np.array([(0.1, 0.1, 0.0), (-0.1, 0.05, 0.0), (0.25, -0.02, 0.0), (0.0, -0.1, 0.0)])


def turned(axis: tuple[float, float, float], degrees: float) -> np.ndarray:
    """VIEW of a camera that was turned about its own centre."""
    R = cv2.Rodrigues(np.radians(degrees) * np.array(axis))[0]
    return rigid(R, (0, 0, 0)) @ VIEW


def empty_from(T_cam_marker: np.ndarray, ground: str = "bricks") -> TrackedFrame:
    return paint(ground=ground, T_cam_marker=T_cam_marker, seed=2).tracked


@pytest.fixture(scope="module")
def tracked() -> TrackedFrame:
    return paint(BOX, ground="bricks", seed=1).tracked


def test_by_a_camera_that_stood_still_it_is_the_picture_itself(tracked) -> None:
    empty = empty_from(VIEW)
    np.testing.assert_array_equal(registered(tracked, empty), empty.frame.image_bgr)


@pytest.mark.parametrize("axis", [(1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0)])
@pytest.mark.parametrize("degrees", [0.15, 1.0, 4.0])
def test_a_camera_that_turned_is_turned_back(tracked, axis, degrees) -> None:
    plate = registered(tracked, empty_from(turned(axis, degrees)))
    assert plate is not None
    # Painted as seen from the frame's own camera, the table has the same joints and the same print in the same places.
    own = np.asarray(empty_from(VIEW).frame.image_bgr).astype(np.float32)
    is_seen = (plate != np.asarray(tracked.frame.image_bgr)).any(axis=2)
    difference = np.abs(cv2.GaussianBlur(plate.astype(np.float32) - own, (0, 0), 2))[is_seen]
    assert np.percentile(difference, 95) < 6


def test_a_camera_that_moved_a_little_shows_the_plane_where_it_was(tracked) -> None:
    plate = registered(tracked, empty_from(camera_towards((0.08, 0.0), 0.56, 46.0)))
    assert plate is not None
    for at in np.round(project(tracked.camera, VIEW, POINTS)).astype(int):
        rows, columns = (slice(each - 4, each + 5) for each in (at[1], at[0]))
        own = np.asarray(empty_from(VIEW).frame.image_bgr)[rows, columns].astype(float)
        np.testing.assert_allclose(plate[rows, columns].mean(axis=(0, 1)), own.mean(axis=(0, 1)), atol=6)


def test_another_table_or_size_is_none(tracked) -> None:
    assert registered(tracked, empty_from(VIEW, "striped")) is None
    small = paint(ground="bricks", size=(320, 240)).tracked
    assert registered(tracked, small) is None
    noise = np.random.default_rng(0).integers(0, 256, (480, 640, 3), np.uint8)
    assert registered(tracked, replace(tracked, frame=Frame(noise, 0, 0.0))) is None


@pytest.mark.parametrize("gain", [0.4, 2.0])
def test_pictures_of_other_exposure_are_of_the_same_view(tracked, gain) -> None:
    linear = linear_from_srgb(np.asarray(empty_from(VIEW).frame.image_bgr) / 255.0) * gain
    image = np.round(255 * srgb_from_linear(linear.clip(0, 1))).astype(np.uint8)
    empty = replace(empty_from(VIEW), frame=Frame(image, 0, 0.0))
    np.testing.assert_array_equal(registered(tracked, empty), image)


@pytest.mark.parametrize("moved_m", [(0.01, 0.0), (0.0, 0.05), (-0.1, 0.0)])
def test_a_marker_that_was_moved_is_none(tracked, moved_m) -> None:
    """What lies on the table is where it was, but for the sheet."""
    corners_px = project(tracked.camera, VIEW, square_corners(SIDE_M) + np.array([*moved_m, 0.0]))
    empty = empty_from(VIEW)
    assert registered(tracked, replace(empty, marker=replace(empty.marker, corners_px=corners_px))) is None


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (5, 7), (640, 1), (1, 640)])
def test_tiny_pictures_are_none(size) -> None:
    width, height = size
    image = np.random.default_rng(0).integers(0, 256, (height, width, 3), np.uint8)
    tiny = tracked_frame(image, Camera.from_hfov(size, 55.0))
    assert registered(tiny, tiny) is None


@pytest.mark.parametrize("grey", [0, 128, 255])
def test_blank_pictures_are_none(tracked, grey) -> None:
    blank = replace(tracked, frame=Frame(np.full((480, 640, 3), grey, np.uint8), 0, 0.0))
    assert registered(tracked, blank) is None
    assert registered(blank, tracked) is None
