"""What glossy ground mirrors: brightest where a mirror would show the light, the same both ways, finite."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.ground.gloss import Gloss, mirrored, mirrored_and_slopes

EYE = np.array([0.1, -0.5, 0.4])
GLOSS = Gloss(0.2, 0.3)


def line_of_places(count: int = 401) -> Float:
    return np.column_stack([np.full(count, EYE[0]), np.linspace(-0.4, 0.6, count)])


@pytest.mark.parametrize("slope", [0.5, 1.0, 1.6])
def test_a_smooth_ground_is_brightest_where_a_mirror_shows_the_sun(slope: float) -> None:
    """There the ray to the eye is as steep as the sun's, on the other side."""
    places = line_of_places()
    found = mirrored(places, EYE, np.array([[0.0, slope, 0.0]]), Gloss(0.05, 0.3))[:, 0]
    assert places[np.argmax(found), 1] == pytest.approx(EYE[1] + slope * EYE[2], abs=0.02)


def test_a_rough_ground_spreads_what_a_smooth_one_gathers() -> None:
    places, sun = line_of_places(), np.array([[0.0, 1.0, 0.0]])
    smooth, rough = (mirrored(places, EYE, sun, Gloss(alpha, 0.3))[:, 0] for alpha in (0.1, 0.5))
    assert smooth.max() > 5 * rough.max()
    assert np.count_nonzero(rough > 0.5 * rough.max()) > 2 * np.count_nonzero(smooth > 0.5 * smooth.max())


def test_light_and_eye_may_be_exchanged() -> None:
    """Helmholtz's reciprocity."""
    lamp = np.array([0.3, 0.2, 0.6])
    place = np.zeros((1, 2))
    there = mirrored(place, EYE, np.array([[*(lamp[:2] / lamp[2]), 1 / lamp[2]]]), GLOSS)
    back = mirrored(place, lamp, np.array([[*(EYE[:2] / EYE[2]), 1 / EYE[2]]]), GLOSS)
    np.testing.assert_allclose(there, back, rtol=1e-9)


def test_a_far_lamp_is_a_sun() -> None:
    places = line_of_places(20)
    far, sun = (mirrored(places, EYE, np.array([[0.4, 0.7, nearness]]), GLOSS) for nearness in (1e-6, 0.0))
    np.testing.assert_allclose(far, sun, rtol=1e-4)


def test_dark_ground_shows_it_more() -> None:
    places, sun = line_of_places(20), np.array([[0.4, 0.7, 0.0]])
    pale, dark = (mirrored(places, EYE, sun, Gloss(0.3, albedo)) for albedo in (0.4, 0.1))
    np.testing.assert_allclose(dark, 4 * pale, rtol=1e-12)


@pytest.mark.parametrize("light", [(0, 0, 0), (1e6, 0, 0), (0, 0, 1e3), (-0.5, -2, 3), (3, 4, -0.01)])
@pytest.mark.parametrize("roughness", [0.05, 0.8])
def test_it_is_finite_and_not_negative_also_at_the_horizon(light: tuple[float, ...], roughness: float) -> None:
    places = np.array([[0, 0], [0.1, -0.5], [1e6, 0], [-1e9, 1e9]], dtype=np.float64)
    found = mirrored(places, EYE, np.array([light], dtype=np.float64), Gloss(roughness, 0.08))
    assert np.isfinite(found).all()
    assert (found >= 0).all()


def test_slopes_are_those_of_what_is_mirrored() -> None:
    places, lights = line_of_places(60), np.array([[0.5, 0.8, 1.8], [-0.9, 0.2, 0.7]])
    found, slopes = mirrored_and_slopes(places, EYE, lights, GLOSS)
    np.testing.assert_array_equal(found, mirrored(places, EYE, lights, GLOSS))
    for i in range(3):
        step = np.zeros((2, 3))
        step[0, i] = 1e-5
        ahead, behind = (mirrored(places, EYE, lights + sign * step, GLOSS)[:, 0] for sign in (1, -1))
        np.testing.assert_allclose(slopes[:, i], (ahead - behind) / 2e-5, atol=2e-3 * np.abs(slopes).max())
