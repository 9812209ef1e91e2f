"""Points on outlines."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ashe_live.core.arrays import Float, unit_circle
from ashe_live.light.edges.outline_points import POINTS_PER_OUTLINE, OutlinePoints, evenly_spaced

CENTRE, RADIUS = np.array([64.0, 48.0]), 24.0
SQUARE = CENTRE + RADIUS * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
TURNED = {"from x to y": SQUARE, "from y to x": SQUARE[::-1]}


def polygon(sides: int) -> Float:
    """(sides, 2) regular, inscribed in a circle of RADIUS about CENTRE."""
    return np.asarray(CENTRE + RADIUS * unit_circle(sides))


def spread_over(hull: Float) -> OutlinePoints:
    """On one outline: points and normals (n, 2), share (n,)."""
    places = evenly_spaced([hull])
    return OutlinePoints(places.points[0], places.normals[0], places.along_edge[0])


@pytest.mark.parametrize("hull", TURNED.values(), ids=TURNED)
def test_places_are_equidistant_along_the_outline(hull: Float) -> None:
    points = spread_over(hull).points
    assert points.shape == (POINTS_PER_OUTLINE, 2)
    steps = np.abs(np.roll(points, -1, axis=0) - points).sum(axis=1)  # along a square's sides, round its corners
    np.testing.assert_allclose(steps, 8 * RADIUS / POINTS_PER_OUTLINE)
    np.testing.assert_allclose(np.abs(points - CENTRE).max(axis=1), RADIUS)


@pytest.mark.parametrize("hull", TURNED.values(), ids=TURNED)
def test_normals_are_of_length_one_and_point_outward(hull: Float) -> None:
    places = spread_over(hull)
    np.testing.assert_allclose(np.linalg.norm(places.normals, axis=1), 1)
    np.testing.assert_allclose(((places.points - CENTRE) * places.normals).sum(axis=1), RADIUS)


@pytest.mark.parametrize("hull", TURNED.values(), ids=TURNED)
def test_shares_go_from_one_end_of_an_edge_to_the_other_from_x_to_y(hull: Float) -> None:
    places = spread_over(hull)
    along = places.normals[:, ::-1] * (-1, 1)
    expected = (((places.points - CENTRE) * along).sum(axis=1) + RADIUS) / (2 * RADIUS)
    np.testing.assert_allclose(places.along_edge, expected)
    assert places.along_edge.min() > 0
    assert places.along_edge.max() < 1


@settings(max_examples=40)
@given(st.integers(3, 60), st.floats(2, 200), st.booleans())
def test_any_polygon_has_places_on_it(sides: int, scale: float, turns_back: bool) -> None:
    hull = scale * (polygon(sides) - CENTRE)
    places = spread_over(hull[::-1] if turns_back else hull)
    inner = scale * RADIUS * math.cos(math.pi / sides)
    away = (places.points * places.normals).sum(axis=1)
    np.testing.assert_allclose(away, inner, rtol=1e-5)
    assert ((places.along_edge >= 0) & (places.along_edge <= 1)).all()


def test_a_corner_on_a_straight_edge_is_none() -> None:
    """Such as where a lower part begins at the ground."""
    between = np.insert(SQUARE, 2, SQUARE[1] + (0.001, 15.0), axis=0)
    plain, same = spread_over(SQUARE), spread_over(between)
    np.testing.assert_allclose(same.normals, plain.normals, atol=1e-6)
    np.testing.assert_allclose(same.along_edge, plain.along_edge, atol=1e-3)


@pytest.mark.parametrize("hull", [np.zeros((3, 2)), np.array([(0.0, 0), (0, 0), (5, 0)]), np.ones((4, 2)) * 1e5])
def test_outlines_without_area_have_finite_places(hull: Float) -> None:
    places = spread_over(hull)
    assert np.isfinite(places.points).all()
    assert np.isfinite(places.normals).all()
    assert np.isfinite(places.along_edge).all()
