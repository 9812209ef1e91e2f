"""What steps of light tell of a lamp's nearness, beside the offset that all of them around an object may have."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.edges.nearness import OFFSET_PX, without_offset
from ashe_live.light.edges.outline_points import BORDERS_PER_SAMPLE


def equations(offset_px: float) -> tuple[Float, Float]:
    """Of an object of one size and its shadow, 1 + nearness times as large; all of the object's steps too far out."""
    # The movement outwards, in pixels, of ten points of the object, then of its shadow: by size, nearness, and offset.
    by_size, by_nearness, by_offset = np.ones(20), np.repeat([0.0, 1.0], 10), np.repeat([1.0, 0.0], 10)
    jacobian = np.array([by_size, by_nearness, by_offset])
    return 40 * (jacobian @ jacobian.T)[None], 40 * (jacobian @ (offset_px * by_offset))[None]


def test_marginalising_leaves_the_solution_and_covariance_of_the_rest() -> None:
    normal, gradient = equations(0.2)
    whole = normal[0] + np.diag([0, 0, BORDERS_PER_SAMPLE / OFFSET_PX**2])
    left, pull = without_offset(normal, gradient)
    np.testing.assert_allclose(np.linalg.inv(left[0]), np.linalg.inv(whole)[:2, :2])
    np.testing.assert_allclose(np.linalg.solve(left[0], pull[0]), np.linalg.solve(whole, gradient[0])[:2])


def test_an_offset_that_is_usual_passes_for_no_sure_lamp() -> None:
    """Ignored, it makes a sun's shadow too narrow by many sigmas; allowed for, by one at most."""
    for offset_px in (-OFFSET_PX, OFFSET_PX):
        normal, gradient = equations(offset_px)
        ignored = normal[0, :2, :2], gradient[0, :2]
        left, pull = without_offset(normal, gradient)
        sigmas = []
        for matrix, towards in (ignored, (left[0], pull[0])):
            covariance = BORDERS_PER_SAMPLE * np.linalg.inv(matrix)
            sigmas.append(abs(np.linalg.solve(matrix, towards)[1]) / np.sqrt(covariance[1, 1]))
        assert sigmas[0] > 2.5
        assert sigmas[1] < 1.0


def test_without_steps_nothing_is_estimated() -> None:
    left, pull = without_offset(np.zeros((2, 3, 3)), np.zeros((2, 3)))
    assert (left == 0).all()
    assert pull == pytest.approx(0)
