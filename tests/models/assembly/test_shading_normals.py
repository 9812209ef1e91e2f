"""Normals of meshes that bring none, where so many triangles meet that those that face one way count as one."""

import math

import numpy as np
import pytest

from ashe_live.models.assembly.shading_normals import CREASE_RAD, MAX_CROWD, corner_normals


@pytest.mark.parametrize("sides", [24, 200])
@pytest.mark.parametrize("rising", [0.2, 1.0, 4.0])
def test_the_tip_of_a_cone_is_round_however_many_sides_it_has(sides: int, rising: float) -> None:
    """Each side's corner there has the mean of the sides that lean as it does within the crease, which is as an arc."""
    assert 24 < MAX_CROWD < 200
    angles = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(sides)], axis=1)
    vertices = np.vstack([(0, 0, rising), rim]).astype(np.float32)
    here = 1 + np.arange(sides)
    triangles = np.stack([np.zeros(sides, int), here, np.roll(here, -1)], axis=1).astype(np.uint32)
    at_tip = corner_normals(vertices, triangles).reshape(-1, 3, 3)[:, 0]

    flat, up = np.array((rising, 1.0)) / math.hypot(rising, 1.0)
    # Two sides that are an angle apart around the axis are within the crease while flat^2 cos + up^2 > cos(crease).
    reach = math.acos(max((math.cos(CREASE_RAD) - up * up) / (flat * flat), -1.0))
    outwards = flat * math.sin(reach) / reach
    middle = angles + np.pi / sides
    expected = np.stack([outwards * np.cos(middle), outwards * np.sin(middle), np.full(sides, up)], axis=1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    apart = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", at_tip, expected), -1, 1)))
    assert apart.max() < 8
    assert apart.mean() < 3


def test_edges_beside_a_crowded_tip_stay_sharp() -> None:
    """A cone of many sides on a ledge: around its tip all are averaged, and at its foot each keeps its own plane."""
    sides = 200
    angles = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(sides)], axis=1)
    vertices = np.vstack([(0, 0, 1.0), (0, 0, 0), rim]).astype(np.float32)
    here = 2 + np.arange(sides)
    after = np.roll(here, -1)
    sloping = np.stack([np.zeros(sides, int), here, after], axis=1)
    ground = np.stack([np.ones(sides, int), after, here], axis=1)
    normals = corner_normals(vertices, np.vstack([sloping, ground]).astype(np.uint32)).reshape(-1, 3, 3)
    np.testing.assert_allclose(normals[sides:], np.tile((0, 0, -1), (sides, 3, 1)), atol=1e-6)
    at_foot = normals[:sides, 1]
    expected = np.column_stack([rim[:, :2], np.ones(sides)]) / math.sqrt(2)
    assert np.einsum("ij,ij->i", at_foot, expected).min() > math.cos(math.radians(2))
    at_tip = normals[:sides, 0]
    middle = angles + np.pi / sides
    lean = at_tip[:, 0] * np.cos(middle) + at_tip[:, 1] * np.sin(middle)
    assert (lean > 0.3).all()
    assert (at_tip[:, 2] > 0.5).all()
