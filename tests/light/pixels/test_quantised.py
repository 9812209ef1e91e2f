"""Quantised colours: as near as noise to the pixels' own, many fewer, and each pixel's value its colour's."""

import numpy as np
import pytest

from ashe_live.light.pixels.mixtures import COLOUR_NOISE, Quantised


def picture(shape: tuple[int, int], spread: float) -> np.ndarray:
    return np.random.default_rng(0).normal((-1, 0.3, -0.1), spread, (*shape, 3)).astype(np.float32)


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (40, 30)])
def test_colours_are_no_farther_than_the_noise_from_the_pixels_own(shape: tuple[int, int]) -> None:
    colours = picture(shape, 0.3)
    quantised = Quantised.of(colours)
    assert quantised.cell.shape == shape
    assert (np.abs(quantised.colours[quantised.cell] - colours) <= COLOUR_NOISE + 1e-5).all()


def test_each_colour_is_the_mean_of_its_pixels() -> None:
    colours = picture((40, 30), 0.05)
    quantised = Quantised.of(colours)
    assert len(quantised.colours) < 40 * 30 / 5
    for number, colour in enumerate(quantised.colours):
        np.testing.assert_allclose(colours[quantised.cell == number].mean(axis=0), colour, atol=1e-5)


def test_a_value_of_each_colour_is_pictured_where_the_colour_is() -> None:
    colours = picture((20, 30), 0.02)
    quantised = Quantised.of(colours)
    np.testing.assert_allclose(quantised.as_picture(quantised.colours[:, 0]), colours[..., 0], atol=COLOUR_NOISE[0])


@pytest.mark.parametrize("extreme", [0.0, -5.5, 1e3])
def test_a_picture_of_one_colour_has_one(extreme: float) -> None:
    quantised = Quantised.of(np.full((5, 7, 3), extreme, np.float32))
    np.testing.assert_array_equal(quantised.colours, np.full((1, 3), extreme, np.float32))
    assert not quantised.cell.any()
