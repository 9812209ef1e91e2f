"""Files that are valid and unlike those that our own tools write: each is drawn, or what is missing is named."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ashe_live.errors import UserError
from ashe_live.models.loading import load_model_file

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"


def test_texture_coordinates_without_a_material_are_no_texture(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(TRIANGLE)
    assert load_model_file(tmp_path / "a.obj").parts[0].material.maps == {}
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"
    )
    assert load_model_file(tmp_path / "a.ply").parts[0].material.maps == {}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "cp1252", "shift-jis"])
def test_an_obj_and_its_materials_are_read_in_any_encoding(tmp_path: Path, encoding: str) -> None:
    name = "表面" if encoding == "shift-jis" else "blø"
    (tmp_path / "a.mtl").write_bytes(f"# {name}\nnewmtl {name}\nKd 1 0 0\n".encode(encoding))
    (tmp_path / "a.obj").write_bytes(f"# {name}\nmtllib a.mtl\nusemtl {name}\n{TRIANGLE}".encode(encoding))
    assert load_model_file(tmp_path / "a.obj").parts[0].material.base_colour == (1, 0, 0, 1)


def test_each_triangle_of_a_ply_may_have_a_colour(tmp_path: Path) -> None:
    """Neighbours share corners and not colours."""
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n"
    )
    part = load_model_file(tmp_path / "a.ply").parts[0]
    colours = part.colours[part.triangles]
    assert len(colours) == 2
    for triangle, colour in zip(part.triangles, colours, strict=True):
        is_right = part.vertices[triangle][:, 0].sum() == 2  # the one that has two corners at x = 1
        np.testing.assert_allclose(colour, [(1, 0, 0, 1) if is_right else (0, 0, 1, 1)] * 3)


def test_a_line_of_an_obj_may_go_on_in_the_next(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(b"v 0 0 \\\r\n0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2\\\r\n3\r\n")
    assert load_model_file(tmp_path / "a.obj").triangle_count == 1


@pytest.mark.parametrize(
    ("texture", "said"),
    [("gone.png", "which is missing"), ("a.txt", "cannot be read"), ("torn.png", "torn.png is damaged")],
)
def test_a_texture_that_cannot_be_had_is_named(tmp_path: Path, texture: str, said: str) -> None:
    (tmp_path / "a.txt").write_text("no picture")
    picture = io.BytesIO()
    Image.fromarray(np.random.default_rng(1).integers(0, 255, (64, 64, 3), np.uint8)).save(picture, "PNG")
    (tmp_path / "torn.png").write_bytes(picture.getvalue()[:2000])
    (tmp_path / "a.mtl").write_text(f"newmtl m\nmap_Kd {texture}\n")
    (tmp_path / "a.obj").write_text(f"mtllib a.mtl\nusemtl m\n{TRIANGLE}")
    with pytest.raises(UserError, match=said) as caught:
        load_model_file(tmp_path / "a.obj")
    assert texture in caught.value.message


def test_a_texture_in_a_folder_is_found_however_its_path_is_written(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    Image.new("RGB", (4, 4), (255, 0, 0)).save(tmp_path / "maps" / "a.png")
    for path in ("maps/a.png", "maps\\a.png", ".\\maps\\a.png"):
        (tmp_path / "a.mtl").write_text(f"newmtl m\nmap_Kd {path}\n")
        (tmp_path / "a.obj").write_text(f"mtllib a.mtl\nusemtl m\n{TRIANGLE}")
        assert "base_map" in load_model_file(tmp_path / "a.obj").parts[0].material.maps


def test_a_cone_of_thousands_of_triangles_has_one_tip_and_smooth_sides(tmp_path: Path) -> None:
    """Around the tip its normals differ by up to twice the sides' slope; each averages those near it."""
    count, height = 5000, 2.0
    angles = np.arange(count) * (2 * np.pi / count)
    lines = [f"v 0 0 {height}", *(f"v {np.cos(angle)} {np.sin(angle)} 0" for angle in angles)]
    lines += [f"f 1 {at + 2} {(at + 1) % count + 2}" for at in range(count)]
    (tmp_path / "cone.obj").write_text("\n".join(lines))
    part = load_model_file(tmp_path / "cone.obj").parts[0]
    corners = part.triangles
    middle = part.vertices[corners].mean(axis=1)
    outwards = np.column_stack(
        [middle[:, :2] / np.linalg.norm(middle[:, :2], axis=1, keepdims=True) * height, np.ones(count)]
    )
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    for corner in range(3):
        along = np.einsum("ij,ij->i", part.normals[corners[:, corner]], outwards)
        assert along.min() > np.cos(np.radians(10))
