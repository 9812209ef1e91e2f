"""Ratios of shadows, in channels in which the ground has light and in those in which it has none."""

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.render.lights.seen_light import steadied, steadied_ratio

BLUISH = np.array((0.25, 0.32, 0.42))


@pytest.mark.parametrize("grey", [0.3, 0.9])
def test_what_grey_ground_shows_is_kept(grey: float) -> None:
    np.testing.assert_allclose(steadied_ratio(BLUISH, np.full(3, grey)), BLUISH, rtol=0.03)


@pytest.mark.parametrize("noise", [0.02, 0.3, 1.0])
def test_a_channel_without_light_takes_on_the_others_ratio(noise: float) -> None:
    """Terracotta, with hardly any blue: whatever was measured there, paper's shadow is neither violet nor yellow."""
    ratio = steadied_ratio(np.array((0.14, 0.13, noise)), np.array((0.42, 0.11, 0.002)))
    assert ratio[2] == pytest.approx(0.135, rel=0.3)
    assert ratio[0] == pytest.approx(0.14, rel=0.05)


def test_the_less_light_the_less_it_counts() -> None:
    blues = [steadied_ratio(np.array((0.2, 0.2, 0.6)), np.array((0.4, 0.4, blue)))[2] for blue in (0.001, 0.01, 0.1, 1)]
    assert blues == sorted(blues)
    assert blues[0] < 0.25
    assert blues[-1] > 0.55


def test_black_ground_and_no_shadow_at_all_stay_finite() -> None:
    for ratio in (np.zeros(3), np.ones(3)):
        found = steadied_ratio(ratio, np.zeros(3))
        assert np.isfinite(found).all()
        assert (found <= 1).all()


def test_what_no_light_reaches_is_of_the_same_colour() -> None:
    """Terracotta again: in an estimate the ambient holds where a light's ratio contradicts it."""
    terracotta, seen = np.array((0.31, 0.064, 0.007)), np.array((0.064, 0.051, 0.001))
    sun = Light(np.array((0.6, 0.0, 0.8)), shadow_rgb_ratio=seen)
    (light,), ambient = steadied(Illumination((sun,), ambient_rgb_ratio=seen, ground_rgb=terracotta))
    assert light.shadow_rgb_ratio is not None
    assert ambient is not None
    np.testing.assert_allclose(ambient, light.shadow_rgb_ratio)
    assert ambient[2] > 0.5 * ambient[1]


def test_what_was_not_measured_or_not_on_a_known_ground_stays_as_it_is() -> None:
    measured, unmeasured = Light((0.6, 0.0, 0.8), shadow_rgb_ratio=BLUISH), Light((0.0, 0.6, 0.8))
    of = Illumination((measured, unmeasured), ambient_rgb_ratio=BLUISH)
    assert steadied(of) == (of.lights, of.ambient_rgb_ratio)
    (_, second), ambient = steadied(Illumination((measured, unmeasured), ground_rgb=np.full(3, 0.01)))
    assert second is unmeasured
    assert ambient is None
