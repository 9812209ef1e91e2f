"""The light stays where it is in the room when the marker is moved in it."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, inverse_rigid, project, rigid, transform_points
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.viewer.estimates.easing import EASED_OVER_S
from ashe_live.viewer.estimates.room_light import RoomLight

SIDE_M = 0.08
CAMERA = Camera.from_hfov((640, 480), 60)
T_CAM_ROOM = rigid(cv2.Rodrigues(np.array([2.3, 0.2, -0.1]))[0], (0.0, 0.0, 0.6))
SUN = Light(np.array([0.3, -0.2, 1.0]), shadow_rgb_ratio=np.full(3, 0.4))
LAMP = Light(np.array([0.3, -0.2, 1.0]), inverse_distance=2.0, shadow_rgb_ratio=np.full(3, 0.4))


def moved(turn_deg: float = 0.0, shift_m: tuple[float, float] = (0.0, 0.0), tilt_deg: float = 0.0) -> TrackedFrame:
    """A frame in which the marker lies elsewhere on its table, or was lifted from it."""
    turn = cv2.Rodrigues(np.array([0.0, 0.0, math.radians(turn_deg)]))[0]
    T_room_marker = rigid(turn @ cv2.Rodrigues(np.array([math.radians(tilt_deg), 0.0, 0.0]))[0], (*shift_m, 0.0))
    T = T_CAM_ROOM @ T_room_marker
    marker = MarkerPose(T, project(CAMERA, T, square_corners(SIDE_M)), SIDE_M, 0.1, None)
    return TrackedFrame(Frame(np.zeros((480, 640, 3), np.uint8), 0, 0.0), CAMERA, marker, T_room_marker=T_room_marker)


FIRST = moved()
ELSEWHERE = moved(70.0, (0.1, -0.06))
OUT_OF_VIEW = TrackedFrame(FIRST.frame, CAMERA, None)


def in_room(light: Light | None, seen_in: TrackedFrame) -> tuple[np.ndarray, float]:
    """The light as a point (x, y, z, w) of the room, scaled to a unit vector towards it."""
    assert light is not None
    assert seen_in.T_room_marker is not None
    point = seen_in.T_room_marker @ light.homogeneous
    return point / np.linalg.norm(point[:3])


@pytest.mark.parametrize("light", [SUN, LAMP])
def test_it_stays_where_it_is_while_the_marker_is_moved(light: Light) -> None:
    room = RoomLight()
    room.take(Illumination((light,)), FIRST)
    assert room.now(FIRST).light is light
    seen = room.now(ELSEWHERE)
    np.testing.assert_allclose(in_room(seen.light, ELSEWHERE), in_room(light, FIRST), atol=1e-9)
    assert angle_between(seen.light.to_light_marker, light.to_light_marker) > 0.1
    assert room.now(ELSEWHERE) is seen  # or it would be drawn anew for every frame
    # While it is out of view it lies where it lay at last.
    np.testing.assert_allclose(room.now(OUT_OF_VIEW).light.to_light_marker, seen.light.to_light_marker)
    estimate = LightEstimate("proxy", 0, Illumination((light,)))
    np.testing.assert_allclose(room.seen_by(ELSEWHERE, estimate).light.homogeneous, seen.light.homogeneous)
    assert room.seen_by(FIRST, estimate) is room.seen_by(OUT_OF_VIEW, estimate) is estimate


def test_an_estimate_of_the_moved_marker_is_of_where_it_lies_then() -> None:
    room, lit = RoomLight(), Illumination((SUN,))
    for lies in (FIRST, ELSEWHERE):  # a second time the same light by its frame, and so another one of the room
        room.take(lit, lies)
        assert room.now(lies).light is SUN
    np.testing.assert_allclose(in_room(room.now(FIRST).light, FIRST), in_room(SUN, ELSEWHERE), atol=1e-9)


def test_a_marker_that_is_out_of_view_may_have_been_moved_before() -> None:
    """Where it lies is known of every frame."""
    room, gone = RoomLight(), replace(ELSEWHERE, marker=None)
    estimate = LightEstimate("proxy", 0, Illumination((SUN,)))
    room.take(estimate.illumination, FIRST)
    assert room.now(gone).light is SUN
    assert room.seen_by(gone, estimate) is room.seen_by(None, estimate) is estimate
    assert room.show_by_hand(gone, by_hand := Illumination((LAMP,))) is by_hand


def test_until_the_first_estimate_what_mirrors_mirrors_the_first_picture_with_the_marker() -> None:
    room = RoomLight()
    room.see(OUT_OF_VIEW)
    assert not room.has_seen_marker
    room.see(FIRST)
    assert room.has_seen_marker
    room.see(ELSEWHERE)
    assert room.now(FIRST).seen_in is FIRST
    seen = room.now(ELSEWHERE).seen_in
    assert seen.frame is FIRST.frame
    # Where the marker lies now, the picture has it where that place was.
    point = np.array([[0.02, 0.01, 0.0]])
    in_first = transform_points(inverse_rigid(FIRST.T_room_marker) @ ELSEWHERE.T_room_marker, point)
    assert project(CAMERA, seen.marker.T_cam_marker, point) == pytest.approx(
        project(CAMERA, FIRST.marker.T_cam_marker, in_first)
    )


def test_without_an_estimate_there_is_the_sky_or_what_is_set_by_hand() -> None:
    room, by_hand = RoomLight(), Illumination((SUN,))
    for tracked in (None, OUT_OF_VIEW, ELSEWHERE):
        assert room.now(tracked).lights == ()
        assert room.show_by_hand(tracked, by_hand) is by_hand
        assert room.shown(tracked, 0.0).light.to_light_marker == pytest.approx(SUN.to_light_marker)
    room.take(by_hand, FIRST)
    room.take(Illumination(), None)  # it is gone
    assert room.now(ELSEWHERE).lights == ()


def test_a_marker_is_lifted_when_it_leaves_its_plane_under_a_known_light() -> None:
    room = RoomLight()
    assert not room.is_lifted(moved(tilt_deg=40))
    room.take(Illumination((SUN,)), FIRST)
    assert not room.is_lifted(FIRST)
    assert not room.is_lifted(ELSEWHERE)
    assert room.is_lifted(moved(tilt_deg=40))
    room.take(Illumination(), FIRST)  # that no light was found tells nothing of the plane
    assert not room.is_lifted(moved(tilt_deg=40))


def test_from_a_light_that_was_set_by_hand_the_next_one_eases_in_the_room() -> None:
    room = RoomLight()
    room.take(Illumination((SUN,)), FIRST)
    by_hand = Illumination((Light(np.array([-0.6, 0.5, 0.8]), shadow_rgb_ratio=np.full(3, 0.4)),))
    assert room.show_by_hand(ELSEWHERE, by_hand) is by_hand
    begin = room.shown(ELSEWHERE, 5.0).light
    assert angle_between(begin.to_light_marker, by_hand.light.to_light_marker) < 1e-6
    end = room.shown(ELSEWHERE, 5.0 + EASED_OVER_S).light
    np.testing.assert_allclose(in_room(end, ELSEWHERE), in_room(SUN, FIRST), atol=1e-9)


def test_what_is_on_its_way_stays_in_the_room_when_the_marker_is_moved() -> None:
    room = RoomLight()
    room.take(Illumination((SUN,)), FIRST)
    room.jump(FIRST)
    towards = inverse_rigid(ELSEWHERE.T_room_marker)[:3, :3] @ np.array([-0.2, 0.3, 0.9])
    room.take(Illumination((Light(towards, shadow_rgb_ratio=np.full(3, 0.4)),)), ELSEWHERE)
    begin = room.shown(ELSEWHERE, 5.0).light
    np.testing.assert_allclose(in_room(begin, ELSEWHERE), in_room(SUN, FIRST), atol=1e-6)
    end = room.shown(ELSEWHERE, 5.0 + EASED_OVER_S).light
    assert angle_between(end.to_light_marker, towards) < 1e-6


def test_a_marker_that_is_out_of_view_lies_where_it_lay_while_the_light_is_on_its_way() -> None:
    room = RoomLight()
    room.take(Illumination((SUN,)), FIRST)
    room.jump(ELSEWHERE)
    for out_of_view in (OUT_OF_VIEW, None):
        turned = Illumination((Light(np.array([-0.2, 0.3, 0.9]), shadow_rgb_ratio=np.full(3, 0.4)),))
        room.take(turned, FIRST)
        for now_s in (5.0, 5.0 + EASED_OVER_S):
            seen = room.shown(out_of_view, now_s).light
            np.testing.assert_allclose(seen.homogeneous, room.shown(ELSEWHERE, now_s).light.homogeneous, atol=1e-9)
