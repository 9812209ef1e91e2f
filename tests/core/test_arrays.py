"""Computations on arrays that many parts need."""

import numpy as np
import pytest

from ashe_live.core.arrays import cached_by_array, lowest_on_parabola

HEIGHTS = np.array([0.003, 0.004, 0.005])


@pytest.mark.parametrize("lowest", [0.0031, 0.004, 0.0048])
def test_a_parabola_is_lowest_at_its_bottom(lowest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, 2.0 + 1e6 * (HEIGHTS - lowest) ** 2) == pytest.approx(lowest)


@pytest.mark.parametrize(("bottom", "nearest"), [(-0.4, 0.003), (0.5, 0.005)])
def test_a_bottom_beyond_the_points_is_not_believed(bottom: float, nearest: float) -> None:
    assert lowest_on_parabola(HEIGHTS, (HEIGHTS - bottom) ** 2) == nearest


def test_without_a_bottom_it_is_the_middle_one() -> None:
    assert lowest_on_parabola(HEIGHTS, -((HEIGHTS - 0.0042) ** 2)) == 0.004


def test_a_method_computes_once_for_equal_arrays_and_once_for_each_object():
    class Doubling:
        def __init__(self):
            self.asked = []

        @cached_by_array
        def doubled(self, values):
            self.asked.append(values.tolist())
            return 2 * values

    one, other = Doubling(), Doubling()
    first = one.doubled(np.arange(3.0))
    assert one.doubled(np.arange(6.0)[:3]) is first
    assert one.doubled(np.arange(6.0)[::2]).tolist() == [0, 4, 8]
    assert other.doubled(np.arange(3.0)).tolist() == first.tolist()
    assert (len(one.asked), len(other.asked)) == (2, 1)
