"""Light between the table and a painted cube's sides: Lambert's form factors, in formulas that it does not use."""

import math

import numpy as np
import pytest

from ashe_live.bench.cube.bounce import light_from_table, part_from_facet
from ashe_live.core.arrays import Float

UP, AHEAD = np.array((0.0, 0.0, 1.0)), np.array((0.0, 1.0, 0.0))
NO_SHADOW: Float = np.full((3, 2), 1e3) + np.eye(3)[:, :2]
RED = np.array((1.0, 0.5, 0.25))


def no_sky(x: Float, _y: Float) -> Float:
    return np.zeros((len(x), 3))


def even_sky(x: Float, _y: Float) -> Float:
    return np.full((len(x), 3), 0.3)


def disc(radius: float, centre: tuple[float, float] = (0.0, 0.0)) -> Float:
    angle = np.linspace(0, 2 * math.pi, 90, endpoint=False)
    return np.column_stack((np.cos(angle), np.sin(angle))) * radius + centre


@pytest.mark.parametrize(("tilt_deg", "share"), [(0, 1.0), (60, 0.75), (90, 0.5), (120, 0.25), (180, 0.0)])
def test_an_even_table_fills_as_much_of_a_facets_view_as_that_leans_down(tilt_deg: float, share: float) -> None:
    """(1 - n_z) / 2 of it, from any height. What it sends is the sky's light and the lights' together."""
    normal = math.sin(math.radians(tilt_deg)) * AHEAD - math.cos(math.radians(tilt_deg)) * UP
    for place in (np.array((0.3, -0.2, 0.05)), np.array((0.0, 0.0, 7.0))):
        found = light_from_table(normal, place, even_sky, [(RED, NO_SHADOW), (0.5 * RED, NO_SHADOW)])
        assert found == pytest.approx(share * (0.3 + 1.5 * RED), abs=0.02)


def test_nothing_comes_to_a_place_on_the_table_or_below_it() -> None:
    for height in (0.0, -0.01):
        assert not light_from_table(AHEAD, np.array((0.0, 0.0, height)), even_sky, [(RED, NO_SHADOW)]).any()


@pytest.mark.parametrize("radius", [0.3, 1.0, 3.0])
def test_a_shadow_takes_away_what_a_disc_of_its_size_fills_of_the_view(radius: float) -> None:
    """r^2 / (r^2 + h^2) for what looks straight down onto it, and only of the light whose shadow it is."""
    place = np.array((0.5, -1.0, 1.0))
    below = disc(radius, (0.5, -1.0))
    found = light_from_table(-UP, place, no_sky, [(RED, below), (np.ones(3), NO_SHADOW)])
    assert found == pytest.approx(1 + RED * (1 - radius**2 / (1 + radius**2)), abs=0.02)


def test_a_shadow_behind_a_facet_takes_nothing_from_it() -> None:
    place = np.array((0.0, 0.0, 0.5))
    free, behind, before = (
        light_from_table(AHEAD, place, no_sky, [(RED, shadow)])
        for shadow in (NO_SHADOW, disc(1, (0, -1.2)), disc(2, (0, 1)))
    )
    assert behind == pytest.approx(free)
    assert (before < 0.6 * free).all()


def upright(width: float, height: float) -> Float:
    """(4, 3) corners of a rectangle that stands on the table along x from the origin, and faces y."""
    return np.array([(width, 0, height), (0, 0, height), (0, 0, 0), (width, 0, 0)])


@pytest.mark.parametrize("away", [0.5, 1.0, 3.0])
def test_a_facet_that_stands_on_the_table_sends_what_its_form_factor_says(away: float) -> None:
    """Of a place before its lower corner, for surfaces at right angles (Howell's catalogue, B-4)."""
    width, height = 1.0, 1.5
    slant = math.hypot(height, away)
    wanted = (math.atan(width / away) - away / slant * math.atan(width / slant)) / (2 * math.pi)
    x, y = np.array([0.0, width, 0.0]), np.array([away, away, -away])
    found = part_from_facet(upright(width, height), x, y)
    assert found == pytest.approx([wanted, wanted, 0.0], rel=0.02)  # and nothing behind it


def test_a_facet_that_hangs_over_the_table_sends_what_its_form_factor_says() -> None:
    """Of a place below its corner, for parallel surfaces (Howell's catalogue, B-3)."""
    corners = np.array([(0, 0, 2.0), (0, 1.0, 2.0), (1.0, 1.0, 2.0), (1.0, 0, 2.0)])[::-1]
    a = b = 0.5
    wanted = sum(p / math.hypot(1, p) * math.atan(q / math.hypot(1, p)) for p, q in ((a, b), (b, a))) / (2 * math.pi)
    found = part_from_facet(corners, np.array([[0.0], [1.0]]), np.array([0.0, 1.0]))
    assert found == pytest.approx(np.full((2, 2), wanted), rel=0.02)
    assert not part_from_facet(corners[::-1], np.zeros(1), np.zeros(1)).any()


def test_however_near_a_facet_fills_no_more_than_half_of_the_view_of_the_table() -> None:
    """Also where its pieces are as large as they are far."""
    along, away = np.linspace(0.3, 0.7, 50)[None], np.geomspace(1e-6, 1, 50)[:, None]
    assert part_from_facet(upright(1.0, 1.0), along, away).max() <= 0.5
