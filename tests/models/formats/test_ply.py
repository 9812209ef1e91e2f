"""PLY as programs write it: text or bytes of either order, polygons of any size, whatever else is in between."""

import struct
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import trimesh

from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.loading import load_model_file
from ashe_live.models.mesh import Mesh

PLACES = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (5, 5, 3), (5, 0, 3)]
FACES = [(0, 1, 2, 3, 4), (0, 4, 5), (1, 6, 5, 2)]
PENTAGON, TRIANGLE, SLOPE = 3.0, np.linalg.norm(np.cross((0, 1, 0), (5, 5, 3))) / 2, 9 * np.sqrt(2)
FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


def header(kind: str, faces: int = 3, face: str = "", vertex: str = "", before: str = "") -> str:
    return (
        f"ply\nformat {kind} 1.0\ncomment by hand\n{before}element vertex {len(PLACES)}\n"
        f"property float x\nproperty float y\nproperty float z\n{vertex}element face {faces}\n"
        f"{face}property list uchar int vertex_indices\nend_header\n"
    )


def area(part: Mesh) -> float:
    a, b, c = np.moveaxis(part.vertices[part.triangles].astype(float), 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def written(kind: str, path: Path) -> Path:
    """Two numbers stand before each face's list, and an element that nobody knows before all."""
    order = FORMATS[kind]
    extra = "property uchar flag\nproperty double weight\n"
    text = header(kind, face=extra, before="element camera 2\nproperty short k\nproperty list ushort float more\n")
    if kind == "ascii":
        lines = ["3 2 0.5 1.5", "4 0", *(f"{x} {y} {z}" for x, y, z in PLACES)]
        lines += [f"7 0.25 {len(face)} {' '.join(map(str, face))}" for face in FACES]
        path.write_text(text + "\n".join(lines) + "\n")
        return path
    content = struct.pack(f"{order}hHffhH", 3, 2, 0.5, 1.5, 4, 0)
    content += b"".join(struct.pack(f"{order}3f", *place) for place in PLACES)
    for face in FACES:
        content += struct.pack(f"{order}BdB{len(face)}i", 7, 0.25, len(face), *face)
    path.write_bytes(text.encode() + content)
    return path


@pytest.mark.parametrize("kind", FORMATS)
def test_polygons_of_different_sizes_stand_in_one_file(tmp_path: Path, kind: str) -> None:
    model = load_model_file(written(kind, tmp_path / "a.ply"), up="z")
    assert model.triangle_count == 3 + 1 + 2
    (part,) = model.parts
    assert {tuple(row) for row in part.vertices.tolist()} == set(PLACES)
    flat = part.vertices[part.triangles][:, :, 2].max(axis=1) == 0
    only = area(Mesh(part.vertices, part.normals, part.triangles[flat]))
    assert only == pytest.approx(PENTAGON, rel=1e-6)
    assert area(part) == pytest.approx(PENTAGON + TRIANGLE + SLOPE, rel=1e-6)


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_trimesh_reads_the_same_of_what_it_writes(tmp_path: Path, encoding: str) -> None:
    mesh = trimesh.creation.annulus(0.5, 1.0, 2.0)
    (tmp_path / "a.ply").write_bytes(trimesh.exchange.ply.export_ply(mesh, encoding=encoding))
    (part,) = load_model_file(tmp_path / "a.ply", up="z").parts
    assert area(part) == pytest.approx(mesh.area, rel=1e-4)
    np.testing.assert_allclose([part.vertices.min(axis=0), part.vertices.max(axis=0)], mesh.bounds, atol=1e-5)


def test_colours_may_be_fractions_or_bytes_with_an_alpha(tmp_path: Path) -> None:
    for kind, whole, alpha in (
        ("uchar", 255, "alpha"),
        ("float", 1.0, "a"),
        ("float", 255, "alpha"),
        ("ushort", 65535, "alpha"),
        ("int", 255, "alpha"),
        ("uint32", 255, "a"),
    ):
        names = "".join(f"property {kind} {name}\n" for name in ("red", "green", "blue", alpha))
        given = [value * whole for value in (1.0, 0.0, 0.2, 0.6)]
        rows = "".join(f"{x} {y} {z} {' '.join(f'{value:g}' for value in given)}\n" for x, y, z in PLACES)
        (tmp_path / "a.ply").write_text(header("ascii", 1, vertex=names) + rows + "3 0 1 2\n")
        (part,) = load_model_file(tmp_path / "a.ply").parts
        assert part.colours is not None
        np.testing.assert_allclose(part.colours[0], (1, 0, linear_from_srgb(np.array(0.2)), 0.6), atol=1e-4)


def test_alpha_is_of_the_largest_value_that_itself_shows(tmp_path: Path) -> None:
    """And a colour a little brighter than white is no byte."""
    names = "".join(f"property float {name}\n" for name in ("red", "green", "blue", "alpha"))
    for rgb, alpha, shares in (("255 0 51", "0.6", (1, 0, 0.2, 0.6)), ("1.5 0 0.2", "153", (1, 0, 0.2, 0.6))):
        rows = "".join(f"{x} {y} {z} {rgb} {alpha}\n" for x, y, z in PLACES)
        (tmp_path / "a.ply").write_text(header("ascii", 1, vertex=names) + rows + "3 0 1 2\n")
        (part,) = load_model_file(tmp_path / "a.ply").parts
        assert part.colours is not None
        expected = (*linear_from_srgb(np.array(shares[:3])), shares[3])
        np.testing.assert_allclose(part.colours[0], expected, atol=1e-4)


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    "before",
    [
        "comment what follows end_header is the mesh\n",
        "element edge 0\nproperty int vertex1\nproperty int vertex2\n",
        "element edge 0\nproperty list uchar int vertices\n",
        "element nothing 3\n",
    ],
)
def test_what_holds_nothing_and_what_comments_say_changes_nothing(tmp_path: Path, kind: str, before: str) -> None:
    content = written(kind, tmp_path / "a.ply").read_bytes()
    (tmp_path / "b.ply").write_bytes(content.replace(b"element vertex", before.encode() + b"element vertex"))
    (plain,), (other,) = (load_model_file(tmp_path / name, up="z").parts for name in ("a.ply", "b.ply"))
    np.testing.assert_array_equal(other.vertices, plain.vertices)
    np.testing.assert_array_equal(other.triangles, plain.triangles)


def test_corners_may_have_texture_coordinates_of_their_own(tmp_path: Path) -> None:
    PIL.Image.fromarray(np.full((2, 2, 3), 80, np.uint8)).save(tmp_path / "a.png")
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in PLACES)
    faces = "6 0 0 1 0 1 1 3 0 1 2\n6 0.5 0.5 0.25 0.5 0 0.75 3 0 2 4\n"
    head = header("ascii", 2, face="property list uchar float texcoord\n").replace("by hand", "TextureFile a.png")
    (tmp_path / "a.ply").write_text(head + rows + faces)
    (part,) = load_model_file(tmp_path / "a.ply", up="z").parts
    assert part.material.maps
    assert part.uvs is not None
    found = {(*place[:2], *uv) for place, uv in zip(part.vertices.tolist(), part.uvs.tolist(), strict=True)}
    assert found == {(0, 0, 0, 0), (2, 0, 1, 0), (2, 1, 1, 1), (0, 0, 0.5, 0.5), (2, 1, 0.25, 0.5), (0, 1, 0, 0.75)}


def test_where_triangles_have_something_of_their_own_vertices_keep_the_rest(tmp_path: Path) -> None:
    """Colours of faces beside texture coordinates of vertices, and the other way round; normals with both."""
    PIL.Image.fromarray(np.full((2, 2, 3), 80, np.uint8)).save(tmp_path / "a.png")
    of_vertices = "".join(f"property float {name}\n" for name in ("nx", "ny", "nz", "s", "t"))
    colours = "".join(f"property float {name}\n" for name in ("red", "green", "blue"))
    normals = [(0.6, 0, 0.8) if x else (0, 0.6, 0.8) for x, _, _ in PLACES]
    rows = [f"{x} {y} {z} {a} {b} {c} {x / 4} {y / 4}" for (x, y, z), (a, b, c) in zip(PLACES, normals, strict=True)]
    head = header("ascii", 1, vertex=of_vertices, face=colours).replace("by hand", "TextureFile a.png")
    (tmp_path / "a.ply").write_text(head + "\n".join([*rows, "1 0 0 3 0 1 2", ""]))
    (part,) = load_model_file(tmp_path / "a.ply", up="z").parts
    np.testing.assert_allclose(part.uvs, part.vertices[:, :2] / 4)
    np.testing.assert_allclose(part.normals, [(0.6, 0, 0.8) if x else (0, 0.6, 0.8) for x, _, _ in part.vertices])
    np.testing.assert_allclose(part.colours, [(1, 0, 0, 1)] * 3)

    rows = [f"{x} {y} {z} {x / 2} 0 0" for x, y, z in PLACES]
    head = header("ascii", 1, vertex=colours, face="property list uchar float texcoord\n")
    (tmp_path / "a.ply").write_text(
        head.replace("by hand", "TextureFile a.png") + "\n".join([*rows, "6 0 0 1 0 1 1 3 1 2 4", ""])
    )
    (part,) = load_model_file(tmp_path / "a.ply", up="z").parts
    np.testing.assert_allclose(part.colours[:, 0], part.vertices[:, 0] / 2)


def test_without_its_texture_it_is_drawn_plain(tmp_path: Path) -> None:
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in PLACES)
    (tmp_path / "a.ply").write_text(header("ascii", 1).replace("by hand", "TextureFile gone.png") + rows + "3 0 1 2\n")
    model = load_model_file(tmp_path / "a.ply")
    assert model.notes == ("its picture gone.png is not beside it, and is left out",)


def test_texture_coordinates_that_nothing_uses_may_be_no_numbers(tmp_path: Path) -> None:
    rows = "".join(f"{x} {y} {z} nan nan\n" for x, y, z in PLACES)
    (tmp_path / "a.ply").write_text(
        header("ascii", 1, vertex="property float s\nproperty float t\n") + rows + "3 0 1 2\n"
    )
    assert load_model_file(tmp_path / "a.ply").triangle_count == 1


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("3 0 1 7\n", "a face names vertex 7 of 7"),
        ("3 0 -1 2\n", "a face names vertex -1 of 7"),
        ("3 0 1\n", "a list vertex_indices is said to have 3 values"),
        ("", "its header says element face 1, and it ends before"),
        ("3 0 1 two\n", "face has a value that is no number"),
        ("-1 0 1 2\n", "a list vertex_indices is said to have -1 values"),
    ],
)
def test_what_is_wrong_is_said_in_the_formats_words(tmp_path: Path, body: str, said: str) -> None:
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in PLACES)
    (tmp_path / "a.ply").write_text(header("ascii", 1) + rows + body)
    with pytest.raises(UserError) as caught:
        load_model_file(tmp_path / "a.ply")
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("format ascii", "format morse", "its header names no format that is known"),
        ("property float x", "property complex x", "its header has a line of property that cannot be read"),
        ("property float y", "property float x", "two properties of vertex have one name"),
        ("uchar int", "float int", "have lengths that are no whole numbers"),
        ("property float z\n", "", "its vertices have no x, y and z"),
        ("vertex_indices", "friends", "its faces name no vertices"),
        ("end_header", "", "it has no PLY header"),
    ],
)
def test_headers_that_cannot_be_meant_are_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    rows = "".join("0 0 0\n" for _ in PLACES)
    (tmp_path / "a.ply").write_text((header("ascii", 1) + rows + "3 0 1 2\n").replace(old, new))
    with pytest.raises(UserError) as caught:
        load_model_file(tmp_path / "a.ply")
    assert said in str(caught.value)


@pytest.mark.parametrize("kind", FORMATS)
def test_an_element_without_items_and_a_list_without_values_may_end_the_file(tmp_path: Path, kind: str) -> None:
    text = header(kind, 2).replace("end_header", "element strips 0\nproperty list int int vertex_indices\nend_header")
    if kind == "ascii":
        content = "".join(f"{x} {y} {z}\n" for x, y, z in PLACES) + "3 0 1 2\n0\n"
    else:
        numbers = (struct.pack(f"{FORMATS[kind]}3f", *place) for place in PLACES)
        content = (b"".join(numbers) + struct.pack(f"{FORMATS[kind]}B3iB", 3, 0, 1, 2, 0)).decode("latin-1")
    (tmp_path / "a.ply").write_text(text + content, encoding="latin-1")
    assert load_model_file(tmp_path / "a.ply").triangle_count == 1


def test_a_cloud_of_points_is_said_to_be_one(tmp_path: Path) -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    (tmp_path / "a.ply").write_text(f"{head}end_header\n0 0 0\n")
    with pytest.raises(UserError, match="holds no triangles: points and lines are left out"):
        load_model_file(tmp_path / "a.ply")


def test_of_several_textures_one_is_drawn_with_a_word(tmp_path: Path) -> None:
    for name in ("a", "b"):
        PIL.Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / f"{name}.png")
    head = "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\nelement vertex 3\n"
    names = "".join(f"property float {name}\n" for name in "xyzst")
    (tmp_path / "a.ply").write_text(
        f"{head}{names}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"
    )
    assert load_model_file(tmp_path / "a.ply").notes == ("one of its 2 textures is drawn, on all of it",)


@pytest.mark.parametrize("kind", FORMATS)
def test_lines_may_end_in_carriage_returns_alone(tmp_path: Path, kind: str) -> None:
    """As the format's description has them."""
    content = written(kind, tmp_path / "a.ply").read_bytes()
    begin = content.index(b"end_header\n") + len(b"end_header\n")
    rest = content[begin:].replace(b"\n", b"\r") if kind == "ascii" else content[begin:]
    (tmp_path / "b.ply").write_bytes(content[:begin].replace(b"\n", b"\r") + rest)
    (plain,), (other,) = (load_model_file(tmp_path / name, up="z").parts for name in ("a.ply", "b.ply"))
    np.testing.assert_array_equal(other.vertices, plain.vertices)
    np.testing.assert_array_equal(other.triangles, plain.triangles)
