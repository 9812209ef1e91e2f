"""How high the marker lies above the ground: by the ground's texture in painted pictures of known scenes."""

import math
from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, rigid
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.views import ground_height
from ashe_live.light.views.ground_height import height_above_ground, seen_from_ground, seen_from_marker
from tests.light.painted_scenes import BOX, Caster
from tests.light.painted_views import painted_from
from tests.light.synthetic_masks import direction

CARD_M = 0.004


@cache
def painted(heading_deg: float, casters: tuple[Caster, ...], ground: str) -> TrackedFrame:
    return painted_from(heading_deg, *casters, ground=ground, size=(640, 480)).tracked


def on_card(
    *headings_deg: float, card_m: float = 0.0, casters: tuple[Caster, ...] = (BOX,), ground: str = "bricks"
) -> list[TrackedFrame]:
    """Frames of a box on the ground, with poses of a marker that lies so far above it."""
    return [seen_from_ground(painted(heading, casters, ground), -card_m) for heading in headings_deg]


@pytest.mark.parametrize("card_m", [CARD_M, 0.007])
def test_texture_determines_how_far_the_ground_lies_below_the_marker(card_m: float) -> None:
    assert height_above_ground(on_card(90, 75, 105, card_m=card_m)) == pytest.approx(card_m, abs=5e-4)


@pytest.mark.parametrize("ground", ["plain", "bricks"])
@pytest.mark.parametrize("headings_deg", [(90, 75, 105), (90, 89), (90, 90), (90,)])
def test_a_sheet_that_lies_flat_is_not_said_to_be_on_card(headings_deg: tuple[float, ...], ground: str) -> None:
    assert height_above_ground(on_card(*headings_deg, ground=ground)) == 0


@pytest.mark.parametrize(("tilt_rad", "is_stated"), [(1e-4, True), (3e-3, False)])
def test_a_height_that_poses_may_feign_is_not_stated(tilt_rad: float, is_stated: bool) -> None:
    noise = np.diag([tilt_rad, tilt_rad, tilt_rad, 1e-5, 1e-5, 1e-5]) ** 2
    frames = [
        replace(each, marker=each.marker and replace(each.marker, noise_covariance=noise))
        for each in on_card(90, 75, 105, card_m=CARD_M)
    ]
    assert (height_above_ground(frames) > 0) == is_stated


def test_what_hardly_shows_is_not_stated() -> None:
    assert height_above_ground(on_card(90, 89.5, card_m=CARD_M)) == 0
    assert height_above_ground(on_card(90, 75, card_m=CARD_M, casters=(), ground="plain")) == 0


def test_the_answer_is_that_of_the_ground_and_its_body_stands_there() -> None:
    above, flat = (
        ProxyEstimator(FAST).estimate(first, others)
        for first, *others in (on_card(90, 60, 120, card_m=card_m) for card_m in (CARD_M, 0.0))
    )
    assert above.light is not None
    assert flat.light is not None
    assert math.degrees(angle_between(above.light.to_light_marker, flat.light.to_light_marker)) < 0.3
    body = above.illumination.real_object
    assert body is not None
    assert body.points_marker()[:, 2].min() == pytest.approx(-CARD_M, abs=5e-4)


def test_a_lamp_stays_where_it_is() -> None:
    at_m = np.array([0.2, -0.1, 0.3])  # from the ground below the marker's centre
    distance = float(np.linalg.norm(at_m))
    lamp = Light(at_m / distance, inverse_distance=1 / distance)
    sun = Light(direction(200, 40))
    body = Proxy("box", np.array([(0.1, 0.0, 0.05, 0.02, 0.0)]))
    seen = seen_from_marker(Illumination((lamp, sun), real_object=body), CARD_M)
    found, same = seen.lights
    np.testing.assert_allclose(found.to_light_marker / found.inverse_distance, at_m - (0, 0, CARD_M), atol=1e-12)
    np.testing.assert_allclose(same.to_light_marker, sun.to_light_marker)
    assert seen.real_object is not None
    assert seen.real_object.spheroids_marker[0, 2] == pytest.approx(0.05 - CARD_M)


def test_a_frame_without_a_marker_stays_as_it_is() -> None:
    frame = replace(on_card(90)[0], marker=None)
    assert seen_from_ground(frame, CARD_M) is frame


@pytest.mark.parametrize("off_deg", [0.0, -60.0, -70.0])
def test_heights_are_tried_in_steps_of_what_the_pictures_can_show(off_deg: float, monkeypatch) -> None:
    """Also where a pose is so wrong that ground lies on the other view's horizon, where any height moves it by any way.

    (Millions of heights took all memory.)
    """
    tried = []
    monkeypatch.setattr(ground_height, "_misfits", lambda *asked: tried.append(asked[-1]) or 0 * asked[-1])
    first, other = painted(90, (), "checkered"), painted(60, (), "checkered")
    off = rigid(cv2.Rodrigues(np.radians([0.0, off_deg, 0.0]))[0], np.zeros(3))
    wrong = replace(other.marker, T_cam_marker=off @ other.marker.T_cam_marker)
    height_above_ground([first, replace(other, marker=wrong)])
    diagonal_px = float(np.hypot(*first.camera.size))
    assert all(len(heights) <= diagonal_px / ground_height.STEP_PX + 2 for heights in tried)
