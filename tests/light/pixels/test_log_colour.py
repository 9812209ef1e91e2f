"""Log-opponent colours: those of the picture, and a shadow is one shift of all."""

import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.light.pixels.log_colour import linear_rgb, log_opponent


def encoded(rgb: Float) -> Image:
    return np.round(255 * srgb_from_linear(rgb[..., ::-1])).astype(np.uint8)


def test_log_opponent_colours_are_those_of_the_picture() -> None:
    image = np.random.default_rng(1).integers(0, 256, (6, 8, 3)).astype(np.uint8)
    expected = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]]
    np.testing.assert_allclose(linear_rgb(log_opponent(image, smoothing_px=0)), expected, atol=1e-6)


def test_less_light_is_one_shift_of_every_colour() -> None:
    albedo = np.random.default_rng(1).uniform(0.3, 0.9, (6, 6, 3)).repeat(8, 0).repeat(8, 1)
    shift = log_opponent(encoded(albedo * [0.4, 0.5, 0.6]), 0) - log_opponent(encoded(albedo), 0)
    assert np.ptp(shift.reshape(-1, 3), axis=0).max() < 0.08
