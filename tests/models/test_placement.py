import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.models.mesh import Mesh, Model
from ashe_live.models.placement import (
    FOOTPRINT_SIDES,
    HEIGHT_SIDES,
    MAX_OUTLINE_POINTS,
    PlacedModel,
    placed_on_marker,
)
from ashe_live.models.primitives import box

EXTENT = st.floats(1e-3, 1e3)


@given(size=st.tuples(EXTENT, EXTENT, EXTENT), shift=st.tuples(*[st.floats(-10, 10)] * 3), side_m=st.floats(0.001, 10))
def test_model_fills_the_marker_and_stands_on_it(
    size: tuple[float, float, float], shift: tuple[float, float, float], side_m: float
) -> None:
    # Single precision cannot tell a small box apart that is far from its origin.
    offset = np.array(shift) * min(size)
    placed = placed_on_marker(Model("box", (box(size).moved(1.0, offset),)), side_m)
    (x0, y0, z0), (x1, y1, z1) = placed.bounds / side_m
    tolerance = 1e-4
    assert abs(z0) < tolerance
    assert abs(x0 + x1) < tolerance
    assert abs(y0 + y1) < tolerance
    fill = max((x1 - x0) / FOOTPRINT_SIDES, (y1 - y0) / FOOTPRINT_SIDES, z1 / HEIGHT_SIDES)
    assert fill == pytest.approx(1.0, abs=tolerance)
    proportions = (placed.bounds[1] - placed.bounds[0]) / np.array(size)
    np.testing.assert_allclose(proportions, proportions[0], rtol=1e-2)


def test_marker_without_a_side_is_wrong_use() -> None:
    with pytest.raises(ValueError, match="not positive"):
        placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.0)


def test_outline_encloses_the_model_and_hardly_more():
    """By the support function, in directions that it was not made from; small clouds are their own outline."""
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    ball = rng.normal(size=(30_000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    for cloud in (ball, ball * (1, 1, 0.05), rng.uniform(-1, 1, (30_000, 3)), ball[:400]):
        points = (cloud * 0.04).astype(np.float32)
        triangles = np.arange(len(points) // 3 * 3).reshape(-1, 3)
        model = Model("cloud", (Mesh(points, np.tile(np.float32((0, 0, 1)), (len(points), 1)), triangles),))
        outline = PlacedModel(model, model.bounds).outline
        assert len(outline) <= MAX_OUTLINE_POINTS
        reach, outer = (directions @ points.T).max(axis=1), (directions @ outline.T).max(axis=1)
        assert (outer >= reach - 2e-4 * 0.04).all()
        assert (outer <= reach + 0.01 * 0.04).all()
