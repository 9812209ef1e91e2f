"""How soft the real object's shadow is: painted borders whose blur is known."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.render.camera.shadow_border import unexplained_border_px
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.lighting import ShadingLight, lighting_of

FINE = 4
SIDE = 0.08
RATIO = 0.3
LENS_PX = 0.5
POST = Proxy("post", np.array([(0.1, 0.0, z, 0.02, 0.0) for z in (0.0, 0.05)]))


def _painted(stage, blur_px: float, ratio: float = RATIO, shift_m: float = 0.0, sun_deg: float = 0.01):
    """A frame with a marker and the post's shadow, by the places of a sun, blurred by a lens and the shadow by more.

    And that sun.
    """
    light = Light((0.5, 0.8, 1.0), angular_size_rad=math.radians(sun_deg), shadow_rgb_ratio=np.full(3, RATIO))
    (sun,) = lighting_of((light,)).lights
    T_cam_marker, camera = stage.pose(-80, 60, 0.5, target=(0, 0, 0)), stage.camera()

    def fill(ground: np.ndarray, value: float) -> np.ndarray:
        px = (project(camera, T_cam_marker, np.column_stack([ground, np.zeros(len(ground))])) + 0.5) * FINE - 0.5
        whole = np.ones((camera.size[1] * FINE, camera.size[0] * FINE), np.float32)
        return cv2.fillConvexPoly(whole, np.round(px * 16).astype(int), value, shift=4)

    def shadow(towards: np.ndarray) -> np.ndarray:
        cast = cast_by_point(POST.points_marker(), np.append(towards, 0.0)) + np.array((shift_m, 0.0))
        return fill(cv2.convexHull(cast.astype(np.float32)).reshape(-1, 2), ratio)

    soft = cv2.GaussianBlur(np.mean([shadow(each) for each in _disc(sun)], axis=0), (0, 0), FINE * max(blur_px, 0.05))
    linear = 0.6 * soft * fill(square_corners(SIDE)[:, :2], 0.05)
    linear = cv2.resize(cv2.GaussianBlur(linear, (0, 0), FINE * LENS_PX), camera.size, interpolation=cv2.INTER_AREA)
    grey = 255 * srgb_from_linear(linear) + np.random.default_rng(1).normal(0, 0.7, linear.shape)
    image = np.repeat(np.round(grey).astype(np.uint8)[..., None], 3, axis=2)
    corners = project(camera, T_cam_marker, square_corners(SIDE))
    marker = MarkerPose(T_cam_marker, corners, SIDE, 0.0, None)
    return TrackedFrame(Frame(image, 0, 0.0), camera, marker), sun


def _disc(sun: ShadingLight) -> np.ndarray:
    """(n, 3) unit directions to places spread evenly over the sun (Vogel's spiral)."""
    count = 60
    radius, turn = np.sqrt((np.arange(count) + 0.5) / count), np.arange(count) * math.pi * (3 - math.sqrt(5))
    right = np.cross(sun.to_light, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    aside = np.cos(turn)[:, None] * right + np.sin(turn)[:, None] * np.cross(right, sun.to_light)
    places = sun.to_light + sun.tan_half_size * radius[:, None] * aside
    return places / np.linalg.norm(places, axis=1)[:, None]


@pytest.mark.parametrize("shift_m", [0.0, 0.005])  # by which the outline that is known is off: five pixels
@pytest.mark.parametrize("blur_px", [0.7, 1.0])
def test_a_softer_border_is_measured_where_it_is(stage, blur_px: float, shift_m: float) -> None:
    tracked, sun = _painted(stage, blur_px, shift_m=shift_m)
    # The renderer's own shadows are as soft as a pixel.
    expected = math.sqrt(blur_px**2 - 1 / 12)
    assert unexplained_border_px(tracked, POST, sun) == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize("z", [0.0, -0.03])
def test_a_body_that_is_flat_or_below_the_ground_has_no_border(stage, z: float) -> None:
    """A picture with one ended in NumPy's words."""
    tracked, sun = _painted(stage, 1.0)
    assert unexplained_border_px(tracked, Proxy("flat", np.array([(0.1, 0.0, z, 0.02, 0.0)])), sun) == 0


def test_what_the_lens_blurs_is_explained(stage) -> None:
    tracked, sun = _painted(stage, 0.0)
    assert unexplained_border_px(tracked, POST, sun) < 0.3


@pytest.mark.parametrize("sun_deg", [1.0, 3.0, 6.0])
def test_what_a_wide_sun_blurs_is_explained(stage, sun_deg: float) -> None:
    """A disc's penumbra is less steep at its middle than a Gaussian's of the same variance."""
    tracked, sun = _painted(stage, 0.0, sun_deg=sun_deg)
    assert unexplained_border_px(tracked, POST, sun) < 0.4


def test_what_the_body_hides_of_the_sky_is_no_border(stage) -> None:
    """Dark ground at the foot on the lit side, as soft as it likes: under lamps that counted as the shadow's border."""
    tracked, sun = _painted(stage, 0.0)
    camera, T = tracked.camera, tracked.marker.T_cam_marker
    around = np.linspace(0, 2 * math.pi, 60)
    ring = np.column_stack([0.1 + 0.02 * np.cos(around), 0.02 * np.sin(around), np.zeros(60)])
    foot = np.zeros(tracked.frame.image_bgr.shape[:2], np.uint8)
    cv2.fillConvexPoly(foot, np.round(project(camera, T, ring) * 16).astype(int), 255, shift=4)
    left = 1 - (1 - RATIO) * cv2.GaussianBlur(foot / 255.0, (0, 0), 1.5)[..., None]
    linear = np.minimum(LINEAR_FROM_SRGB_8BIT[tracked.frame.image_bgr], 0.6 * left)
    image = np.round(255 * srgb_from_linear(linear)).astype(np.uint8)
    assert unexplained_border_px(replace(tracked, frame=Frame(image, 0, 0.0)), POST, sun) < 0.3


def test_a_border_of_something_else_is_none_of_the_shadows(stage) -> None:
    tracked, sun = _painted(stage, 1.0, ratio=0.75)  # a stain, which is not as dark
    assert unexplained_border_px(tracked, POST, sun) == 0.0
