"""Meshes that are not as they should be: a right model all the same, or one clear line."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh.visual.material import PBRMaterial

from ashe_live.errors import UserError
from ashe_live.models.assembly.shading_normals import row_keys
from ashe_live.models.loading import load_model_file
from ashe_live.models.mesh import Mesh, face_normals


def _volume(part: Mesh) -> float:
    corner = part.vertices[part.triangles[:, 0]].astype(float)
    return float(np.einsum("ij,ij->", face_normals(part.vertices, part.triangles), corner)) / 6


@pytest.mark.parametrize("suffix", [".glb", ".stl", ".ply", ".obj"])
@pytest.mark.parametrize("with_normals", [True, False])
def test_closed_model_that_is_inside_out_is_turned(tmp_path: Path, suffix: str, with_normals: bool) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.invert()
    path = tmp_path / f"ball{suffix}"
    if suffix == ".stl":
        ball.export(path)
    else:
        ball.export(path, **{"include_normals" if suffix in (".glb", ".obj") else "vertex_normal": with_normals})
    part = load_model_file(path).parts[0]
    assert _volume(part) > 4
    assert (np.einsum("ij,ij->i", part.normals, part.vertices) > 0.9).all()


@pytest.mark.parametrize("with_normals", [True, False])
@pytest.mark.parametrize("double_sided", [True, False])
def test_a_closed_surface_seen_from_one_side_faces_as_its_file_says(tmp_path, with_normals, double_sided) -> None:
    """As a black hull that faces inwards outlines the figure within it, and a room without its front wall is seen."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.invert()
    ball.visual = trimesh.visual.TextureVisuals(material=PBRMaterial(doubleSided=double_sided))
    path = tmp_path / "hull.glb"
    ball.export(path, include_normals=with_normals)
    (part,) = load_model_file(path).parts
    assert part.material.double_sided == double_sided
    assert (_volume(part) > 4) if double_sided else (_volume(part) < -4)
    assert part.faces_inwards != double_sided  # what is within such a hull stands in the light


def test_open_model_keeps_the_side_that_its_file_says(tmp_path: Path) -> None:
    (tmp_path / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 3 2\nf 1 4 3\n")
    np.testing.assert_allclose(load_model_file(tmp_path / "sheet.obj").parts[0].normals, [(0, 0, -1)] * 4, atol=1e-6)


def test_degenerate_triangles_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "some.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 2\nf 1 2 4\n")
    part = load_model_file(tmp_path / "some.obj").parts[0]
    assert len(part.triangles) == 1
    np.testing.assert_allclose(part.normals, [(0, 0, 1)] * 3)
    (tmp_path / "all.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    with pytest.raises(UserError, match="no triangle that has an area"):
        load_model_file(tmp_path / "all.obj")


@pytest.mark.parametrize("value", ["nan", "inf", "1e300"])
def test_vertices_that_are_no_numbers_are_said(tmp_path: Path, value: str) -> None:
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
        f"0 0 0\n1 0 0\n0 1 0\n0 0 {value}\n3 0 1 2\n3 0 1 3\n"
    )
    with pytest.raises(UserError, match=r"a\.ply"):
        load_model_file(tmp_path / "a.ply")


def test_texture_coordinates_that_are_no_numbers_are_said(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1e41 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    with pytest.raises(UserError, match="uvs hold a value that is not finite"):
        load_model_file(tmp_path / "a.obj")


@pytest.mark.parametrize("broken", [0.0, np.nan])
def test_normals_that_are_no_directions_are_computed_anew_and_the_others_kept(tmp_path: Path, broken: float) -> None:
    """Those of so coarse a ball would otherwise be flat, as its triangles lean by more than a crease."""
    ball = trimesh.creation.uv_sphere(count=(6, 8))
    normals = np.array(ball.vertices)
    normals[[0, 20]] = broken
    trimesh.Trimesh(ball.vertices, ball.faces, vertex_normals=normals, process=False).export(
        tmp_path / "ball.glb", include_normals=True
    )
    part = load_model_file(tmp_path / "ball.glb").parts[0]
    true = part.vertices - part.bounds.mean(axis=0)
    true /= np.linalg.norm(true, axis=1, keepdims=True)
    assert len(part.vertices) == len(ball.vertices)
    cosines = np.sort(np.einsum("ij,ij->i", true, part.normals))
    assert cosines[2:].min() > 0.9999
    assert cosines[:2].min() > 0.95


def test_a_file_whose_normals_are_hardly_ever_directions_gets_others(tmp_path: Path) -> None:
    box = trimesh.creation.box((1, 1, 1))
    normals = np.zeros_like(box.vertices)
    normals[0] = box.vertices[0]
    trimesh.Trimesh(box.vertices, box.faces, vertex_normals=normals, process=False).export(
        tmp_path / "box.glb", include_normals=True
    )
    part = load_model_file(tmp_path / "box.glb").parts[0]
    np.testing.assert_allclose(np.abs(part.normals).max(axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".ply"])
def test_formats_without_materials_look_like_matt_plastic(tmp_path: Path, suffix: str) -> None:
    trimesh.creation.box((1, 1, 1)).export(tmp_path / f"box{suffix}")
    material = load_model_file(tmp_path / f"box{suffix}").parts[0].material
    assert material.metallic == 0
    assert 0.5 <= material.roughness <= 0.9
    assert material.double_sided
    assert min(material.base_colour[:3]) > 0.1


def test_corners_that_are_alike_are_one_vertex(tmp_path: Path) -> None:
    """STL keeps three corners for each triangle: a smooth ball needs a sixth of them, a box's faces four each."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.export(tmp_path / "ball.stl")
    assert len(load_model_file(tmp_path / "ball.stl").parts[0].vertices) == len(ball.vertices)
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "box.stl")
    assert len(load_model_file(tmp_path / "box.stl").parts[0].vertices) == 24


def test_places_have_one_key_each() -> None:
    points = np.random.default_rng(2).integers(-20, 20, (20_000, 3)).astype(np.float32)
    points[points == 0] *= np.random.default_rng(3).choice([-1, 1], (points == 0).sum())  # zeros of both signs
    _, by_key = np.unique(row_keys(points), return_inverse=True)
    _, by_row = np.unique(points + 0.0, axis=0, return_inverse=True)
    pairs = np.unique(np.column_stack([by_key.ravel(), by_row.ravel()]), axis=0)
    assert len(pairs) == by_key.max() + 1 == by_row.max() + 1
