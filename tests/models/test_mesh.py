import numpy as np
import pytest

from ashe_live.models.mesh import Mesh, Model, Motion, face_normals
from ashe_live.models.primitives import box, revolved

TRIANGLE = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dtype=np.float32)
UP = np.tile(np.float32((0, 0, 1)), (3, 1))


def test_arrays_are_read_only() -> None:
    mesh = Mesh(TRIANGLE.copy(), UP, np.array([(0, 1, 2)]))
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0, 0] = 1.0


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (TRIANGLE * np.nan, [(0, 1, 2)], "not finite"),
        (TRIANGLE, [(0, 1, 3)], "names vertex 3 of 3"),
        (TRIANGLE, np.zeros((0, 3)), "without triangles"),
        (TRIANGLE[:, :2], [(0, 1, 2)], "shape"),
    ],
)
def test_wrong_arrays_are_wrong_use(vertices: np.ndarray, triangles: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Mesh(vertices, UP, np.array(triangles))


def test_normals_without_direction_are_wrong_use() -> None:
    """A shader would make them unit vectors, and draw what is not a number as white."""
    normals = UP * np.float32([(1,), (0,), (1,)])
    with pytest.raises(ValueError, match="length zero"):
        Mesh(TRIANGLE, normals, np.array([(0, 1, 2)]))
    with pytest.raises(ValueError, match="length zero"):
        Motion(np.stack([TRIANGLE, TRIANGLE]), np.stack([UP, normals]), 1.0)


def test_model_without_parts_is_wrong_use() -> None:
    with pytest.raises(ValueError, match="without parts"):
        Model("nothing", ())


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (box((1, 2, 3)), 6.0),
        (revolved([(0, 0), (1, 0), (1, 2), (0, 2)], 256), 2 * np.pi),
        (revolved([(0, 0), (1, 0), (0, 3)], 256), np.pi),
    ],
)
def test_primitives_are_closed_and_face_outwards(mesh: Mesh, volume: float) -> None:
    # The divergence theorem: only a closed surface that faces outwards everywhere has this volume.
    corners = mesh.vertices[mesh.triangles].astype(float)
    enclosed = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert enclosed == pytest.approx(volume, rel=1e-3)
    along = np.einsum("ij,ij->i", face_normals(mesh.vertices, mesh.triangles), mesh.normals[mesh.triangles].sum(axis=1))
    assert (along > 0).all()
