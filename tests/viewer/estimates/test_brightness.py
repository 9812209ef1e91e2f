"""A switched lamp is noticed, and noise and drift are not."""

import numpy as np
import pytest

from ashe_live.core.types import Frame
from ashe_live.viewer.estimates.brightness import Brightness

SCENE = np.random.default_rng(0).integers(20, 180, (480, 640, 3)).astype(np.uint8)


def frame(times: float = 1.0, seed: int = 0) -> Frame:
    noise = np.random.default_rng(seed).normal(0, 4, SCENE.shape)
    return Frame(np.clip(times * SCENE + noise, 0, 255).astype(np.uint8), 0, 0.0)


@pytest.mark.parametrize(
    ("times", "has_jumped"), [(1.0, False), (1.06, False), (0.95, False), (1.2, True), (0.8, True), (0.1, True)]
)
def test_a_change_of_more_than_a_tenth_is_a_jump(times: float, has_jumped: bool) -> None:
    brightness = Brightness()
    brightness.note(frame())
    assert brightness.has_jumped(frame(times, seed=1)) is has_jumped
    brightness.note(frame(times))
    assert not brightness.has_jumped(frame(times, seed=2))


def test_before_an_estimate_nothing_is_a_jump_and_in_the_dark_noise_is_none() -> None:
    assert not Brightness().has_jumped(frame())
    brightness = Brightness()
    brightness.note(Frame(np.zeros_like(SCENE), 0, 0.0))
    assert not brightness.has_jumped(Frame((SCENE > 176).astype(np.uint8), 0, 0.0))
    assert brightness.has_jumped(frame())
