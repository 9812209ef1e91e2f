"""Surfaces of the ground: what a step of light divides, but no joint, no texture, and not a lamp's fall."""

import numpy as np
import pytest

from ashe_live.core.arrays import Image, Mask
from ashe_live.light.ground.surfaces import surfaces

SHAPE = (150, 200)
EVERYWHERE: Mask = np.ones(SHAPE, np.bool_)
SEED = 7


def table(left: int = 150, right: int = 150, noise: float = 3) -> Image:
    values = np.full((*SHAPE, 3), left, np.float64)
    values[:, 120:] = right
    return (values + np.random.default_rng(SEED).normal(size=values.shape) * noise).clip(0, 255).astype(np.uint8)


def test_a_plain_ground_is_one_surface() -> None:
    assert (surfaces(table(), EVERYWHERE) == 1).mean() > 0.99


@pytest.mark.parametrize("right", [70, 110, 220])
def test_what_lies_behind_a_tables_end_is_another_and_the_larger_one_is_the_first(right: int) -> None:
    found = surfaces(table(right=right), EVERYWHERE)
    assert (found[:, :115] == 1).mean() > 0.98
    assert (found[:, 125:] == 2).mean() > 0.98


def test_a_joint_divides_nothing() -> None:
    tiles = table()
    tiles[:, 60] = tiles[70] = 60
    found = surfaces(tiles, EVERYWHERE)
    assert found.max() == 1
    assert (found == 1).mean() > 0.95


def test_a_fall_of_light_by_a_factor_of_ten_divides_nothing() -> None:
    x = np.linspace(-1, 1, SHAPE[1])
    fall = 240 * ((1 + (2.0 * x) ** 2) ** -1.5) ** (1 / 2.2)
    ground = np.repeat(np.broadcast_to(fall, SHAPE)[..., None], 3, axis=2).astype(np.uint8)
    assert (surfaces(ground, EVERYWHERE) == 1).all()


def test_a_ground_that_is_texture_all_over_is_one_surface() -> None:
    rows, columns = np.indices(SHAPE)
    checks = (((rows // 8 + columns // 8) % 2) * 120 + 60).astype(np.uint8)
    np.testing.assert_array_equal(surfaces(np.repeat(checks[..., None], 3, axis=2), EVERYWHERE), 1)


def test_what_is_no_ground_is_no_surface() -> None:
    ground = EVERYWHERE.copy()
    ground[40:80, 30:70] = False
    assert (surfaces(table(), ground)[~ground] == 0).all()
    assert (surfaces(table(), ~EVERYWHERE) == 0).all()
