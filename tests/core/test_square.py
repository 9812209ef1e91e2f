import numpy as np
import pytest

from ashe_live.core.square import mean_side_px, side_lengths_px, square_corners


def test_corners_are_in_the_order_of_the_print_and_a_side_apart() -> None:
    corners = square_corners(0.06)
    # Top-left, top-right, bottom-right, bottom-left as printed: y is up.
    np.testing.assert_array_equal(np.sign(corners), [(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
    np.testing.assert_allclose(side_lengths_px(corners[:, :2]), 0.06)


def test_sides_are_counted_from_the_first_corner() -> None:
    corners = np.array([(0.0, 0.0), (3.0, 4.0), (3.0, 6.0), (0.0, 6.0)])
    np.testing.assert_allclose(side_lengths_px(corners), (5, 2, 3, 6))
    assert mean_side_px(corners) == pytest.approx(4)
