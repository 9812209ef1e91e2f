import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from ashe_live.errors import UserError
from ashe_live.models import loading
from ashe_live.models.loading import load_model_file
from ashe_live.models.mesh import Mesh, Model, face_normals
from ashe_live.models.parsing import limits

EXTENTS = (1.0, 2.0, 3.0)


def _box() -> trimesh.Trimesh:
    return trimesh.creation.box(EXTENTS)


def _exported(path: Path) -> Path:
    _box().export(path)
    return path


def _parts_face_outwards(model: Model) -> bool:
    centre = model.bounds.mean(axis=0)
    return all(
        (
            np.einsum("ij,ij->i", face_normals(p.vertices, p.triangles), p.vertices[p.triangles].mean(axis=1) - centre)
            > 0
        ).all()
        and (np.einsum("ij,ij->i", p.normals, p.vertices - centre) > 0).all()
        for p in model.parts
    )


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl"])
def test_formats_without_an_up_keep_what_is_said(tmp_path: Path, suffix: str) -> None:
    model = load_model_file(_exported(tmp_path / f"box{suffix}"), "z")
    assert model.name == "box"
    np.testing.assert_allclose(model.bounds[1] - model.bounds[0], EXTENTS, rtol=1e-6)
    assert _parts_face_outwards(model)


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_gltf_is_turned_from_y_up_to_z_up(tmp_path: Path, suffix: str) -> None:
    mesh = _box()
    mesh.apply_translation((0, 0, 10))  # towards the glTF viewer
    if suffix == ".glb":
        mesh.export(tmp_path / "box.glb")
    else:
        for name, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh)).items():
            (tmp_path / name.replace("model.gltf", "box.gltf")).write_bytes(content)
    model = load_model_file(tmp_path / f"box{suffix}")
    width, height, depth = EXTENTS
    np.testing.assert_allclose(model.bounds[1] - model.bounds[0], (width, depth, height), rtol=1e-6)
    np.testing.assert_allclose(model.bounds.mean(axis=0), (0, -10, 0), atol=1e-5)
    assert _parts_face_outwards(model)


def test_scene_graph_is_flattened(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    mesh = _box()
    for place in (0.0, 5.0):
        scene.add_geometry(mesh, geom_name="box", transform=trimesh.transformations.translation_matrix((place, 0, 0)))
    scene.export(tmp_path / "two.glb")
    model = load_model_file(tmp_path / "two.glb")
    assert model.triangle_count == 24
    np.testing.assert_allclose(model.bounds[:, 0], (-0.5, 5.5), atol=1e-6)


def test_mirrored_node_still_faces_outwards(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    scene.add_geometry(_box(), transform=np.diag([-1.0, 1, 1, 1]))
    scene.export(tmp_path / "mirrored.glb")
    assert _parts_face_outwards(load_model_file(tmp_path / "mirrored.glb"))


def test_normals_of_the_file_are_kept(tmp_path: Path) -> None:
    sphere = trimesh.creation.icosphere(subdivisions=2)
    sphere.export(tmp_path / "sphere.glb", include_normals=True)
    part = load_model_file(tmp_path / "sphere.glb").parts[0]
    np.testing.assert_allclose(part.normals, part.vertices, atol=0.02)


@pytest.mark.parametrize(("suffix", "with_normals"), [(".ply", "vertex_normal"), (".glb", "include_normals")])
def test_vertices_of_no_triangle_do_not_count(tmp_path: Path, suffix: str, with_normals: str) -> None:
    """They are not seen. Scans have stray points, and primitives of a glTF share their arrays with points and lines."""
    box = _box()
    stray = np.vstack([box.vertices, [(100.0, 100.0, 100.0)]])
    normals = stray / np.linalg.norm(stray, axis=1, keepdims=True)
    with_stray = trimesh.Trimesh(stray, box.faces, vertex_normals=normals, process=False)
    with_stray.export(tmp_path / f"stray{suffix}", **{with_normals: True})
    model = load_model_file(tmp_path / f"stray{suffix}", "z")
    np.testing.assert_allclose(model.bounds, np.outer((-0.5, 0.5), EXTENTS), atol=1e-6)


@pytest.mark.parametrize("stray", ["0 0 0", "nan nan nan", "inf 0 0"])
@pytest.mark.parametrize("normals", ["", " 0 0 1"])
def test_what_no_triangle_names_may_be_anywhere(tmp_path: Path, stray: str, normals: str) -> None:
    """Depth cameras write no numbers where they saw nothing, and a map's scan may have a point at the map's origin."""
    corners = ((5_200_000.25, 4_100_000.5), (5_200_001.5, 4_100_000.5), (5_200_000.25, 4_100_001.0))
    names = [*"xyz", *(("nx", "ny", "nz") if normals else ())]
    header = ["ply", "format ascii 1.0", "element vertex 4", *(f"property double {name}" for name in names)]
    header += ["element face 1", "property list uchar int vertex_indices", "end_header"]
    lines = [f"{stray}{normals}", *(f"{x} {y} 0{normals}" for x, y in corners), "3 1 2 3", ""]
    (tmp_path / "scan.ply").write_text("\n".join(header + lines))
    (part,) = load_model_file(tmp_path / "scan.ply", "z").parts
    np.testing.assert_array_equal(np.ptp(part.vertices, axis=0), (1.25, 0.5, 0))
    np.testing.assert_array_equal(part.normals, [(0, 0, 1)] * 3)
    text = (tmp_path / "scan.ply").read_text()
    (tmp_path / "scan.ply").write_text(text.replace("3 1 2 3", "3 0 2 3"))
    if stray != "0 0 0":
        with pytest.raises(UserError, match="vertices hold a value that is not finite"):
            load_model_file(tmp_path / "scan.ply")


def test_computed_normals_are_smooth_on_a_sphere_and_sharp_on_a_box(tmp_path: Path) -> None:
    trimesh.creation.icosphere(subdivisions=3).export(tmp_path / "sphere.stl")
    part = load_model_file(tmp_path / "sphere.stl").parts[0]
    np.testing.assert_allclose(part.normals, part.vertices, atol=0.02)
    box = load_model_file(_exported(tmp_path / "box.stl")).parts[0]
    np.testing.assert_allclose(
        np.sort(np.abs(box.normals), axis=1), np.tile((0, 0, 1), (len(box.normals), 1)), atol=1e-6
    )


def _textured(folder: Path, size: tuple[int, int]) -> Path:
    visual = trimesh.visual.TextureVisuals(
        uv=[(0, 0), (1, 0), (1, 1), (0, 1)],
        material=trimesh.visual.material.PBRMaterial(
            baseColorTexture=Image.new("RGB", size, (255, 0, 0)), baseColorFactor=[128, 255, 255, 255]
        ),
    )
    mesh = trimesh.Trimesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)], visual=visual)
    mesh.export(folder / "quad.glb")
    return folder / "quad.glb"


def test_texture_and_factor_arrive(tmp_path: Path) -> None:
    part = load_model_file(_textured(tmp_path, (8, 4))).parts[0]
    assert part.material.base_map is not None
    assert part.uvs is not None
    assert part.material.base_map.shape == (4, 8, 4)
    assert tuple(part.material.base_map[0, 0]) == (255, 0, 0, 255)
    assert part.material.base_colour == pytest.approx((128 / 255, 1, 1, 1), abs=1e-6)


def test_large_texture_is_reduced(tmp_path: Path) -> None:
    part = load_model_file(_textured(tmp_path, (4096, 1024))).parts[0]
    assert part.material.base_map is not None
    assert part.material.base_map.shape == (512, 2048, 4)


def test_vertex_colours_of_ply_are_decoded_to_linear(tmp_path: Path) -> None:
    mesh = _box()
    mesh.visual.vertex_colors = np.tile((188, 255, 0, 255), (8, 1)).astype(np.uint8)
    mesh.export(tmp_path / "box.ply")
    colours = load_model_file(tmp_path / "box.ply").parts[0].colours
    assert colours is not None
    np.testing.assert_allclose(colours[0], (0.5, 1, 0, 1), atol=0.005)


def test_obj_reads_its_texture_beside_it(tmp_path: Path) -> None:
    assert _obj_with_texture(tmp_path, "red.png").material.base_map is not None


@pytest.mark.parametrize("name", ["../secret.png", "/etc/hostname"])
def test_nothing_outside_the_folder_is_read(tmp_path: Path, name: str) -> None:
    Image.new("RGB", (2, 2)).save(tmp_path / "secret.png")
    (tmp_path / "model").mkdir()
    assert not _obj_with_texture(tmp_path / "model", name).material.maps


def test_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    Image.new("RGB", (2, 2)).save(tmp_path / "secret.png")
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "link.png").symlink_to(tmp_path / "secret.png")
    assert not _obj_with_texture(tmp_path / "model", "link.png").material.maps


def _obj_with_texture(folder: Path, texture: str) -> Mesh:
    Image.new("RGB", (2, 2), (255, 0, 0)).save(folder / "red.png")
    (folder / "a.mtl").write_text(f"newmtl m\nmap_Kd {texture}\n")
    (folder / "a.obj").write_text(
        "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    )
    return load_model_file(folder / "a.obj").parts[0]


def test_gltf_buffer_outside_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "model").mkdir()
    (tmp_path / "secret.bin").write_bytes(np.eye(3, dtype=np.float32).tobytes())
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "../secret.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    (tmp_path / "model" / "a.gltf").write_text(json.dumps(document))
    with pytest.raises(UserError, match="outside its own folder"):
        load_model_file(tmp_path / "model" / "a.gltf")
    (tmp_path / "secret.bin").rename(tmp_path / "model" / "own.bin")
    document["buffers"] = [{"uri": "own.bin", "byteLength": 36}]
    (tmp_path / "model" / "a.gltf").write_text(json.dumps(document))
    assert load_model_file(tmp_path / "model" / "a.gltf").triangle_count == 1


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.obj", b""),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n"),
        ("words.obj", b"v one two three\nf 1 2 3\n"),
        ("out_of_range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("nan.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("one_point.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
        ("noise.glb", bytes(range(256)) * 4),
        ("short.glb", b"glTF"),
        ("noise.ply", b"ply\nformat ascii 1.0\nelement vertex 1000000000000\nend_header\n"),
        ("noise.stl", b"\x00" * 80 + b"\xff\xff\xff\xff"),
        ("list.gltf", b"[]"),
        ("deep.gltf", b"[" * 100_000),
    ],
)
def test_malformed_file_is_one_clear_line(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UserError) as caught:
        load_model_file(tmp_path / name)
    assert name in caught.value.message
    assert "\n" not in str(caught.value)


def test_truncated_model_is_refused(tmp_path: Path) -> None:
    whole = _exported(tmp_path / "box.glb").read_bytes()
    (tmp_path / "box.glb").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UserError, match="malformed"):
        load_model_file(tmp_path / "box.glb")


def test_limits_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = _exported(tmp_path / "box.stl")
    monkeypatch.setattr(limits, "MAX_TRIANGLES", 11)
    with pytest.raises(UserError, match="12 triangles"):
        load_model_file(path)
    monkeypatch.setattr(loading, "MAX_FILE_BYTES", 100)
    with pytest.raises(UserError, match="too large"):
        load_model_file(path)


def test_missing_or_unknown_files(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="there is no file"):
        load_model_file(tmp_path / "none.obj")
    (tmp_path / "model.zip").touch()
    with pytest.raises(UserError, match="not a supported kind of model file"):
        load_model_file(tmp_path / "model.zip")
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(UserError, match="is a folder"):
        load_model_file(tmp_path / "folder.obj")


def test_what_a_library_raises_without_memory_is_no_fault_of_the_file(tmp_path, monkeypatch) -> None:
    def failing(_path, _up):
        raise RuntimeError("can't start new thread")

    (tmp_path / "ball.ply").write_bytes(b"ply\n")
    monkeypatch.setattr(loading, "_read", failing)
    with pytest.raises(UserError, match="malformed"):
        load_model_file(tmp_path / "ball.ply")
    monkeypatch.setattr(loading, "SPARE_BYTES", 1 << 62)  # which no machine has
    with pytest.raises(MemoryError, match="new thread"):
        load_model_file(tmp_path / "ball.ply")
