"""The real object's stand-in with a surface of any shape."""

import numpy as np
import pytest

from ashe_live.core.arrays import directions_on_spiral
from ashe_live.core.proxy import Proxy, ProxyMesh

POINTS = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.uint32)
CORNERS = np.column_stack([POINTS, np.zeros((4, 2))])


def test_the_surface_is_the_mesh_where_there_is_one() -> None:
    points, triangles = Proxy("silhouettes", CORNERS, ProxyMesh(POINTS, TRIANGLES)).surface()
    np.testing.assert_array_equal(points, POINTS)
    np.testing.assert_array_equal(triangles, TRIANGLES)
    assert len(Proxy("silhouettes", CORNERS).surface()[0]) > len(POINTS)


@pytest.mark.parametrize(
    "triangles",
    [TRIANGLES[:, :2], TRIANGLES + 1, TRIANGLES.astype(int) - 1, TRIANGLES[:0], TRIANGLES + 0.5],
    ids=["pairs", "no such point", "negative", "none", "fractions"],
)
def test_triangles_are_of_points(triangles: np.ndarray) -> None:
    with pytest.raises(ValueError, match="triangles"):
        ProxyMesh(POINTS, triangles)


def test_a_mesh_must_be_one() -> None:
    with pytest.raises(TypeError, match="mesh"):
        Proxy("silhouettes", CORNERS, POINTS)  # type: ignore[arg-type]


def test_a_body_has_something_that_it_is_the_hull_of() -> None:
    with pytest.raises(ValueError, match="no body"):
        Proxy("silhouettes", np.zeros((0, 5)))


BALL = np.array([[0.1, -0.2, 0.05, 0.05, 0.05]])
TIN = np.array([[0.1, -0.2, 0.0, 0.05, 0.0], [0.1, -0.2, 0.12, 0.05, 0.0]])
BOX = np.array([(x, y, z, 0, 0) for x in (0.02, 0.08) for y in (-0.05, -0.01) for z in (0.0, 0.1)])
VOLUMES = {"ball": 4 / 3 * np.pi * 0.05**3, "tin": np.pi * 0.05**2 * 0.12, "box": 0.06 * 0.04 * 0.1}
BODIES = {"ball": BALL, "tin": TIN, "box": BOX}


@pytest.mark.parametrize("kind", BODIES)
def test_the_surface_is_closed_faces_outwards_and_holds_the_bodys_volume(kind: str) -> None:
    points, triangles = Proxy(kind, BODIES[kind]).surface()
    a, b, c = points[triangles].transpose(1, 0, 2)
    # A closed surface's normals cancel out, and the signed volume of the tetrahedra from the origin is its own.
    np.testing.assert_allclose(np.cross(b - a, c - a).sum(axis=0), 0, atol=1e-12)
    assert (np.einsum("nk,nk->n", a, np.cross(b, c)) / 6).sum() == pytest.approx(VOLUMES[kind], rel=0.02)
    assert points[:, 2].max() == pytest.approx(Proxy(kind, BODIES[kind]).height_m)


@pytest.mark.parametrize("kind", BODIES)
def test_points_are_on_the_body_and_reach_as_far_as_it_does(kind: str) -> None:
    points, surface = Proxy(kind, BODIES[kind]).points_marker(), Proxy(kind, BODIES[kind]).surface()[0]
    directions = directions_on_spiral(200)
    np.testing.assert_allclose((directions @ points.T).max(axis=1), (directions @ surface.T).max(axis=1), atol=0.0015)


def test_the_foot_is_on_the_ground_below_the_middle() -> None:
    assert Proxy("ball", BALL).foot_marker.tolist() == [0.1, -0.2, 0]
    np.testing.assert_allclose(Proxy("box", BOX).foot_marker, (0.05, -0.03, 0))
