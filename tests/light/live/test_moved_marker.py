"""A light, a body and what was seen stay where they are in the room when the marker is moved in it."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy, ProxyMesh
from ashe_live.core.square import PlaneMarker, square_corners
from ashe_live.core.transforms import (
    inverse_rigid,
    lies_elsewhere,
    motion_between,
    project,
    rigid,
    tangent_basis,
    transform_points,
)
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.moved_marker import moved_illumination, seen_before_move, stays_on_plane
from tests.light.synthetic_masks import camera_towards

SIDE_M = 0.08
CAMERA = Camera.from_hfov((640, 480), 60)
TURNED = rigid(cv2.Rodrigues(np.radians([0.0, 0.0, -70.0]))[0], [0.03, -0.02, 0.0])  # T_new_old
TILTED = rigid(cv2.Rodrigues(np.radians([20.0, -10.0, 30.0]))[0], [0.03, -0.02, 0.05])
COVARIANCE = np.array([[4e-3, 1e-3], [1e-3, 1e-3]])


def seen(T_cam_marker=None, **kwargs) -> TrackedFrame:
    T_cam_marker = camera_towards((0.0, 0.0), 0.5, 50.0) if T_cam_marker is None else T_cam_marker
    corners_px = project(CAMERA, T_cam_marker, square_corners(SIDE_M))
    frame = Frame(np.zeros((480, 640, 3), np.uint8), 0, 0.0)
    return TrackedFrame(frame, CAMERA, MarkerPose(T_cam_marker, corners_px, SIDE_M, 0.1, None), **kwargs)


PRINT = seen().marker


@pytest.mark.parametrize(
    ("tilt_deg", "lift_m", "stays"),
    [(0, 0.0, True), (4.5, 0.01, True), (5.5, 0.0, False), (0, 0.014, False), (0, -0.014, False), (180, 0.0, False)],
)
def test_a_sheet_that_is_tilted_or_lifted_no_longer_lies_on_its_plane_however_far_it_was_moved_on_it(
    tilt_deg, lift_m, stays
) -> None:
    """Of paper 8 cm wide; the same holds for a sheet ten times as large that is lifted by ten times as much."""
    R = cv2.Rodrigues(np.radians([tilt_deg, 0.0, 0.0]))[0] @ TURNED[:3, :3]
    for factor in (0.1, 1, 10):
        assert stays_on_plane(rigid(R, factor * np.array([0.3, -0.5, lift_m])), factor * SIDE_M) is stays


@pytest.mark.parametrize("motion", [TURNED, TILTED], ids=["turned", "tilted"])
@pytest.mark.parametrize("inverse_distance", [0.0, 2.0], ids=["sun", "lamp"])
def test_a_light_stays_in_the_room(motion, inverse_distance) -> None:
    light = Light(np.array([0.5, 0.3, 0.8]), COVARIANCE, inverse_distance=inverse_distance)
    (moved,) = moved_illumination(Illumination((light,)), motion, PRINT).lights
    if inverse_distance:
        assert moved.position_marker_m == pytest.approx(transform_points(motion, [light.position_marker_m])[0])
    else:
        assert moved.to_light_marker == pytest.approx(motion[:3, :3] @ light.to_light_marker)
        assert moved.inverse_distance == 0
        before, after = (basis.T @ each.covariance_rad2 @ basis for each in (light, moved)
                         for basis in [tangent_basis(each.to_light_marker)])  # fmt: skip
        assert after == pytest.approx(motion[:3, :3] @ before @ motion[:3, :3].T)
    assert np.linalg.eigvalsh(moved.covariance_rad2).min() > 0


def test_a_lamp_that_the_marker_is_moved_into_keeps_a_direction() -> None:
    lamp = Light(np.array([0.0, 0.0, 1.0]), inverse_distance=10.0)
    into = rigid(np.eye(3), [0.0, 0.0, -0.1])
    (moved,) = moved_illumination(Illumination((lamp,)), into, PRINT).lights
    assert moved.to_light_marker == pytest.approx([0, 0, 1])


def test_bodies_stand_where_they_stood_as_long_as_the_marker_lies_on_their_plane() -> None:
    mesh = ProxyMesh(np.eye(3), np.array([[0, 1, 2]]))
    body = Proxy("cylinder", np.array([[0.1, 0.0, 0.0, 0.03, 0.0], [0.1, 0.0, 0.1, 0.03, 0.0]]), mesh)
    lit = Illumination((), real_object=body)
    moved = moved_illumination(lit, TURNED, PRINT).real_object
    assert moved.foot_marker == pytest.approx(transform_points(TURNED, [body.foot_marker])[0])
    assert moved.height_m == pytest.approx(body.height_m)
    assert moved.mesh.points_marker == pytest.approx(transform_points(TURNED, np.eye(3)))
    assert moved_illumination(lit, TILTED, PRINT).real_object is None


def test_the_sky_leans_the_same_way_in_the_room() -> None:
    slope = np.array([[0.2, 0.2, 0.3], [0.0, 0.1, 0.0]])
    moved = moved_illumination(Illumination((), sky_slope_rgb=slope), TURNED, PRINT).sky_slope_rgb
    normal = np.array([0.6, -0.8, 0.0])
    assert (TURNED[:3, :3] @ normal)[:2] @ moved == pytest.approx(normal[:2] @ slope)


def test_what_polished_surfaces_mirror_stays_in_its_picture() -> None:
    frame = seen()
    moved = moved_illumination(Illumination((), seen_in=frame), TURNED, PRINT).seen_in
    points = np.array([[0.1, 0.2, 0.0], [0.0, 0.1, 0.05]])
    now = project(CAMERA, moved.marker.T_cam_marker, transform_points(TURNED, points))
    assert now == pytest.approx(project(CAMERA, frame.marker.T_cam_marker, points))


def test_a_view_from_before_shows_the_sheet_where_it_lay() -> None:
    beside = PlaneMarker("aruco:4x4_50:3", np.array([0.2, 0.1]), 0.5, 0.06)
    before = seen(T_room_marker=np.eye(4), others=(beside,))
    now = seen_before_move(before, inverse_rigid(TURNED))
    pose = now.marker.T_cam_marker
    assert now.marker.corners_px == pytest.approx(project(CAMERA, pose, square_corners(SIDE_M)), abs=1e-3)
    other, lay = now.others
    for one, points in ((lay, square_corners(SIDE_M)), (other, square_corners(0.06))):
        where = points if one is lay else beside.on_plane(points)
        assert project(CAMERA, pose, one.on_plane(points)) == pytest.approx(
            project(CAMERA, before.marker.T_cam_marker, where), abs=1e-6
        )
    assert now.frame is before.frame


def test_moved_twice_the_sheet_lies_in_a_view_only_where_it_lay_then() -> None:
    before = seen(T_room_marker=np.eye(4))
    once = seen_before_move(before, inverse_rigid(TURNED))
    twice = seen_before_move(once, inverse_rigid(TURNED @ TURNED))
    (lay,) = twice.others
    assert project(CAMERA, twice.marker.T_cam_marker, lay.on_plane(square_corners(SIDE_M))) == pytest.approx(
        project(CAMERA, before.marker.T_cam_marker, square_corners(SIDE_M)), abs=1e-6
    )


@pytest.mark.parametrize("beyond_m", [0.0, 0.5], ids=["half of it", "all of it"])
def test_no_view_is_kept_of_a_place_that_lies_behind_the_camera(beyond_m: float) -> None:
    before = seen(T_room_marker=np.eye(4))
    ahead = before.marker.T_cam_marker[2]  # a point's depth, by where it lies on the plane
    level = ahead[:2] / np.linalg.norm(ahead[:2])
    at_the_camera = -ahead[3] / np.linalg.norm(ahead[:2]) * level
    for along, is_kept in ((0.5 * at_the_camera, True), (at_the_camera - beyond_m * level, False)):
        lies = rigid(np.eye(3), [*along, 0.0])
        assert (seen_before_move(before, lies) is not None) is is_kept


def test_no_view_is_kept_of_a_marker_that_was_lifted_or_of_a_cube() -> None:
    assert seen_before_move(seen(T_room_marker=np.eye(4)), inverse_rigid(TILTED)) is None
    cube = seen(T_room_marker=np.eye(4))
    cube = replace(cube, marker=replace(cube.marker, body=Proxy("box", np.array([[0, 0, 0.03, 0.0, 0.0]]))))
    assert seen_before_move(cube, inverse_rigid(TURNED)) is None


def test_what_counts_as_moved() -> None:
    lies = np.eye(4)
    assert motion_between(lies, lies) is None
    assert motion_between(None, lies) is None
    assert motion_between(lies, inverse_rigid(TURNED)) == pytest.approx(TURNED)
    for degrees, metres, is_elsewhere in ((0.5, 0.0, False), (2.0, 0.0, True), (0.0, 0.001, False), (0, 0.01, True)):
        slight = rigid(cv2.Rodrigues(np.array([0, 0, math.radians(degrees)]))[0], [metres, 0, 0])
        assert lies_elsewhere(lies, slight, SIDE_M) is is_elsewhere


def test_the_cube_goes_with_its_prints() -> None:
    cube = Proxy("box", np.array([[0, 0, 0.03, 0.0, 0.0]]))
    moved = moved_illumination(Illumination((), real_object=cube), TURNED, replace(PRINT, body=cube))
    assert moved.real_object is cube


def test_what_was_read_in_the_picture_is_known_by_the_marker_as_it_lay_there() -> None:
    lit = Illumination((Light(np.array([0.5, 0.3, 0.8])),), seen_in=seen())
    once = moved_illumination(lit, TURNED, PRINT)
    assert once.as_read is lit
    assert moved_illumination(once, TURNED, PRINT).as_read is lit


def test_on_its_table_a_sheet_may_be_turned_and_all_that_was_measured_of_a_sun_stays() -> None:
    """Also where it contradicts itself, or is incomplete."""
    sun = Light(np.array([0.6, 0.0, 0.8]), shadow_rgb_ratio=np.full(3, 0.3))
    for ambient in (np.full(3, 0.5), None):
        moved = moved_illumination(Illumination((sun,), ambient), TURNED, PRINT)
        assert moved.lights[0].shadow_rgb_ratio == pytest.approx(sun.shadow_rgb_ratio)
        assert moved.ambient_rgb_ratio == (None if ambient is None else pytest.approx(ambient))


def test_what_was_not_measured_is_not_made_up_where_the_sheet_is_tilted() -> None:
    sun, unknown = Light(np.array([0.6, 0.0, 0.8]), shadow_rgb_ratio=np.full(3, 0.3)), Light(np.array([0.0, 0.6, 0.8]))
    ambient = np.full(3, 0.5)
    assert moved_illumination(Illumination((), ambient), TILTED, PRINT).ambient_rgb_ratio == pytest.approx(ambient)
    assert moved_illumination(Illumination((sun,)), TILTED, PRINT).ambient_rgb_ratio is None
    moved = moved_illumination(Illumination((sun, unknown), ambient), TILTED, PRINT)
    assert [light.shadow_rgb_ratio is None for light in moved.lights] == [False, True]
    assert moved.ambient_rgb_ratio == pytest.approx(ambient)


def test_a_light_gives_a_tilted_sheet_as_much_as_its_cosine_says() -> None:
    """The sky gives what was measured of it, though with the sun that was more than all there was."""
    light = Light(np.array([0.6, 0.0, 0.8]), shadow_rgb_ratio=np.full(3, 0.4))
    lit = Illumination((light,), np.full(3, 0.5))
    moved = moved_illumination(lit, TILTED, PRINT)
    (now,) = moved.lights
    sun_over_sky = (1 - now.shadow_rgb_ratio) / moved.ambient_rgb_ratio
    assert sun_over_sky == pytest.approx(0.6 / 0.5 * now.to_light_marker[2] / 0.8)
    assert 1 - now.shadow_rgb_ratio + moved.ambient_rgb_ratio == pytest.approx(1)
    away = rigid(cv2.Rodrigues(np.radians([0.0, 80.0, 0.0]))[0], [0.0, 0.0, 0.1])
    (behind,) = moved_illumination(lit, away, PRINT).lights
    assert behind.to_light_marker[2] < 0
    assert behind.shadow_rgb_ratio == pytest.approx(1)


@pytest.mark.parametrize("is_measured", [True, False], ids=["intensity", "shadow"])
@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, -30.0])
def test_so_does_a_lamp_and_less_with_the_square_of_its_distance(tilt_deg: float, is_measured: bool) -> None:
    """By its intensity, over all other light at the marker, if that was measured, else by what its shadow has left."""
    over_sky = 1.5
    lamp = Light(
        np.array([0.6, 0.0, 0.8]),
        inverse_distance=0.5,
        shadow_rgb_ratio=np.full(3, 0.3 if is_measured else 1 / (1 + over_sky)),
        intensity_rgb_ratio=np.full(3, over_sky) if is_measured else None,
    )
    away = rigid(cv2.Rodrigues(np.radians([0.0, tilt_deg, 0.0]))[0], [0.3, 0.1, 0.0])
    moved = moved_illumination(Illumination((lamp,), np.full(3, 0.4)), away, PRINT)
    (now,) = moved.lights
    received = [each.to_light_marker[2] * each.inverse_distance**2 for each in (lamp, now)]
    expected = over_sky * received[1] / received[0]
    left = 1 / (1 + now.intensity_rgb_ratio) if is_measured else now.shadow_rgb_ratio
    assert 1 / left - 1 == pytest.approx(np.full(3, expected))
    assert (1 - left) / moved.ambient_rgb_ratio == pytest.approx(np.full(3, expected))


def test_beside_a_lamp_that_is_farther_the_sun_has_a_larger_share() -> None:
    """The lamp's intensity counts, and not the ambient light, which contradicts it."""
    sun = Light(np.array([0.0, 0.6, 0.8]), shadow_rgb_ratio=np.full(3, 0.7))
    lamp = Light(np.array([0.0, 0.0, 1.0]), inverse_distance=2.0, intensity_rgb_ratio=np.full(3, 1.0))
    before = Illumination((lamp, sun), np.full(3, 0.4))
    now, sun_now = moved_illumination(before, rigid(np.eye(3), [0.3, 0.0, 0.0]), PRINT).lights
    fallen = (1 + 0.6**2) ** -1.5  # the lamp's light, half a metre above, at 0.6 of that aside
    total = 0.2 + 0.3 + 0.5 * fallen
    assert 1 - 1 / (1 + now.intensity_rgb_ratio) == pytest.approx(np.full(3, 0.5 * fallen / total))
    assert 1 - sun_now.shadow_rgb_ratio == pytest.approx(np.full(3, 0.3 / total))


def test_a_lamp_is_as_large_as_it_is_seen_from_where_the_marker_lies() -> None:
    lamp = Light(np.array([0.0, 0.0, 1.0]), inverse_distance=2.0).with_angular_size(0.1)
    (moved,) = moved_illumination(Illumination((lamp,)), rigid(np.eye(3), [0.5, 0.0, 0.0]), PRINT).lights
    assert moved.radius_m == lamp.radius_m
    assert math.tan(moved.angular_size_rad / 2) == pytest.approx(lamp.radius_m / math.hypot(0.5, 0.5))
