"""The surface of voxels."""

from collections import Counter

import numpy as np
import pytest

from ashe_live.core.arrays import Mask
from ashe_live.light.hull.surface import surface_of

CENTRES = np.stack(np.meshgrid(*[np.arange(40) + 0.5] * 3, indexing="ij"), axis=-1) - 20
BALL = (CENTRES**2).sum(axis=-1) < 15**2
RING = (np.hypot(*np.moveaxis(CENTRES[..., :2], -1, 0)) - 11) ** 2 + CENTRES[..., 2] ** 2 < 5**2


@pytest.mark.parametrize(
    ("occupied", "volume"), [(BALL, 4 / 3 * np.pi * 15**3), (RING, 2 * np.pi**2 * 11 * 5**2)], ids=["ball", "ring"]
)
def test_it_is_closed_faces_outwards_and_holds_the_volume(occupied: Mask, volume: float) -> None:
    points, triangles = surface_of(occupied, np.zeros(3), 1.0)
    sides = Counter(
        (int(one), int(other)) for each in triangles for one, other in zip(each, np.roll(each, -1), strict=True)
    )
    assert all(sides[other, one] == count for (one, other), count in sides.items())
    a, b, c = (points[triangles[:, i]] for i in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(volume, rel=0.1)


def test_it_lies_where_the_voxels_are() -> None:
    low, voxel_m = np.array([0.1, -0.2, 0.0]), 0.002
    points, _ = surface_of(BALL, low, voxel_m)
    distance = np.linalg.norm(points - (low + 20 * voxel_m), axis=1)
    np.testing.assert_allclose(distance, 15 * voxel_m, atol=0.5 * voxel_m)


def test_nothing_has_no_surface() -> None:
    points, triangles = surface_of(np.zeros((5, 4, 3), np.bool_), np.zeros(3), 0.01)
    assert points.shape == (0, 3)
    assert triangles.shape == (0, 3)
