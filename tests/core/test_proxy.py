"""The real object's stand-in with a surface of any shape."""

import numpy as np
import pytest

from ashe_live.core.proxy import Proxy, ProxyMesh

POINTS = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.uint32)
CORNERS = np.column_stack([POINTS, np.zeros((4, 2))])


def test_the_surface_is_the_mesh_where_there_is_one() -> None:
    points, triangles = Proxy("silhouettes", CORNERS, ProxyMesh(POINTS, TRIANGLES)).surface()
    np.testing.assert_array_equal(points, POINTS)
    np.testing.assert_array_equal(triangles, TRIANGLES)
    assert len(Proxy("silhouettes", CORNERS).surface()[0]) > len(POINTS)


@pytest.mark.parametrize("triangles", [TRIANGLES[:, :2], TRIANGLES + 1], ids=["pairs", "no such point"])
def test_triangles_are_of_points(triangles: np.ndarray) -> None:
    with pytest.raises(ValueError, match="triangles"):
        ProxyMesh(POINTS, triangles)


def test_a_mesh_must_be_one() -> None:
    with pytest.raises(TypeError, match="mesh"):
        Proxy("silhouettes", CORNERS, POINTS)  # type: ignore[arg-type]
