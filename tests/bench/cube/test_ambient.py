"""Errors of an answer's ambient light, against what integrals over the sphere say of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.bench.cube.ambient import NORMALS, ambient_errors, painted_sky
from ashe_live.bench.cube.painted_scene import CubeScene
from ashe_live.bench.cube.scenes import CAMERA, looking, sun
from ashe_live.core.arrays import directions_on_spiral
from ashe_live.core.light import Illumination

SKY = np.array((0.2, 0.3, 0.4))
SCENE = CubeScene(CAMERA, looking(0.4, 50, 30), [sun(200, 40, 0.5)], sky_rgb=SKY)
LEVEL = SKY + 0.5 * np.array((1.0, 0.95, 0.88))
NORMAL = directions_on_spiral(NORMALS)


def test_level_ground_gets_all_of_the_sky_and_an_upright_surface_half_of_it() -> None:
    """Over all light on level ground, and more on the side to which the sky leans."""
    assert painted_sky(SCENE) == pytest.approx((1 + NORMAL[:, 2:]) / 2 * SKY / LEVEL)
    leaning = painted_sky(replace(SCENE, sky_slope=np.array((0.3, -0.1, 5.0))))
    lean = 0.5 * (0.3 * NORMAL[:, :1] - 0.1 * NORMAL[:, 1:2])
    assert leaning == pytest.approx(np.maximum((1 + NORMAL[:, 2:]) / 2 + lean, 0) * SKY / LEVEL)


@pytest.mark.parametrize("reflectance", [0.0, 0.5, 1.0])
def test_a_sky_too_bright_by_a_tenth_is_off_by_less_the_more_the_table_sends_back(reflectance: float) -> None:
    """The mean squares over the sphere of (1 + z) / 2 and of that with r (1 - z) / 2: 1/3 and (1 + r + r^2) / 3."""
    answer = Illumination(ambient_rgb_ratio=1.1 * np.ones(3))
    sky_on_ball = np.repeat((1 + NORMAL[:, 2:]) / 2, 3, axis=1)
    even, leaning = ambient_errors(sky_on_ball, np.full(3, reflectance), answer)
    assert even == pytest.approx(0.1 / math.sqrt(1 + reflectance + reflectance**2), rel=1e-3)
    assert leaning == even


def test_the_lean_of_the_sky_counts_in_one_of_both_errors() -> None:
    """The mean square of s x is s^2 / 3."""
    slope = np.array([(0.1, 0.1, 0.1), (0.0, 0.0, 0.0)])
    sky_on_ball = np.maximum((1 + NORMAL[:, 2:]) / 2 + 0.1 * NORMAL[:, :1], 0) * np.ones(3)
    answer = Illumination(ambient_rgb_ratio=np.ones(3), sky_slope_rgb=slope)
    even, leaning = ambient_errors(sky_on_ball, np.zeros(3), answer)
    assert leaning == pytest.approx(0, abs=1e-9)
    assert even == pytest.approx(0.1 / math.hypot(1, 0.1), rel=0.01)
    assert ambient_errors(sky_on_ball, np.zeros(3), replace(answer, sky_slope_rgb=-slope))[1] > 1.9 * even
