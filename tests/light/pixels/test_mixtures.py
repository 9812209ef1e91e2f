"""Mixtures of colours: their numbers are those of the colours they describe, and costs are densities."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.pixels.mixtures import (
    COLOUR_NOISE,
    UNEXPLAINED,
    Mixture,
    clusters,
    cost,
    mixture_of,
    nearest_squared_distance,
)

CENTRES = np.array([(-1.0, 0.2, 0.0), (-2.5, -0.4, 0.3)], np.float32)
DEVIATIONS = np.array([(0.1, 0.05, 0.08), (0.2, 0.1, 0.05)])
SHARES = (0.75, 0.25)


def colours_of_two(count: int = 8000) -> np.ndarray:
    """(n, 3): three in four of the first kind."""
    rng = np.random.default_rng(0)
    own = [rng.normal(CENTRES[k], DEVIATIONS[k], (round(share * count), 3)) for k, share in enumerate(SHARES)]
    return np.concatenate(own).astype(np.float32)


def two_colours(weights: tuple[float, float] = SHARES) -> Mixture:
    skew = np.array([[0.04, 0.01, 0.0], [0.01, 0.02, -0.005], [0.0, -0.005, 0.01]])
    covariances = np.array([skew, np.diag([0.01, 0.02, 0.005])], np.float32)
    return Mixture(CENTRES, covariances, np.array(weights, np.float32))


def squared_distances(colours: Float, mixture: Mixture) -> Float:
    """(n, k) by the definition."""
    away = colours[:, None].astype(np.float64) - mixture.centres
    return np.einsum("nki,kij,nkj->nk", away, np.linalg.inv(mixture.covariances.astype(np.float64)), away)


def test_a_mixture_has_the_numbers_of_its_colours() -> None:
    mixture = mixture_of(colours_of_two(), 2)
    assert mixture is not None
    order = np.argsort(-mixture.weights)
    np.testing.assert_allclose(mixture.weights[order], SHARES, atol=0.01)
    np.testing.assert_allclose(mixture.centres[order], CENTRES, atol=0.02)
    variances = np.diagonal(mixture.covariances[order], axis1=1, axis2=2)
    np.testing.assert_allclose(variances, DEVIATIONS**2 + COLOUR_NOISE**2, rtol=0.1)


def test_distances_are_mahalanobis() -> None:
    colours, mixture = colours_of_two(300), two_colours()
    expected = squared_distances(colours, mixture)
    nearest = nearest_squared_distance(colours, mixture.centres, mixture.covariances)
    np.testing.assert_allclose(nearest, expected.min(axis=1), atol=0.01)
    costs = np.array([5.0, -3.0])
    cheapest = nearest_squared_distance(colours, mixture.centres, mixture.covariances, costs)
    np.testing.assert_allclose(cheapest, (expected + costs).min(axis=1), atol=0.01)


def test_one_covariance_is_that_of_all_centres() -> None:
    colours, covariance = colours_of_two(300), np.diag([0.01, 0.02, 0.005]).astype(np.float32)
    alone = nearest_squared_distance(colours, CENTRES, covariance)
    np.testing.assert_array_equal(alone, nearest_squared_distance(colours, CENTRES, np.stack([covariance] * 2)))


def test_a_cost_is_twice_the_negative_log_density_of_the_likeliest_component() -> None:
    colours, mixture = colours_of_two(300), two_colours()
    determinants = np.linalg.det(2 * math.pi * mixture.covariances.astype(np.float64))
    densities = mixture.weights * np.exp(-0.5 * squared_distances(colours, mixture)) / np.sqrt(determinants)
    expected = np.minimum(-2 * np.log(densities.max(axis=1)), UNEXPLAINED)
    np.testing.assert_allclose(cost(colours, mixture), expected, atol=0.02)


def test_no_colour_costs_more_than_one_that_nothing_explains() -> None:
    far = np.array([(50.0, -50.0, 20.0), (0.0, 9.0, 0.0)], np.float32)
    np.testing.assert_array_equal(cost(far, two_colours()), np.float32(UNEXPLAINED))


def test_a_shifted_mixture_costs_shifted_colours_the_same() -> None:
    colours, shift = colours_of_two(300), np.array([-1.3, -0.5, 0.12])
    shifted = two_colours().shifted(shift[None], np.ones(1))
    np.testing.assert_allclose(
        cost(colours + shift.astype(np.float32), shifted), cost(colours, two_colours()), atol=0.02
    )


def test_widening_brings_all_nearer() -> None:
    colours = colours_of_two(300)
    wide = two_colours().shifted(np.zeros((1, 3)), np.full(1, 2.0))
    near, nearer = (nearest_squared_distance(colours, each.centres, each.covariances) for each in (two_colours(), wide))
    np.testing.assert_allclose(nearer, near / 2, atol=0.02)


def test_clusters_are_what_lies_together_and_the_same_bits_whatever_ran_before() -> None:
    colours = colours_of_two(400)
    labels, centres = clusters(colours, 2)
    np.testing.assert_allclose(np.sort(centres[:, 0]), np.sort(CENTRES[:, 0]), atol=0.1)
    assert len(set(labels[:300])) == len(set(labels[300:])) == 1
    cv2.setRNGSeed(99)
    again, centres_again = clusters(colours, 2)
    np.testing.assert_array_equal(again, labels)
    np.testing.assert_array_equal(centres_again, centres)


@pytest.mark.parametrize("count", [1, 3, 20])
def test_one_colour_is_one_colour(count: int) -> None:
    mixture = mixture_of(np.full((50, 3), -1.0, np.float32), count)
    assert mixture is not None
    np.testing.assert_allclose(mixture.centres, -1.0, atol=1e-6)
    assert (np.linalg.eigvalsh(mixture.covariances) > 0).all()


def test_few_colours_make_no_mixture() -> None:
    for count in range(5):
        assert mixture_of(np.zeros((count, 3), np.float32), 4) is None


def test_no_colours_cost_nothing() -> None:
    assert cost(np.empty((0, 3), np.float32), two_colours()).shape == (0,)
