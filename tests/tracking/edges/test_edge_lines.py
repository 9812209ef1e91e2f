"""Lines through a square's measured edges: how sure their ends are."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.tracking.edges.edge_lines import robust_lines

PLACES = np.linspace(0.06, 0.94, 32)
SIGMA_PX = 0.05


def ends_and_variances(correlated_over: int) -> tuple[float, float, float]:
    """Of the lines' ends, px^2: their variance in truth, that of the covariances, and that of correlated scatter.

    The edges' scatter has the same standard deviation whatever the number of samples that it is alike over.
    """
    rng, ends, stated, correlated = np.random.default_rng(3), [], [], []
    window = np.ones(correlated_over) / np.sqrt(correlated_over)
    for _ in range(150):
        noise = rng.normal(0, SIGMA_PX, (4, len(PLACES) + correlated_over - 1))
        offsets: Float = np.array([np.convolve(one, window, "valid") for one in noise])
        lines = robust_lines(PLACES, offsets, np.ones_like(offsets), np.full(4, 100.0), np.ones(4, dtype=bool))
        ends.append(lines.ends_px)
        stated.append(lines.covariances_px2[:, (0, 1), (0, 1)].mean())
        correlated.append(lines.correlated_px2.mean())
    return float(np.var(ends)), float(np.mean(stated)), float(np.mean(correlated))


def test_independent_scatter_is_its_covariance() -> None:
    truth, stated, correlated = ends_and_variances(1)
    np.testing.assert_allclose(stated, truth, rtol=0.25)
    assert correlated < 0.25 * truth


def test_correlated_scatter_moves_the_ends_by_more_and_says_so() -> None:
    truth, stated, correlated = ends_and_variances(4)
    assert stated < 0.5 * truth
    np.testing.assert_allclose(stated + correlated, truth, rtol=0.35)
