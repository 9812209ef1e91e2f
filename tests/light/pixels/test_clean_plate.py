"""A clean plate takes the ground's own pattern away, and leaves shadows and the object."""

import cv2
import numpy as np
import pytest

from ashe_live.core.colour import linear_from_srgb, srgb_from_linear
from ashe_live.light.pixels.clean_plate.plain_ground import exposure, log_ratio, over_plain_ground
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, paint

EDGE = np.ones((7, 7), np.uint8)  # about masks: pixels there mix two colours


def inside(mask):
    return cv2.erode(mask.astype(np.uint8), EDGE) > 0


def exposed(image, gains):
    """The picture with other gains (3,), BGR, of its linear light."""
    linear = linear_from_srgb(image / 255.0) * gains
    return np.round(255 * srgb_from_linear(np.clip(linear, 0, 1))).astype(np.uint8)


@pytest.mark.parametrize("ground", GROUNDS)
def test_ground_becomes_plain_and_a_shadow_keeps_the_light_that_it_lacks(ground) -> None:
    scene, empty = paint(BOX, ground=ground, seed=1), paint(ground=ground, seed=2)
    shown = over_plain_ground(np.asarray(scene.tracked.frame.image_bgr), np.asarray(empty.tracked.frame.image_bgr))
    assert shown.dtype == np.uint8
    linear = linear_from_srgb(shown / 255.0)
    lit = inside(~(scene.body | scene.shadow))
    # The printed sheet is a part of what becomes plain.
    spread = np.percentile(linear[lit], [5, 95], axis=0)
    assert (spread[1] / spread[0] < 1.25).all()
    ratio = np.median(linear[inside(scene.shadow)], axis=0) / np.median(linear[lit], axis=0)
    np.testing.assert_allclose(ratio[::-1], SHADOW_RATIO, rtol=0.1)


def test_exposure_and_white_balance_of_the_two_pictures_may_differ() -> None:
    scene, empty = paint(BOX, CYLINDER, ground="bricks", seed=1), paint(ground="bricks", seed=2)
    gains = np.array([0.8, 0.7, 0.6])
    darker = exposed(np.asarray(scene.tracked.frame.image_bgr), gains)
    ratio = log_ratio(darker, np.asarray(empty.tracked.frame.image_bgr))
    np.testing.assert_allclose(exposure(ratio.reshape(-1, 3)), np.log(gains), atol=0.03)


@pytest.mark.parametrize("gain", [0.5, 0.6, 1.8, 2.5])
def test_what_one_picture_saturates_is_not_taken_for_changed(gain) -> None:
    """White paper on the table, and a camera that exposes the pictures differently."""
    scene, empty = paint(BOX, ground="bricks", seed=1), paint(ground="bricks", seed=2)
    pictures = []
    for painted, own in ((scene, gain), (empty, 1.0)):
        image = np.array(painted.tracked.frame.image_bgr)
        image[60:160, 40:200] = 231  # beside the box and its shadow
        pictures.append(exposed(image, np.full(3, own)))
    shown = over_plain_ground(*pictures)
    ground = np.median(shown[inside(~(scene.body | scene.shadow))], axis=0)
    np.testing.assert_allclose(np.median(shown[70:150, 50:190], axis=(0, 1)), ground, atol=4)


@pytest.mark.parametrize(("now", "before"), [(0, 0), (255, 255), (0, 255), (255, 0)])
def test_black_and_saturated_pictures_give_a_picture(now, before) -> None:
    shape = (30, 40, 3)
    shown = over_plain_ground(np.full(shape, now, np.uint8), np.full(shape, before, np.uint8))
    assert shown.shape == shape
    assert len(np.unique(shown.reshape(-1, 3), axis=0)) == 1
