"""Value types refuse what they cannot mean, and cannot be changed."""

import copy
import dataclasses
import math
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)


def frame(size: tuple[int, int] = (4, 3)) -> Frame:
    return Frame(np.zeros((size[1], size[0], 3), np.uint8), 0, 0.0)


def test_arrays_in_values_are_read_only() -> None:
    pose = MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None)
    with pytest.raises(ValueError, match="read-only"):
        pose.T_cam_marker[0, 0] = 2
    with pytest.raises(ValueError, match="read-only"):
        frame().image_bgr[0, 0] = 2
    with pytest.raises(dataclasses.FrozenInstanceError):
        pose.side_m = 1.0  # type: ignore[misc]


def test_a_value_keeps_its_own_copy_of_small_arrays() -> None:
    T = np.eye(4)
    pose = MarkerPose(T, CORNERS, 0.08, 0.1, None)
    T[0, 0] = 5
    assert pose.T_cam_marker[0, 0] == 1


def test_values_are_compared_by_identity_as_their_arrays_have_no_single_answer() -> None:
    one, other = (Light(np.array([0.0, 0.6, 0.8])) for _ in range(2))
    assert one != other
    assert Illumination((one,)) != Illumination((one,))
    assert len({one, other, one}) == 2


@pytest.mark.parametrize("image", [np.zeros((3, 4), np.uint8), np.zeros((3, 4, 4), np.uint8), np.zeros((3, 4, 3))])
def test_a_frame_is_8_bit_colour(image: np.ndarray) -> None:
    with pytest.raises(ValueError, match="image_bgr must be"):
        Frame(image, 0, 0.0)


def test_a_pose_is_finite_and_its_marker_has_a_size() -> None:
    with pytest.raises(ValueError, match="finite"):
        MarkerPose(np.full((4, 4), np.nan), CORNERS, 0.08, 0.1, None)
    with pytest.raises(ValueError, match="side"):
        MarkerPose(np.eye(4), CORNERS, 0.0, 0.1, None)


def test_a_tracked_frame_has_a_pose_where_it_has_a_marker() -> None:
    pose, camera = MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None), Camera.from_hfov((4, 3), 60.0)
    assert TrackedFrame(frame(), camera, pose).pose is pose
    with pytest.raises(ValueError, match="no marker"):
        _ = TrackedFrame(frame(), camera, None).pose


def test_camera_and_frame_have_one_size() -> None:
    with pytest.raises(ValueError, match="camera"):
        TrackedFrame(frame(), Camera.from_hfov((8, 6), 60), None)


POSE = MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None)
CAMERA = Camera.from_hfov((4, 3), 60)
LIGHT = Light((0.0, 0.0, 1.0))
SEEN = TrackedFrame(frame(), CAMERA, POSE)


@pytest.mark.parametrize(
    ("make", "error", "named"),
    [
        (lambda: TrackedFrame(frame().image_bgr, CAMERA, POSE), TypeError, "frame"),
        (lambda: Frame(frame().image_bgr, "a", 0.0), TypeError, "index"),
        (lambda: Frame(frame().image_bgr, 0.5, 0.0), TypeError, "index"),
        (lambda: Frame(frame().image_bgr, 10**18, 0.0), ValueError, "index"),  # as nanoseconds: drawing it failed
        (lambda: Frame(frame().image_bgr, 0, math.nan), ValueError, "time_s"),
        (lambda: Frame(frame().image_bgr, 0, None), TypeError, "time_s"),
        (lambda: TrackedFrame(frame(), CAMERA.K, POSE), TypeError, "camera"),
        (lambda: dataclasses.replace(SEEN, others=(1,)), TypeError, "each of others"),
        (lambda: dataclasses.replace(POSE, body=np.eye(4)), TypeError, "body"),
        (lambda: dataclasses.replace(POSE, pose_shape_errors=np.eye(6)), TypeError, "pose_shape_errors"),
        (lambda: TrackedFrame(frame(), CAMERA, np.eye(4)), TypeError, "marker"),
        (lambda: TrackedFrame(frame(), CAMERA, POSE, T_room_marker=np.eye(3)), ValueError, "T_room_marker"),
        (lambda: dataclasses.replace(SEEN, clean_plate_bgr=np.zeros((4, 4, 3), np.uint8)), ValueError, "clean plate"),
        (lambda: dataclasses.replace(SEEN, clean_plate_bgr=np.zeros((3, 4, 3))), ValueError, "clean_plate_bgr"),
        (lambda: MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None, np.eye(3)), ValueError, "covariance"),
        (lambda: Illumination([LIGHT]), TypeError, "lights"),
        (lambda: Illumination((LIGHT.to_light_marker,)), TypeError, "each of lights"),
        (lambda: Illumination((LIGHT,), real_object=CORNERS), TypeError, "real_object"),
        (lambda: Illumination((LIGHT,), seen_in=frame()), TypeError, "seen_in"),
        (lambda: Illumination((LIGHT,), seen_in=TrackedFrame(frame(), CAMERA, None)), ValueError, "without a marker"),
        (lambda: Illumination((LIGHT,), ground_rgb=(0.1, 0.2)), ValueError, "ground_rgb"),
        (lambda: LightEstimate("proxy", 0, (LIGHT,)), TypeError, "illumination"),
        (lambda: LightEstimate("proxy", 0, Illumination((LIGHT,)), span_rad=-0.1), ValueError, "span_rad"),
        (lambda: Light((0.0, 0.0, 0.0)), ValueError, "no direction"),
        (lambda: Light((0.0, 0.0, 1.0), confidence=1.1), ValueError, "confidence"),
        (lambda: Light((0.0, 0.0, 1.0), covariance_rad2=np.eye(3)), ValueError, "covariance_rad2"),
        (lambda: Light((0.0, 0.0, 1.0), lamp_covariance=np.eye(2)), ValueError, "lamp_covariance"),
        (lambda: Light((0.0, 0.0, 1.0), sigma_rad=math.inf), ValueError, "sigma_rad"),
        (lambda: Light((0.0, 0.0, 1.0), angular_size_rad="wide"), TypeError, "angular_size_rad"),
        (lambda: Light((0.0, 0.0, 1.0), radius_m=-0.1), ValueError, "radius_m"),
        (lambda: Light((0.0, 0.0, 1.0), angular_size_rad=3.2), ValueError, "angular_size_rad"),
        (lambda: Light((0.0, 0.0, 1.0), covariance_rad2=-np.eye(2)), ValueError, "covariance_rad2"),
        (lambda: Light((0.0, 0.0, 1.0), lamp_covariance=-np.eye(3)), ValueError, "lamp_covariance"),
        (lambda: Light((0.0, 0.0, 1.0), inverse_distance=None), TypeError, "inverse_distance"),
        (lambda: MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None, -np.eye(6)), ValueError, "covariance"),
        (lambda: dataclasses.replace(POSE, noise_covariance=-np.eye(6)), ValueError, "noise_covariance"),
    ],
)
def test_what_a_value_cannot_hold_is_named(make: Callable[[], object], error: type[Exception], named: str) -> None:
    with pytest.raises(error, match=named):
        make()


@pytest.mark.parametrize(
    ("T", "why"),
    [
        (np.diag([1.0, 1.0, -1.0, 1.0]), "mirrors"),  # as between frames of which one is left-handed
        (np.diag([100.0, 100.0, 100.0, 1.0]), "right angles, each of length 1"),  # centimetres
        (np.array([(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0.1, 0, 0.5, 1.0)]), "last row"),  # row vectors
        (np.zeros((4, 4)), "last row"),
    ],
)
def test_a_pose_that_is_not_rigid_is_refused(T: NDArray[np.float64], why: str) -> None:
    """A light found in it would point elsewhere, and be sure of it."""
    for make in (
        lambda: MarkerPose(T, CORNERS, 0.08, 0.1, None),
        lambda: MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, None, unfiltered_T_cam_marker=T),
        lambda: TrackedFrame(frame(), Camera.from_hfov((4, 3), 60), None, T_room_marker=T),
    ):
        with pytest.raises(ValueError, match=why):
            make()


def test_a_pose_may_be_rounded() -> None:
    for rotation in np.random.default_rng(7).normal(size=(500, 3)):
        T = np.eye(4)
        T[:3, :3] = cv2.Rodrigues(rotation)[0].round(2)
        MarkerPose(T.astype(np.float32), CORNERS, 0.08, 0.1, None)


def test_a_frame_may_be_counted_by_numpy_and_timed_by_a_clock() -> None:
    counted = Frame(frame().image_bgr, np.int64(3), np.float32(0.5))
    assert (type(counted.index), type(counted.time_s)) == (int, float)
    assert Frame(frame().image_bgr, 3, 1.8e9).time_s == 1.8e9


def test_a_value_with_fields_of_its_own_is_copied_with_them() -> None:
    @dataclasses.dataclass(frozen=True, eq=False)
    class Named(Frame):
        name: str = ""

    there = copy.deepcopy(Named(np.zeros((3, 4, 3), np.uint8), 0, 0.0, name="a"))
    assert there.name == "a"
    assert not there.image_bgr.flags.writeable


def test_values_cross_between_processes() -> None:
    pose = MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, 0.2)
    tracked = TrackedFrame(frame(), Camera.from_hfov((4, 3), 60), pose, 1.5)
    back = pickle.loads(pickle.dumps(tracked))
    np.testing.assert_array_equal(back.marker.T_cam_marker, pose.T_cam_marker)
    assert back.camera.size == (4, 3)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_copies_of_values_are_read_only_as_well(copied: Callable[[TrackedFrame], TrackedFrame]) -> None:
    """NumPy's own copies are not, so that a light from another process could be bent, and would be no unit vector."""
    pose = MarkerPose(np.eye(4), CORNERS, 0.08, 0.1, 0.2, body=Proxy("box", np.ones((1, 5))))
    tracked = TrackedFrame(frame(), Camera.from_hfov((4, 3), 60), pose, T_room_marker=np.eye(4))
    seen = Illumination((Light((0.0, 0.0, 1.0)),), np.ones(3), seen_in=tracked)
    mask = np.ones((2, 2), bool)
    given = LightEstimate("proxy", 0, seen, object_mask=mask, shadow_mask=mask)
    for value in (given, copied(given)):
        found = list(arrays_in(value))
        assert len(found) == 11
        assert not any(array.flags.writeable for array in found)
    mask[0, 0] = False  # the caller's own stays so


def arrays_in(value: object) -> Iterator[NDArray[Any]]:
    """All arrays in a value and in the values in it."""
    if isinstance(value, np.ndarray):
        yield value
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from arrays_in(getattr(value, field.name))
    elif isinstance(value, tuple):
        for each in value:
            yield from arrays_in(each)
