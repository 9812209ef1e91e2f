"""The strips of shadow beside a sheet tell the light's azimuth; what lies on all sides, or on none, tells nothing."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.ground.sheet_shadow import OTHERS, SheetShadow, sheet_shadow_in
from ashe_live.light.pixels.view import View
from tests.light.synthetic_masks import camera_towards, direction

CAMERA = Camera.from_hfov((640, 480), 55.0)
SIDE_M = 0.08
T_CAM_MARKER = camera_towards((0.02, 0.01), 0.5, 50.0)
PX_PER_SIDE = 240
HALF = 3 * PX_PER_SIDE  # of the painted ground
SHEET, PAPER, INK, GROUND = 0.68, 0.75, 0.02, 0.3  # half a sheet's side in markers' sides; linear
LOST = 0.7  # share of the light that a shadow lacks
HEIGHT = 0.04  # of the sheet over the ground, markers' sides


def rectangle(plane: Image, half: float, value: float, moved: tuple[float, float] = (0.0, 0.0)) -> None:
    x, y = HALF + moved[0] * PX_PER_SIDE, HALF - moved[1] * PX_PER_SIDE
    a, b = (round(each - half * PX_PER_SIDE) for each in (x, y))
    c, d = (round(each + half * PX_PER_SIDE) for each in (x, y))
    plane[b:d, a:c] = value


def view(azimuth_deg: float | None, ground: float = GROUND, halo: float = 0.0, seed: int = 0) -> View:
    """A sheet of which a light 45° high throws a shadow; with a dark halo as wide as the shadow around it."""
    plane = np.full((2 * HALF, 2 * HALF), ground)
    if halo:
        rectangle(plane, SHEET + HEIGHT, ground * (1 - halo))
    if azimuth_deg is not None:
        a = math.radians(azimuth_deg)
        rectangle(plane, SHEET, ground * (1 - LOST), (-HEIGHT * math.cos(a), -HEIGHT * math.sin(a)))
    rectangle(plane, SHEET, PAPER)
    rectangle(plane, 0.5, INK)
    scale = PX_PER_SIDE / SIDE_M
    plane_from_marker = np.array([(scale, 0, HALF - 0.5), (0, -scale, HALF - 0.5), (0, 0, 1)])
    image_from_plane = CAMERA.K @ T_CAM_MARKER[:3, [0, 1, 3]] @ np.linalg.inv(plane_from_marker)
    plane = cv2.GaussianBlur(plane, (0, 0), 1.0)
    linear = cv2.warpPerspective(plane, image_from_plane, CAMERA.size, flags=cv2.INTER_LINEAR, borderValue=ground)
    linear = cv2.GaussianBlur(linear, (0, 0), 0.8)
    noisy = linear * (1 + np.random.default_rng(seed).normal(0, 0.03, linear.shape))
    encoded = np.where(noisy <= 0.0031308, 12.92 * noisy, 1.055 * np.maximum(noisy, 0) ** (1 / 2.4) - 0.055)
    picture = np.repeat((255 * encoded).clip(0, 255).astype(np.uint8)[..., None], 3, axis=2)
    marker = MarkerPose(T_CAM_MARKER, np.zeros((4, 2)), SIDE_M, 0.1, None)
    return View.of(TrackedFrame(Frame(picture, 0, 0.0), CAMERA, marker), CAMERA.size[0])


def found(view: View) -> SheetShadow:
    shadow = sheet_shadow_in(view)
    assert shadow is not None
    return shadow


def cosine(shadow: SheetShadow, azimuth_deg: float) -> float:
    """Between where the shadow points and away from the light."""
    away = -direction(azimuth_deg, 0.0)[:2]
    return float(away @ shadow.away / np.hypot(*shadow.away))


@pytest.mark.parametrize("ground", [0.08, 0.3, 0.7])
@pytest.mark.parametrize("azimuth_deg", [0.0, 37.0, 120.0, 205.0, 290.0])
def test_the_shadow_points_away_from_the_light(azimuth_deg: float, ground: float) -> None:
    shadow = found(view(azimuth_deg, ground))
    assert shadow.clear > 0.5
    assert cosine(shadow, azimuth_deg) > 0.9
    every = [shadow.log_odds(direction(azimuth_deg + turned, 45.0)) for turned in range(0, 360, 30)]
    assert max(every[0], every[1], every[-1]) == max(every) > 0.5
    assert math.log(OTHERS) < min(every) < -1
    assert np.mean(np.exp(every)) == pytest.approx(1.0, abs=0.01)  # as a likelihood over azimuths has it


def test_it_is_as_wide_and_as_dark_as_it_is() -> None:
    assert np.hypot(*found(view(0.0)).away) == pytest.approx(LOST * HEIGHT, rel=0.2)


@pytest.mark.parametrize("halo", [0.0, 0.3, 0.6])
def test_what_lies_on_all_sides_is_no_shadow(halo: float) -> None:
    assert found(view(None, halo=halo)).clear < 0.1


def test_a_halo_does_not_hide_the_shadow() -> None:
    shadow = found(view(120.0, halo=0.3))
    assert cosine(shadow, 120.0) > 0.9
    assert shadow.clear > 0.4


def test_a_light_overhead_has_no_azimuth() -> None:
    assert SheetShadow(np.array([0.1, 0.0]), 1.0).log_odds(np.array([0.0, 0.0, 1.0])) == 0.0
    assert SheetShadow(np.zeros(2), 0.0).log_odds(direction(10.0, 45.0)) == 0.0


def test_other_edges_than_a_sheets_are_no_evidence() -> None:
    body = Proxy("box", np.array([[0.0, 0.0, 0.02, 0.02, 0.02]]))
    on_body = view(0.0)
    assert sheet_shadow_in(replace(on_body, body=body)) is None


def test_a_picture_without_edges_is_none() -> None:
    blank = view(0.0)
    black = replace(blank, image_bgr=np.zeros_like(blank.image_bgr))
    assert sheet_shadow_in(black) is None
