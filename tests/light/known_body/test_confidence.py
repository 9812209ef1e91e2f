"""How sure a light is: by the normal distribution of its direction that its shadow's edges leave."""

import numpy as np
import pytest

from ashe_live.light.known_body.confidence import probability_within


@pytest.mark.parametrize("sigmas_deg", [(0.2, 0.2), (6.0, 6.0), (9.0, 9.0), (0.5, 12.0), (4.0, 9.0), (20.0, 25.0)])
def test_within_a_radius_are_as_many_directions_as_of_samples(sigmas_deg: tuple[float, float]) -> None:
    """Within a circle, not a square: that holds up to a tenth more."""
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    root = turn * np.radians(sigmas_deg)
    away = np.linalg.norm(np.random.default_rng(5).normal(size=(200_000, 2)) @ root.T, axis=1)
    for radius_deg in (10.0, 20.0):
        expected = (away < np.radians(radius_deg)).mean()
        assert probability_within(np.radians(radius_deg), root @ root.T) == pytest.approx(expected, abs=0.006)
