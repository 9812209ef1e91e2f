"""A light's mirror image in the ground is found where it is, and nothing with an edge is taken for one."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import angle_between, project
from ashe_live.light.ground.glint import Glint, glint_in
from ashe_live.light.ground.lit_ground import fit_lit_ground
from ashe_live.light.ground.preset import GroundPreset
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import tracked_frame
from tests.light.synthetic_masks import camera_towards, direction

CAMERA = Camera.from_hfov((320, 240), 55.0)
T_CAM_MARKER = camera_towards((0.0, 0.0), 0.5, 45.0)
EYE = -T_CAM_MARKER[:3, :3].T @ T_CAM_MARKER[:3, 3]
OPPOSITE_DEG = float(np.degrees(np.arctan2(-EYE[1], -EYE[0])))  # azimuth of lights whose glint is straight ahead
ASIDE = direction(OPPOSITE_DEG - 10, 50)
GREY = 70.0
ACROSS, DOWN = np.meshgrid(np.arange(320.0), np.arange(240.0))


def mirror_px(to_light: Float) -> Float:
    """(2,) where a mirror on the marker's plane shows the light: at the image of the camera's own mirror image."""
    place = EYE + to_light * (1, 1, -1) * (EYE[2] / to_light[2])
    return np.asarray(project(CAMERA, T_CAM_MARKER, place[None])[0])


def picture(brightening: Float) -> Image:
    noise = np.random.default_rng(1).normal(0, 1.5, (240, 320))
    grey = np.clip((GREY + noise) * (1 + brightening), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def view_of(image: Image) -> View:
    return View.of(tracked_frame(image, CAMERA, T_CAM_MARKER), 320)


def found(image: Image) -> Glint | None:
    view = view_of(image)
    ground = fit_lit_ground(view.image_bgr, view.is_ground, GroundPreset())
    assert ground is not None
    return glint_in(view, ground)


def away_px(to_light: Float) -> Float:
    x, y = mirror_px(to_light)
    return np.asarray(np.hypot(ACROSS - x, DOWN - y))


@pytest.mark.parametrize(("aside_deg", "elevation_deg"), [(0, 40), (-15, 50), (20, 55), (-8, 35)])
def test_a_glint_shows_where_the_light_is(aside_deg: float, elevation_deg: float) -> None:
    to_light = direction(OPPOSITE_DEG + aside_deg, elevation_deg)
    away = away_px(to_light)
    image = picture(2.5 * np.exp(-0.5 * (away / 22) ** 2))
    glint = found(image)
    assert glint is not None
    assert np.degrees(angle_between(glint.to_light_marker, to_light)) < 1.5
    on_ground = EYE + to_light * (1, 1, -1) * (EYE[2] / to_light[2])
    np.testing.assert_allclose(glint.place_marker, on_ground[:2], atol=0.02)
    assert glint.halo[(away < 10) & view_of(image).is_ground].all()
    assert not glint.halo[away > 70].any()


def test_a_bright_object_is_none() -> None:
    assert found(picture(2.5 * (away_px(ASIDE) < 25))) is None


def test_a_faint_sheen_is_none() -> None:
    assert found(picture(0.2 * np.exp(-0.5 * (away_px(ASIDE) / 22) ** 2))) is None


def test_an_even_ground_has_none() -> None:
    assert found(picture(np.zeros((240, 320)))) is None


def test_a_soft_shadow_is_none() -> None:
    shadow = cv2.GaussianBlur((away_px(ASIDE) < 30).astype(np.float64), (0, 0), 8)
    assert found(picture(-0.7 * shadow)) is None
