"""Computations on arrays that many parts need."""

import numpy as np
import pytest

from ashe_live.core.arrays import lowest_on_parabola

HEIGHTS = np.array([0.003, 0.004, 0.005])


@pytest.mark.parametrize("lowest", [0.0031, 0.004, 0.0048])
def test_a_parabola_is_lowest_at_its_bottom(lowest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, 2.0 + 1e6 * (HEIGHTS - lowest) ** 2) == pytest.approx(lowest)


@pytest.mark.parametrize(("bottom", "nearest"), [(-0.4, 0.003), (0.5, 0.005)])
def test_a_bottom_beyond_the_points_is_not_believed(bottom: float, nearest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, (HEIGHTS - bottom) ** 2) == nearest


def test_without_a_bottom_it_is_the_middle_one() -> None:
    assert lowest_on_parabola(HEIGHTS, -((HEIGHTS - 0.0042) ** 2)) == 0.004
