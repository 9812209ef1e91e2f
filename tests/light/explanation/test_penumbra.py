"""The light's angular size, from penumbrae made by averaging the shadows of a disc of lights."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, project, rigid, tangent_basis
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.edges.shadow_edge import _blur_per_height
from ashe_live.light.explanation.penumbra import angular_size, soft_size
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.light_points import at_infinity, cast_on_ground, towards
from ashe_live.light.shape.predicted import predicted
from tests.light.synthetic_masks import camera_towards

SIZE = (320, 240)
PROXY = Proxy("frustum", np.array([[0.05, 0.0, 0.0, 0.03, 0.0], [0.05, 0.0, 0.12, 0.025, 0.0]]))
TO_LIGHT = direction_from_angles(math.radians(150), math.radians(40))
SUN, LAMP = at_infinity(TO_LIGHT), np.append(0.5 * TO_LIGHT, 1.0)


def view() -> View:
    camera = Camera.from_hfov(SIZE, 50)
    everywhere = np.ones(SIZE[::-1], np.bool_)
    picture = np.zeros((*SIZE[::-1], 3), np.uint8)
    return View(picture, camera, camera_towards((0.1, 0.0), 0.5, 50.0), 0.08, everywhere)


def share_of(diameter_rad: float, blur_px: float, light: Float = SUN, lights: int = 250) -> Float:
    """(h, w): how much of the disc of lights the body hides from the ground, evenly spread by Vogel's spiral.

    The disc has that diameter seen from the marker's centre.
    """
    here = view()
    turn = np.arange(lights) * math.pi * (3 - math.sqrt(5))
    radius = 0.5 * diameter_rad * np.sqrt((np.arange(lights) + 0.5) / lights)
    east, up = tangent_basis(TO_LIGHT)
    total = np.zeros(SIZE[::-1])
    for angle, away in zip(turn, radius, strict=True):
        aside = away * np.linalg.norm(light[:3]) * (math.cos(angle) * east + math.sin(angle) * up)
        total += predicted(PROXY, (light + np.append(aside, 0))[None], here).shadow
    return cv2.GaussianBlur((total / lights).astype(np.float32), (0, 0), blur_px)


def size_of(share: Float, light: Float = SUN) -> float | None:
    here = view()
    return angular_size(PROXY, light, share, predicted(PROXY, light[None], here), here)


@pytest.mark.parametrize("blur_px", [0.7, 1.2])
@pytest.mark.parametrize("diameter_deg", [3.0, 5.0, 6.5])
def test_a_large_light_is_as_large_as_it_is(diameter_deg: float, blur_px: float) -> None:
    found = size_of(share_of(math.radians(diameter_deg), blur_px))
    assert found is not None
    assert math.degrees(found) == pytest.approx(diameter_deg, rel=0.2)


@pytest.mark.parametrize("diameter_deg", [3.0, 5.0])
def test_a_near_lamp_is_as_large_as_it_is_seen_from_the_markers_centre(diameter_deg: float) -> None:
    found = size_of(share_of(math.radians(diameter_deg), 0.7, LAMP), LAMP)
    assert found is not None
    assert math.degrees(found) == pytest.approx(diameter_deg, rel=0.2)


def test_a_lamp_far_away_is_a_sun() -> None:
    share = share_of(math.radians(5.0), 0.7)
    assert size_of(share, np.append(1e6 * TO_LIGHT, 1.0)) == pytest.approx(size_of(share), rel=1e-3)


def test_an_edge_from_one_height_does_not_tell_penumbra_from_blur() -> None:
    """Of a box straight below the camera, where only the far edge of the top casts what is seen."""
    foot = (0.0, -0.06), (0.02, -0.06), (0.02, 0.06), (0.0, 0.06)
    corners = [(x, y, z, 0.0, 0.0) for z in (0.0, 0.06) for x, y in foot]
    box, light = Proxy("box", np.array(corners)), at_infinity(direction_from_angles(math.pi, math.radians(50)))
    straight_down = rigid(np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 0.5))
    here = replace(view(), T_cam_marker=straight_down)
    masks = predicted(box, light[None], here)
    (x, y), *_ = project(here.camera, straight_down, np.array([[0.02 + 0.06 / math.tan(math.radians(50)), 0.0, 0.0]]))
    is_ground = np.zeros_like(here.is_ground)
    is_ground[round(y) - 25 : round(y) + 26, round(x) - 15 : round(x) + 16] = True
    lost = cv2.GaussianBlur(masks.shadow.astype(np.float32), (0, 0), 3.0)
    lost += np.random.default_rng(0).normal(0, 0.01, lost.shape).astype(np.float32)
    assert angular_size(box, light, lost, masks, replace(here, is_ground=is_ground)) is None


@pytest.mark.parametrize("light", [SUN, LAMP], ids=["sun", "lamp"])
def test_shadows_move_with_the_light_as_they_are_cast(light: Float) -> None:
    """By central differences of where the points' shadows fall."""
    points, angles = PROXY.points_marker(8)[8:], np.arange(8)
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    expected = []
    for point, normal in zip(points, normals, strict=True):
        moved = []
        for axis in tangent_basis(towards(light, point)):
            step = 1e-5 * np.linalg.norm(light[:3]) * np.append(axis, 0)
            ahead, behind = (cast_on_ground(point[None], light + each) for each in (step, -step))
            assert ahead is not None
            assert behind is not None
            moved.append((ahead - behind)[0, :2] @ normal / 2e-5)
        expected.append(math.hypot(*moved))
    np.testing.assert_allclose(points[:, 2] * _blur_per_height(light, points, normals), expected, rtol=1e-3)


@pytest.mark.parametrize("times", [0.25, 4.0])
def test_a_world_so_many_times_as_large_looks_the_same_and_has_a_light_of_the_same_size(times: float) -> None:
    spheroids = times * np.asarray(PROXY.spheroids_marker)

    def larger(T_cam_marker: Float) -> Float:
        return rigid(T_cam_marker[:3, :3], times * T_cam_marker[:3, 3])

    here, share, photo = view(), share_of(math.radians(5.0), 0.7), photo_of(5.0, 0.6)
    there = replace(here, T_cam_marker=larger(here.T_cam_marker), side_m=times * here.side_m)
    found = angular_size(Proxy("frustum", spheroids), SUN, share, predicted(PROXY, SUN[None], here), there)
    assert found == pytest.approx(size_of(share), rel=1e-3)
    marker = replace(photo.marker, T_cam_marker=there.T_cam_marker, side_m=times * photo.marker.side_m)
    found = soft_size(Proxy("frustum", spheroids), SUN, replace(photo, marker=marker))
    assert found == pytest.approx(soft_size(PROXY, SUN, photo), rel=1e-3)


@pytest.mark.parametrize("blur_px", [0.7, 1.2, 2.0])
def test_a_small_one_is_not_distinguished_from_blur(blur_px: float) -> None:
    assert size_of(share_of(math.radians(0.5), blur_px)) is None


@pytest.mark.parametrize("share", [np.zeros, np.ones])
def test_without_an_edge_there_is_no_size(share) -> None:
    assert size_of(share(SIZE[::-1], np.float32)) is None


def photo_of(diameter_deg: float, blur_px: float) -> TrackedFrame:
    """The shadow on even ground, with a printed marker in view, as a camera with that blur takes it."""
    here = view()
    share = share_of(math.radians(diameter_deg), 0.01)
    linear = 0.45 * (1 - 0.7 * share)
    square = np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)], float)
    middle = np.array((0.05, -0.12, 0.0))
    for half, value in ((0.03, 0.75), (0.02, 0.03)):
        corners = project(here.camera, here.T_cam_marker, middle + half * square)
        mask = np.zeros(SIZE[::-1], np.uint8)
        cv2.fillConvexPoly(mask, np.round(corners * 16).astype(int), 255, cv2.LINE_AA, 4)
        linear += (value - linear) * (mask / 255)
    encoded = 255 * srgb_from_linear(cv2.GaussianBlur(linear, (0, 0), blur_px))
    image = np.repeat(np.round(encoded).astype(np.uint8)[..., None], 3, axis=2)
    corners = project(here.camera, here.T_cam_marker, middle + 0.02 * square)
    return TrackedFrame(Frame(image, 0, 0.0), here.camera, MarkerPose(here.T_cam_marker, corners, 0.04, 0.0, None))


@pytest.mark.parametrize("blur_px", [0.6, 1.0])
@pytest.mark.parametrize("diameter_deg", [3.0, 5.0, 7.0])
def test_a_soft_lights_size_is_estimated_by_the_width_of_its_shadows_border(
    diameter_deg: float, blur_px: float
) -> None:
    found = soft_size(PROXY, SUN, photo_of(diameter_deg, blur_px))
    assert found is not None
    assert math.degrees(found) == pytest.approx(diameter_deg, rel=0.25)


def turned_away(photo: TrackedFrame, angle_rad: float) -> TrackedFrame:
    """As a camera with the same centre and a wider picture sees it that is turned away to the side."""
    camera = Camera.from_focal((640, 240), photo.camera.K[0, 0])
    turn = rigid(cv2.Rodrigues(np.array([0.0, angle_rad, 0.0]))[0], np.zeros(3))
    H = camera.K @ turn[:3, :3] @ np.linalg.inv(photo.camera.K)
    image = cv2.warpPerspective(np.asarray(photo.frame.image_bgr), H, camera.size, flags=cv2.INTER_CUBIC)
    corners = np.column_stack([photo.marker.corners_px, np.ones(4)]) @ H.T
    marker = replace(
        photo.marker, T_cam_marker=turn @ photo.marker.T_cam_marker, corners_px=corners[:, :2] / corners[:, 2:]
    )
    return TrackedFrame(Frame(np.asarray(image, np.uint8), 0, 0.0), camera, marker)


@pytest.mark.parametrize("k1", [-0.3, 0.2])
def test_a_lens_that_bends_the_border_changes_no_size(k1: float) -> None:
    straight = turned_away(photo_of(5.0, 0.8), math.radians(30))
    K, dist, (width, height) = straight.camera.K, np.array([k1, 0.0, 0.0, 0.0, 0.0]), straight.camera.size
    places = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).reshape(-1, 1, 2).astype(np.float64)
    at = cv2.undistortPoints(places, K, dist, P=K).reshape(height, width, 2).astype(np.float32)
    bent = cv2.remap(np.asarray(straight.frame.image_bgr), at, None, cv2.INTER_LINEAR)
    rays = np.column_stack([straight.marker.corners_px, np.ones(4)]) @ np.linalg.inv(K).T
    corners, _ = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), K, dist)
    marker = replace(straight.marker, corners_px=corners[:, 0])
    photo = TrackedFrame(Frame(bent, 0, 0.0), replace(straight.camera, dist=dist), marker)
    assert soft_size(PROXY, SUN, photo) == pytest.approx(soft_size(PROXY, SUN, straight), rel=0.05)


@pytest.mark.parametrize("blur_px", [0.6, 1.0, 1.6])
def test_a_bare_sun_is_not_soft(blur_px: float) -> None:
    assert soft_size(PROXY, SUN, photo_of(0.53, blur_px)) is None


def test_a_picture_without_a_shadow_has_no_soft_light() -> None:
    photo = photo_of(5.0, 0.6)
    even = Frame(np.full_like(photo.frame.image_bgr, 150), 0, 0.0)
    assert soft_size(PROXY, SUN, TrackedFrame(even, photo.camera, photo.marker)) is None
