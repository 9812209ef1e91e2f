"""What a label costs where a fit does not predict it."""

import numpy as np

from ashe_live.light.labels.costs import cost_of_distance


def test_distance_costs_beyond_the_free_pixels_and_no_more_than_the_limit() -> None:
    predicted = np.zeros((3, 12), np.bool_)
    predicted[:, 0] = True
    cost = cost_of_distance(predicted, per_px=2.0, farthest_px=4.0, free_px=3.0)[1]
    assert (cost[:4] == 0).all()
    assert (np.diff(cost[3:9]) > 0).all()
    assert (cost[8:] == 2.0 * 4.0).all()


def test_far_from_nothing_predicted_is_as_far_as_the_limit() -> None:
    np.testing.assert_array_equal(cost_of_distance(np.zeros((2, 2), np.bool_), 1.0, 10.0), np.full((2, 2), 10))
