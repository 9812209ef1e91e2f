"""The fall of a lamp's light in a picture: that of the inverse square and the cosine at the places that pixels show."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import project
from ashe_live.light.ground.slow_shading import LightFall, slow_bases
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import paint

LAMP_M, SHARE, REFERENCE = np.array([0.3, -0.2, 0.4]), 0.7, np.array([0.1, 0.02])
PLACES = np.random.default_rng(3).uniform(-0.15, 0.15, (40, 2))


def place_of(lamp_m: Float) -> Float:
    return np.array([*lamp_m[:2], 1.0]) / lamp_m[2]


def light_at(places: Float) -> Float:
    away = LAMP_M - np.column_stack([places, np.zeros(len(places))])
    return np.asarray(away[:, 2] / np.linalg.norm(away, axis=1) ** 3)


@pytest.mark.parametrize("width_px", [80, 320, 640])
def test_pixels_get_what_the_ground_does_that_they_show(width_px: int) -> None:
    view = View.of(paint().tracked, width_px)
    pixels = project(view.camera, view.T_cam_marker, np.column_stack([PLACES, np.zeros(len(PLACES))]))
    u, v = (2 * (pixels + 0.5) / view.size - 1).T.astype(np.float32)
    found = LightFall.of(view, place_of(LAMP_M), SHARE, REFERENCE).log_light(u, v)
    expected = np.log(1 - SHARE + SHARE * light_at(PLACES) / light_at(REFERENCE[None]))
    np.testing.assert_allclose(found, expected, atol=1e-4)


def test_a_window_has_the_pictures_values() -> None:
    view = View.of(paint().tracked, 160)
    fall, shape = LightFall.of(view, place_of(LAMP_M), SHARE, REFERENCE), view.is_ground.shape
    window = slice(20, 50), slice(30, 90)
    whole = slow_bases(shape, fall).reshape(*shape, -1)
    np.testing.assert_array_equal(slow_bases(shape, fall, window).reshape(30, 60, -1), whole[window])


@pytest.mark.parametrize("place", [(0, 0, 12), (0, 0, -0.01), (60, -20, 0.5), (0, 0, 0), (3, 4, 1e3), (1e6, 0, 1)])
def test_it_is_finite_everywhere_also_above_the_horizon(place: tuple[float, ...]) -> None:
    view = View.of(paint().tracked, 160)
    fall = LightFall.of(view, np.array(place, dtype=np.float64), 0.98, REFERENCE)
    v, u = np.meshgrid(np.linspace(-9, 1, 200, dtype=np.float32), np.linspace(-1, 1, 60, dtype=np.float32))
    assert np.isfinite(fall.log_light(u.ravel(), v.ravel())).all()
