"""The table of mirrored shares against what GGX says where that is known without it."""

import numpy as np
import pytest

from ashe_live.render.reflections.reflectance import COSINES, ROUGHNESSES, mirrored_shares


def test_what_is_smooth_mirrors_as_schlick_says() -> None:
    cosines = np.linspace(0, 1, COSINES)[1:]
    factor, anyhow, _ = mirrored_shares()[0, 1:].T
    np.testing.assert_allclose(anyhow, (1 - cosines) ** 5, atol=0.005)
    np.testing.assert_allclose(factor, 1 - (1 - cosines) ** 5, atol=0.005)


def test_facets_send_back_no_more_than_they_get_and_rough_ones_less_at_once() -> None:
    table = mirrored_shares()
    at_once = table[..., 0] + table[..., 1]
    assert (table > 0).all()
    assert (at_once < 1 + 1e-6).all()
    assert (np.diff(table[:, 0, 2]) < 0.002).all()
    assert table[-1, 0, 2] < 0.7


@pytest.mark.parametrize("row", [6, 9, 15])
@pytest.mark.parametrize("column", [10, 20, 31])
def test_the_shares_are_the_integral_over_all_that_is_lit(row: int, column: int) -> None:
    """By light directions in place of facets: D V F n.l over the hemisphere, in the middle of equal solid angles."""
    alpha, n_v = (row / (ROUGHNESSES - 1)) ** 2, column / (COSINES - 1)
    heights, turns = np.meshgrid((np.arange(600) + 0.5) / 600, 2 * np.pi * (np.arange(600) + 0.5) / 600)
    flat = np.sqrt(1 - heights**2)
    half = np.stack([flat * np.cos(turns) + np.sqrt(1 - n_v**2), flat * np.sin(turns), heights + n_v])
    half /= np.linalg.norm(half, axis=0)
    distribution = alpha**2 / (half[2] ** 2 * (alpha**2 - 1) + 1) ** 2  # over pi
    shadowed = heights * np.sqrt(n_v**2 * (1 - alpha**2) + alpha**2)
    masked = n_v * np.sqrt(heights**2 * (1 - alpha**2) + alpha**2)
    mirrored = distribution * 0.5 / (shadowed + masked) * heights * 2  # solid angle 2 pi, over pi
    grazing = (1 - half[2] * n_v - half[0] * np.sqrt(1 - n_v**2)) ** 5
    expected = (mirrored * (1 - grazing)).mean(), (mirrored * grazing).mean()
    np.testing.assert_allclose(mirrored_shares()[row, column, :2], expected, atol=0.01)
