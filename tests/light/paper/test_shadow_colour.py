"""The measured ratio of shadowed to lit ground."""

import numpy as np

from ashe_live.core.colour import srgb_from_linear
from ashe_live.light.paper.shadow_colour import shadow_rgb_ratio

SHAPE = (240, 320)


def picture(lit_rgb, ratio_rgb):
    shadow = np.zeros(SHAPE, bool)
    shadow[100:160, 120:220] = True
    linear = np.where(shadow[..., None], np.multiply(lit_rgb, ratio_rgb), lit_rgb)
    return np.round(255 * srgb_from_linear(linear[..., ::-1])).astype(np.uint8), shadow


def test_it_is_the_ratio_in_linear_light_and_in_rgb_order():
    image, shadow = picture((0.6, 0.5, 0.4), (0.2, 0.3, 0.45))
    ratio = shadow_rgb_ratio(image, shadow, np.zeros(SHAPE, bool))
    np.testing.assert_allclose(ratio, (0.2, 0.3, 0.45), atol=0.01)


def test_what_is_not_ground_does_not_count():
    image, shadow = picture((0.6, 0.5, 0.4), (0.3, 0.3, 0.3))
    thing = np.zeros(SHAPE, bool)
    thing[40:110, 120:220] = True
    image[thing] = (0, 0, 255)
    np.testing.assert_allclose(shadow_rgb_ratio(image, shadow, thing), 0.3, atol=0.01)


def test_a_bright_patch_is_no_shadow():
    image, shadow = picture((0.2, 0.2, 0.2), (2.0, 2.0, 2.0))
    assert shadow_rgb_ratio(image, shadow, np.zeros(SHAPE, bool)) is None


def test_without_pixels_there_is_no_ratio():
    image, shadow = picture((0.6, 0.5, 0.4), (0.3, 0.3, 0.3))
    nothing = np.zeros(SHAPE, bool)
    assert shadow_rgb_ratio(image, nothing, nothing) is None
    assert shadow_rgb_ratio(image, shadow, ~shadow) is None
