"""A light's covariance is of the frame that it is seen from: as finite differences say, on its own tangent basis."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import inverse_rigid, normalised, rigid, tangent_basis
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.views.ground_height import seen_from_marker
from ashe_live.light.views.moved_frame import moved_light, with_moved_marker
from tests.light.painted_scenes import direction

RAISED = rigid(np.eye(3), [0.0, 0.0, -0.02])  # T_new_old
TILTED = rigid(cv2.Rodrigues(np.radians([20.0, -10.0, 30.0]))[0], [0.03, -0.02, 0.05])
STEP = 1e-6


def lamp(covariance: Float | None = None) -> Light:
    """60 cm from the marker's centre; covariance: (3, 3)."""
    of_direction = None if covariance is None else covariance[:2, :2]
    return Light(direction(200, 35), of_direction, inverse_distance=1 / 0.6, lamp_covariance=covariance)


def displaced(light: Light, by: Float) -> Light:
    """by: (3,) along the tangent basis, and of the inverse distance."""
    to_light = normalised(light.to_light_marker + by[:2] @ tangent_basis(light.to_light_marker))
    return replace(light, to_light_marker=to_light, inverse_distance=light.inverse_distance + by[2])


def slope_by_differences(light: Light, T_new_old: Float) -> Float:
    """(3, 3) of what `displaced` displaces, by the new frame by the old one's."""
    basis = tangent_basis(moved_light(light, T_new_old).to_light_marker)
    columns = []
    for by in STEP * np.eye(3):
        ahead, behind = (moved_light(displaced(light, sign * by), T_new_old) for sign in (1, -1))
        turned = basis @ (ahead.to_light_marker - behind.to_light_marker)
        columns.append([*turned, ahead.inverse_distance - behind.inverse_distance])
    return np.array(columns).T / (2 * STEP)


COVARIANCE = np.array([[4e-3, 1e-3, 2e-3], [1e-3, 2e-3, -1e-2], [2e-3, -1e-2, 0.2]])


@pytest.mark.parametrize("motion", [RAISED, TILTED], ids=["raised", "tilted"])
def test_a_lamp_is_as_uncertain_as_it_is_seen_from_there(motion: Float) -> None:
    slope = slope_by_differences(lamp(), motion)
    moved = moved_light(lamp(COVARIANCE), motion)
    np.testing.assert_allclose(moved.lamp_covariance, slope @ COVARIANCE @ slope.T, rtol=1e-6)
    np.testing.assert_allclose(moved.covariance_rad2, moved.lamp_covariance[:2, :2])
    at_known_distance = moved_light(replace(lamp(COVARIANCE), lamp_covariance=None), motion)
    of_direction = slope[:2, :2] @ COVARIANCE[:2, :2] @ slope[:2, :2].T
    np.testing.assert_allclose(at_known_distance.covariance_rad2, of_direction, rtol=1e-6)


def test_a_lamp_found_from_the_ground_is_as_uncertain_as_it_is_from_the_marker_above() -> None:
    (seen,) = seen_from_marker(Illumination((lamp(COVARIANCE),)), 0.02).lights
    slope = slope_by_differences(lamp(), RAISED)
    np.testing.assert_allclose(seen.lamp_covariance, slope @ COVARIANCE @ slope.T, rtol=1e-6)


def test_a_pose_by_a_moved_frame_is_as_uncertain_as_it_is_there() -> None:
    """By pairs of poses that are off by a small turn and shift: the old frame's, and with it the new one's."""
    T_cam_old = rigid(cv2.Rodrigues(np.radians([130.0, 5.0, 20.0]))[0], [0.05, 0.02, 0.6])
    T_new_old = rigid(cv2.Rodrigues(np.radians([0.0, 0.0, 70.0]))[0], [0.2, -0.1, 0.0])
    spread = np.random.default_rng(1).normal(size=(6, 6)) * ([[2e-3]] * 3 + [[5e-4]] * 3)
    covariance, noise = spread @ spread.T, 0.1 * spread[:, :3] @ spread[:, :3].T
    marker = MarkerPose(T_cam_old, np.zeros((4, 2)), 0.08, 0.0, None, covariance, noise)
    camera = Camera.from_hfov((64, 48), 60)
    moved = with_moved_marker(TrackedFrame(Frame(np.zeros((48, 64, 3), np.uint8), 0, 0.0), camera, marker), T_new_old)
    assert moved.marker is not None
    T_cam_new = moved.marker.T_cam_marker
    columns, step = [], 1e-3  # OpenCV takes less than 1e-5 for no turn
    for w, v in ((by[:3], by[3:]) for by in step * np.eye(6)):
        off = rigid(cv2.Rodrigues(w)[0] @ T_cam_old[:3, :3], T_cam_old[:3, 3] + v) @ inverse_rigid(T_new_old)
        turned = cv2.Rodrigues(off[:3, :3] @ T_cam_new[:3, :3].T)[0].ravel()
        columns.append([*turned, *(off[:3, 3] - T_cam_new[:3, 3])])
    slope = np.array(columns).T / step
    for found, before in ((moved.marker.covariance, covariance), (moved.marker.noise_covariance, noise)):
        expected = slope @ before @ slope.T
        sigmas = np.sqrt(np.diag(expected))
        np.testing.assert_allclose(found / np.outer(sigmas, sigmas), expected / np.outer(sigmas, sigmas), atol=1e-3)
