"""Across the real object's outline the picture is what a camera would show of object, shadow and model."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Illumination
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.scene import Scene
from tests.render.camera.test_video_look import _sheet

FINE = 8
BLACK = (0.0, 0.0, 0.0, 1.0)
CORNERS = [(x, y, z) for x in (-0.105, -0.08) for y in (-0.032, -0.008) for z in (0.0, 0.05)]
POST = Proxy("box", np.array([(*corner, 0.0, 0.0) for corner in CORNERS]))
SHADOW = "shadow"
MODEL = "model"


def _levels_off(
    make_renderer, stage, preset: RenderPreset, behind: str, level: float, blur: float, off_px: float
) -> np.ndarray:
    """Signed levels by which the picture is too bright beside the outline of an object of that linear brightness.

    The object in the video is `off_px` to the right of its proxy.
    """
    bare = _sheet(stage, blur=blur)
    camera, T_cam_marker = bare.camera, bare.marker.T_cam_marker
    outline = cv2.convexHull((project(camera, T_cam_marker, CORNERS) + np.array([off_px, 0.0])).astype(np.float32))
    fine = np.zeros((FINE * camera.size[1], FINE * camera.size[0]))
    cv2.fillConvexPoly(fine, np.round(((outline + 0.5) * FINE - 0.5) * 16).astype(int), 1.0, shift=4)
    covered = cv2.GaussianBlur(cv2.resize(fine, camera.size, interpolation=cv2.INTER_AREA), (0, 0), blur)

    def with_object(image: np.ndarray) -> np.ndarray:
        linear = LINEAR_FROM_SRGB_8BIT[image[..., 1]]
        return 255 * srgb_from_linear(linear + covered * (level - linear))

    # In light from -x: a model whose shadow, or which itself, is behind the object in the picture.
    model = box((0.02, 0.12, 0.06), BLACK).moved(1.0, np.array([-0.125, 0.06, 0.0]))
    if behind == MODEL:
        model = stage.glowing_green(box((0.08, 0.01, 0.06)).moved(1.0, np.array([-0.09, 0.04, 0.0])))
    placed = stage.placed(model)
    light = stage.light(180, 30, (0.3, 0.3, 0.3))
    renderer = make_renderer(replace(preset, matches_noise=False))
    alone = stage.picture(renderer, Scene(bare, placed, Illumination((light,))))
    grey = np.repeat(with_object(bare.frame.image_bgr)[..., None], 3, axis=2)
    video = replace(bare, frame=replace(bare.frame, image_bgr=np.round(grey).astype(np.uint8)))
    picture = stage.picture(renderer, Scene(video, placed, Illumination((light,), real_object=POST)))
    # Where what is behind the object is even, and changed.
    window = np.ones((9, 9))
    even = cv2.dilate(alone[..., 1], window).astype(int) - cv2.erode(alone[..., 1], window) <= 3
    changed = np.abs(alone[..., 1].astype(int) - bare.frame.image_bgr[..., 1]) > 20
    at_outline = cv2.dilate(covered, window) - cv2.erode(covered, window) > 0.05
    looked_at = even & changed & at_outline
    assert looked_at.sum() > 150
    return (picture[..., 1] - with_object(alone))[looked_at]


@pytest.mark.parametrize("behind", [SHADOW, MODEL])
@pytest.mark.parametrize("level", [0.01, 0.06, 0.7])
@pytest.mark.parametrize("blur", [0.3, 0.6])
def test_there_is_no_line_along_an_object_before_a_shadow_or_a_model(
    make_renderer, stage, behind: str, level: float, blur: float
) -> None:
    """Blurred as if the object were as bright as the ground, dark ones have lines up to 50 levels brighter there."""
    off = _levels_off(make_renderer, stage, BALANCED.render, behind, level, blur, 0.0)
    assert np.sqrt(np.mean(off**2)) < 2.8
    assert np.percentile(np.abs(off), 95) < 5


@pytest.mark.parametrize("behind", [SHADOW, MODEL])
@pytest.mark.parametrize("off_px", [-1.0, 1.0])
def test_there_is_no_sliver_beside_an_object_whose_outline_is_a_pixel_off(
    make_renderer, stage, behind: str, off_px: float
) -> None:
    off = _levels_off(make_renderer, stage, BALANCED.render, behind, 0.03, 0.6, off_px)
    assert np.sqrt(np.mean(off**2)) < 3
    assert np.percentile(np.abs(off), 99) < 10


def test_an_object_as_bright_as_the_ground_has_the_outline_that_is_drawn(make_renderer, stage) -> None:
    """Its outline cannot be told in the video: the picture is as good as without looking for it."""
    matched, drawn = (
        _levels_off(make_renderer, stage, replace(BALANCED.render, matches_outline=matches), SHADOW, 0.22, 0.6, 0.0)
        for matches in (True, False)
    )
    assert np.sqrt(np.mean(matched**2)) < 1.05 * np.sqrt(np.mean(drawn**2))
