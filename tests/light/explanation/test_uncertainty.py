"""How uncertain a direction is: the radius that holds the truth."""

import numpy as np
import pytest

from ashe_live.core.transforms import radius_of_68_percent
from ashe_live.light.explanation.uncertainty import covariance_of_doubt


def held_by(radius: float, deviations: tuple[float, float]) -> float:
    """The probability that a normal sample lies within `radius`: over the angle, the radial part is exponential."""
    angles = np.linspace(0, np.pi, 20_001)[:-1] + 1e-5
    along = (deviations[0] * np.cos(angles)) ** 2 + (deviations[1] * np.sin(angles)) ** 2
    return float(1 - np.exp(-0.5 * radius**2 / along).mean())


@pytest.mark.parametrize("turn_rad", [0.0, 1.1])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0])
def test_the_radius_holds_the_truth_with_probability_68_percent(share: float, turn_rad: float) -> None:
    axes = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    deviations = 0.03, 0.03 * share
    radius = radius_of_68_percent(axes @ np.diag(np.square(deviations)) @ axes.T)
    # Without any spread across, the angle's integrand is 0 almost everywhere.
    deviations = 0.03, max(0.03 * share, 1e-7)
    assert held_by(radius / 1.01, deviations) < 0.68 < held_by(radius * 1.01, deviations)


def test_no_spread_has_no_radius() -> None:
    assert radius_of_68_percent(np.zeros((2, 2))) == 0
    assert radius_of_68_percent(np.diag([-1e-18, 0.0])) == 0


def test_the_less_confident_an_answer_is_the_wider_it_is() -> None:
    radii = [radius_of_68_percent(covariance_of_doubt(confidence)) for confidence in np.linspace(0, 1, 11)]
    assert radii[-1] == 0.0
    assert np.all(np.diff(radii) < 0)


def test_doubt_has_no_direction() -> None:
    smaller, larger = np.linalg.eigvalsh(covariance_of_doubt(0.3))
    assert smaller == pytest.approx(larger)
