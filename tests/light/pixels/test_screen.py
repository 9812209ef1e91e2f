"""A device whose screen shows the marker is found with the shadow beside it, and nothing else is taken for one."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.page_lines import PageLines
from ashe_live.light.pixels.screen import screen_around
from ashe_live.light.pixels.sheet import ADDED, Sheet
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import SIDE_M, Caster, noise_frames, paint
from tests.light.synthetic_masks import camera_towards

ABOVE = camera_towards((0.0, 0.0), 0.6, 50.0)
PHONE, TABLET = (0.06, 0.1, 0.06, 0.1), (0.12, 0.09, 0.12, 0.09)  # right, above, left and below, metres
RIM_M, SHADOW_M = 0.006, 0.008


def seen_on(device: tuple[float, ...], ground: str = "plain", glare: float = 0.0) -> TrackedFrame:
    """A marker on a device with a black rim, whose shadow falls to the right; glare: of the rim on the left."""
    white = [end - RIM_M for end in device]
    tracked = paint(Caster("cylinder", at=(0.19, 0.0)), ground=ground, T_cam_marker=ABOVE, page_m=white).tracked
    right, above, left, below = device
    image = np.array(tracked.frame.image_bgr)
    painted = image.copy()
    for colour, ends in (
        (0.25, (right + SHADOW_M, above, -right, below)),
        (0.0, device),
        (glare, (-left + RIM_M, above, left, below)),
    ):
        area = _area(tracked, ends)
        painted[area] = colour * image[area]
    screen = _area(tracked, white)
    painted[screen] = image[screen]
    return replace(tracked, frame=replace(tracked.frame, image_bgr=painted))


def _area(tracked: TrackedFrame, ends: tuple[float, ...] | list[float]) -> Image:
    assert tracked.marker is not None
    outline = project(tracked.camera, tracked.marker.T_cam_marker, Sheet(*ends).corners(1.0))
    mask = np.zeros(np.asarray(tracked.frame.image_bgr).shape[:2], np.uint8)
    cv2.fillConvexPoly(mask, np.round(16 * outline).astype(np.int32), 1, shift=4)
    return mask > 0


def screen_in(tracked: TrackedFrame) -> Sheet | None:
    assert tracked.marker is not None
    return screen_around(PageLines.of(View.of(tracked, tracked.camera.size[0])))


def ends_of(sheet: Sheet) -> Float:
    return np.array([sheet.right, sheet.above, sheet.left, sheet.below]) * SIDE_M


@pytest.mark.parametrize("device", [PHONE, TABLET])
@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("glare", [0.0, 0.9])
def test_a_device_is_found_with_its_shadow(device: tuple[float, ...], ground: str, glare: float) -> None:
    screen = screen_in(seen_on(device, ground, glare))
    assert screen is not None
    true = np.array(device) + [SHADOW_M, 0, 0, 0] + ADDED * SIDE_M
    np.testing.assert_allclose(ends_of(screen), true, atol=RIM_M + 0.002)


def test_it_is_neither_ground_nor_a_page() -> None:
    tracked = seen_on(PHONE)
    view = View.of(tracked, 640).with_paper_as_ground()
    assert view.page is None
    assert not view.is_ground[_area(tracked, PHONE)].any()
    assert view.is_ground[~_area(tracked, [end + 0.02 for end in PHONE])].mean() > 0.99


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("margin_m", [0.01, 0.03, 0.08])
def test_paper_is_no_screen(ground: str, margin_m: float) -> None:
    beside = Caster(at=(0.11, 0.0), rgb=(0.01, 0.01, 0.01))
    scene = paint(beside, ground=ground, azimuth_deg=100, T_cam_marker=ABOVE, page_m=[SIDE_M / 2 + margin_m] * 4)
    assert screen_in(scene.tracked) is None


def test_what_is_dark_farther_out_is_no_rim() -> None:
    tracked = paint(T_cam_marker=ABOVE, page_m=[SIDE_M / 2 + 0.01] * 4).tracked
    image = np.array(tracked.frame.image_bgr)
    image[_area(tracked, [0.11] * 4) & ~_area(tracked, [0.09] * 4)] = 0
    assert screen_in(replace(tracked, frame=replace(tracked.frame, image_bgr=image))) is None


def test_noise_shows_no_screen() -> None:
    assert [screen_in(tracked) for tracked in noise_frames(20)] == [None] * 20
