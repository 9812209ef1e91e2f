"""A glow is sheen; what is bright within an outline is not."""

import cv2
import numpy as np
import pytest

from ashe_live.light.ground.lit_ground import fit_lit_ground, ground_colours, unlit_mask
from ashe_live.light.ground.preset import GroundPreset
from ashe_live.light.ground.sheen import sheen_on, without_sheen
from ashe_live.light.pixels.mixtures import mixture_of, nearest_squared_distance

SIZE = HEIGHT, WIDTH = 240, 320
ALL = np.ones(SIZE, np.bool_)
V, U = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
GLOW = np.exp(-0.5 * (((U - 200) / 30) ** 2 + ((V - 120) / 40) ** 2))
WITHIN = (np.abs(U - 200) < 30) & (np.abs(V - 120) < 40)


def ground(brighter: np.ndarray) -> np.ndarray:
    """Log-opponent colours of a grey ground that is so much brighter in places."""
    colours = np.random.default_rng(3).normal(0, 0.02, (*SIZE, 3)).astype(np.float32)
    colours[..., 0] += brighter - 1
    return colours


def found(brighter: np.ndarray) -> np.ndarray:
    palette = mixture_of(ground(np.zeros(SIZE)).reshape(-1, 3)[::7], 4)
    colours = ground(brighter)
    squared = np.minimum(
        nearest_squared_distance(colours.reshape(-1, 3), palette.centres, palette.covariances), 60
    ).reshape(SIZE)
    return sheen_on(colours, cv2.GaussianBlur(squared, (0, 0), 0.7), ALL, palette)


def test_a_glow_is_sheen_as_far_as_it_is_seen():
    sheen = found(0.8 * GLOW)
    assert sheen[GLOW > 0.5].all()
    assert not sheen[GLOW < 0.05].any()


@pytest.mark.parametrize("brighter", [0.3, 0.6, 2.0])
def test_a_bright_object_is_none(brighter):
    assert not found(brighter * WITHIN).any()


def test_neither_is_an_object_in_a_glow():
    away = np.hypot(U - 200, V - 120)
    sheen = found(np.where(away < 15, 1.5, 0.8 * np.exp(-0.5 * (away / 45) ** 2)))
    assert sheen[(away > 22) & (away < 60)].all()
    assert not sheen[away < 15].any()


def test_neither_is_a_shadow_however_soft():
    assert not found(-0.8 * GLOW).any()


def test_an_even_ground_has_none():
    assert not found(np.zeros(SIZE)).any()


def test_without_it_the_colours_are_those_of_the_ground():
    palette = mixture_of(ground(np.zeros(SIZE)).reshape(-1, 3)[::7], 4)
    glowing = ground(0.8 * GLOW)
    sheen = found(0.8 * GLOW)
    dull = without_sheen(glowing, sheen, palette)
    assert np.abs(dull[sheen, 0] + 1).max() < 0.1
    np.testing.assert_array_equal(dull[~sheen], glowing[~sheen])


def test_a_mirrored_lamp_is_nothing_that_stands_on_the_ground():
    noise = np.random.default_rng(1).normal(0, 2, (*SIZE, 1))
    image = np.clip(np.full((*SIZE, 3), 90.0) + noise + 130 * GLOW[..., None], 0, 255)
    image[60:110, 60:90] = (30, 60, 160)
    image = image.astype(np.uint8)
    lit = fit_lit_ground(image, ALL, GroundPreset())
    unlit = unlit_mask(lit, ALL, 20)
    assert unlit[62:108, 62:88].mean() > 0.95
    assert unlit[:, 110:].mean() < 0.01
    twice = cv2.resize(image, None, fx=2, fy=2)
    glowing = ground_colours(twice, lit, (slice(200, 280), slice(360, 440)))
    beside = ground_colours(twice, lit, (slice(400, 480), slice(100, 180)))
    assert abs(np.median(glowing[..., 0]) - np.median(beside[..., 0])) < 0.45  # of 0.85
