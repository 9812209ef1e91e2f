"""How the drawn exposure follows measurements of it, against a known exposure with noise."""

import numpy as np
import pytest

from ashe_live.render.camera.exposure import NOISE, followed


def _shown(measured: np.ndarray) -> np.ndarray:
    """(n, 3) what is shown after each of the measurements (n, 3), the first of which is shown as it is."""
    shown = [measured[0]]
    for each in measured[1:]:
        shown.append(followed(shown[-1], each))
    return np.array(shown)


def test_noise_is_smoothed_away() -> None:
    noise = np.random.default_rng(5).normal(0, NOISE, (2000, 3))
    steps, shown = np.diff(noise, axis=0), np.diff(_shown(noise), axis=0)
    assert shown.std() < 0.6 * steps.std()
    assert _shown(noise).std() < NOISE


@pytest.mark.parametrize("step", [0.05, -0.3, 1.0])
def test_a_change_is_followed_at_once(step: float) -> None:
    measured = np.array([np.zeros(3), np.full(3, step)])
    assert _shown(measured)[-1] == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("slope", [1e-4, 1e-3, 0.01])
def test_a_slow_drift_is_not_left_behind_by_more_than_the_noise(slope: float) -> None:
    measured = np.outer(np.arange(400) * slope, np.ones(3))
    behind = measured - _shown(measured)
    assert (behind >= 0).all()
    assert behind.max() < max(2 * NOISE, slope)


def test_one_channel_that_changes_takes_the_others_along() -> None:
    """White balance and exposure are one measurement: no colours in between are shown."""
    shown, measured = np.zeros(3), np.array([0.2, 0.001, -0.001])
    assert followed(shown, measured) == pytest.approx(measured, rel=0.01)
