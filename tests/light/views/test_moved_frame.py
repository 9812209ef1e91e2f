"""A light's covariance is of the frame that it is seen from: as finite differences say, on its own tangent basis."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised, rigid, tangent_basis
from ashe_live.core.types import Illumination, Light
from ashe_live.light.views.ground_height import seen_from_marker
from ashe_live.light.views.moved_frame import moved_light
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
