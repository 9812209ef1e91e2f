"""Files that are valid and unlike those that our own tools write: each is drawn, or what is missing is named."""

import base64
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
    [("a.txt", "cannot be read"), ("torn.png", "torn.png is damaged")],
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


@pytest.mark.parametrize("name", ["sky.exr", "leaf.ktx", "leaf.svg", "leaf.png"])
def test_of_a_texture_of_an_unknown_kind_it_is_said_what_to_do_with_that(tmp_path: Path, name: str) -> None:
    """Nothing is wrong with the model, which to export again would not help."""
    (tmp_path / name).write_bytes(b"\x76\x2f\x31\x01" + bytes(99))
    (tmp_path / "a.mtl").write_text(f"newmtl m\nmap_Kd {name}\n")
    (tmp_path / "a.obj").write_text(f"mtllib a.mtl\nusemtl m\n{TRIANGLE}")
    with pytest.raises(UserError) as caught:
        load_model_file(tmp_path / "a.obj")
    assert caught.value.message.endswith(f"its texture {name} cannot be read, as it is no picture of a known kind")
    assert caught.value.remedy == "save that as PNG or JPEG, or copy it again"


@pytest.mark.parametrize("texture", ["gone.png", "D:\\maps\\gone.png", "/home/me/gone.png", "../gone.png"])
def test_without_its_texture_a_material_has_its_colour(tmp_path: Path, texture: str) -> None:
    """Black, which some programs write beside every texture, is none."""
    (tmp_path / "a.mtl").write_text(f"newmtl m\nKd 0 0 0\nmap_Kd {texture}\nnewmtl n\nKd 1 0 0\nmap_Kd {texture}\n")
    (tmp_path / "a.obj").write_text(f"mtllib a.mtl\nusemtl m\n{TRIANGLE}usemtl n\nf 1 2 3\n")
    model = load_model_file(tmp_path / "a.obj")
    assert [part.material.base_colour for part in model.parts] == [(1, 1, 1, 1), (1, 0, 0, 1)]
    assert f"its picture {texture} is not beside it, and is left out" in model.notes


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


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".gltf"])
def test_text_may_begin_with_a_byte_order_mark(tmp_path: Path, suffix: str, encoding: str) -> None:
    """As PowerShell and Notepad write it; before the first place of an OBJ as well."""
    points = base64.b64encode(np.array(((0, 0, 0), (1, 0, 0), (0, 1, 0)), np.float32).tobytes()).decode()
    text = {
        ".obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        ".ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        ".stl": "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "endsolid a\n",
        ".gltf": '{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],'
        ' "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],'
        ' "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],'
        ' "bufferViews": [{"buffer": 0, "byteLength": 36}],'
        f' "buffers": [{{"byteLength": 36, "uri": "data:;base64,{points}"}}]}}',
    }[suffix]
    path = tmp_path / f"a{suffix}"
    path.write_bytes(text.encode(encoding))
    assert load_model_file(path).triangle_count == 1


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.glb", b"<!DOCTYPE html><html>", "holds a page of the web"),
        ("a.glb", b"version https://git-lfs.github.com/spec/v1\n", "holds a pointer of Git LFS"),
        ("a.obj", b"PK\x03\x04....", "holds a ZIP archive"),
        ("a.obj", b"glTF\x02\0\0\0", "holds GLB: rename it to end in .glb"),
        ("a.stl", b"ply\nformat ascii 1.0\n", "holds PLY: rename it to end in .ply"),
        ("a.ply", b"", "is empty"),
        ("a.glb", b"mug", "begins neither as GLB does nor as JSON"),
        ("a.obj", b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "holds no triangle that has an area"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n", "a face names vertex -9 of 3"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/4\n", "a face names texture coordinate 4 of 1"),
    ],
)
def test_what_a_file_really_is_is_said(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError, match=said):
        load_model_file(tmp_path / name)
