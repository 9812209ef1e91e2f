"""What suns and lamps give to a body's sides and to the table around it: by the cosine law and the inverse square."""

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.known_body.sides.facets import Facets
from ashe_live.light.known_body.sides.shading import NOISE, TONES, Sides, direct_light, fall_off
from tests.painted_cubes import EDGE_M

NORMALS = np.array([(0.0, 0, 1), (1, 0, 0), (0, -1, 0)])
CENTRES = EDGE_M * np.array([(0.0, 0, 1), (0.5, 0, 0.5), (0, -0.5, 0.5)])
LAMP = np.array((0.2, -0.3, 0.25, 1.0))
WHITE = np.full(3, 1 / 3)


def irradiance(light: Float, normal: Float, place: Float) -> float:
    """By a lamp (4,) of unit intensity."""
    way = light[:3] / light[3] - place
    return float(max(normal @ way, 0.0) / np.linalg.norm(way) ** 3)


def test_a_lamp_lights_facets_by_cosine_and_distance_whatever_its_scale() -> None:
    on_ground = irradiance(LAMP, NORMALS[0], np.zeros(3))
    expected = [irradiance(LAMP, *facet) / on_ground for facet in zip(NORMALS, CENTRES, strict=True)]
    assert direct_light(LAMP, NORMALS, CENTRES) == pytest.approx(expected)
    assert direct_light(3 * LAMP, NORMALS, CENTRES) == pytest.approx(expected)


def test_a_lamp_far_away_is_a_sun() -> None:
    far = LAMP * (1, 1, 1, 1e-6)
    np.testing.assert_allclose(
        direct_light(far, NORMALS, CENTRES), direct_light(LAMP * (1, 1, 1, 0), NORMALS, CENTRES), rtol=1e-5
    )


def test_the_table_gets_less_the_farther_it_lies_from_the_lamps_foot() -> None:
    places = np.array([(0.0, 0, 0), (0.2, -0.3, 0), (-0.3, 0.2, 0)])
    expected = [irradiance(LAMP, NORMALS[0], place) for place in places]
    found = fall_off(LAMP, places[:, 0], places[:, 1])
    assert found == pytest.approx(np.array(expected) / expected[0])
    assert found[2] < found[0] < found[1]
    assert fall_off(LAMP * (1, 1, 1, 0), places[:, 0], places[:, 1]) == pytest.approx(1)


@pytest.mark.parametrize("nearness", [0.0, 0.5, 1.0, 1.4])
def test_the_sides_light_is_linear_in_a_lights_part_of_the_tables(nearness: float) -> None:
    """The right side of the model, times the light's part, is what is measured over an even sky."""
    light, part = LAMP * (1, 1, 1, nearness), 0.6
    light_rgb = (1 - part) * 0.5 * (1 + NORMALS[:, 2]) + part * direct_light(light, NORMALS, CENTRES)
    seen = Facets(NORMALS, np.repeat(light_rgb[:, None], 3, axis=1), CENTRES, np.zeros(3, bool), np.full(3, 90.0))
    sides = Sides.of(seen, np.zeros((3, 3)), WHITE)
    assert part * sides.reached(light) == pytest.approx(sides.residual)


def test_lamps_leave_more_open_than_suns() -> None:
    """Light changes across a facet beside a lamp, and its white is not all of it."""
    seen = Facets(NORMALS, np.ones((3, 3)), CENTRES, np.zeros(3, bool), np.full(3, 90.0))
    sides = Sides.of(seen, np.zeros((3, 3)), WHITE)
    unit = LAMP / np.linalg.norm(LAMP[:3])
    sun = unit * (1, 1, 1, 0)
    reached = sides.reached(sun)
    assert (sides.spread(unit, reached) > sides.spread(sun, reached)).all()


def test_a_cameras_tones_bend_ratios_the_more_the_farther_they_are_from_one() -> None:
    """Whatever its exponent, what is as bright as the level facet stays so."""
    light_rgb = np.repeat(np.array([(1.0,), (0.98,), (0.4,)]), 3, axis=1)
    sides = Sides.of(Facets(NORMALS, light_rgb, CENTRES, np.zeros(3, bool), np.full(3, 90.0)), np.zeros((3, 3)), WHITE)
    bent = sides.relative ** (1 + TONES)
    assert (np.abs(bent - sides.relative) < sides.noise).all()
    assert sides.noise[0] < 1.1 * NOISE
    assert sides.noise[1] > 2 * sides.noise[0]


def test_a_level_facet_that_nobody_can_measure_leaves_what_the_sides_say_of_each_other() -> None:
    """All sides brighter by the same share are as likely as none, and one that is brighter than the other is not."""
    light_rgb = np.repeat(np.array([(1.0,), (0.5,), (0.5,)]), 3, axis=1)
    clipped, wide = np.array([True, False, False]), np.full(3, 90.0)

    def likelihood(light_rgb: Float, sigma: float) -> float:
        sides = Sides.of(Facets(NORMALS, light_rgb, CENTRES, clipped, wide, sigma), np.zeros((3, 3)), WHITE)
        none = np.zeros((0, 2, 1))
        return float(sides.log_likelihood(none, np.zeros((0, 1)), sides.variance(none, np.zeros((0, 1))))[0])

    brighter, lopsided = light_rgb * np.array([(1.0,), (1.4,), (1.4,)]), light_rgb * np.array([(1.0,), (1.8,), (1.0,)])
    known, open_ = 0.0, 0.5
    assert likelihood(light_rgb, known) - likelihood(brighter, known) > 1.4
    assert likelihood(light_rgb, open_) - likelihood(brighter, open_) < 1
    assert likelihood(brighter, open_) - likelihood(lopsided, open_) > 0.5


def test_sides_constrain_nothing_beside_a_level_facet_of_which_nothing_is_known() -> None:
    seen = Facets(NORMALS, np.ones((3, 3)), CENTRES, np.array([True, False, False]), np.full(3, 90.0), np.inf)
    assert len(Sides.of(seen, np.zeros((3, 3)), WHITE).relative) == 0


@pytest.mark.parametrize("nearness", [0.0, 1.0])
def test_a_light_does_not_shine_if_all_sides_that_it_reaches_lack_what_it_alone_gives(nearness: float) -> None:
    light, part = LAMP * (2, 2, 0.6, nearness), 0.3
    by_light, even = part * direct_light(light, NORMALS, CENTRES), 0.7 * 0.5 * (1 + NORMALS[:, 2])

    def deny(lit: tuple[float, float, float], clipped: bool = False) -> bool:
        light_rgb = np.repeat((even + lit * by_light)[:, None], 3, axis=1)
        seen = Facets(NORMALS, light_rgb, CENTRES, np.array([False, clipped, clipped]), np.full(3, 90.0))
        return Sides.of(seen, np.zeros((3, 3)), WHITE).deny(light, part)

    assert deny((1, 0, 0))
    assert not deny((1, 1, 1))
    assert not deny((1, 2, 2))  # of others there may be more
    assert not deny((1, 1, 0))  # another thing's shadow may lie on one of them
    assert not deny((1, 0, 0), clipped=True)  # they may be brighter than they look
