"""Everything that glTF's metallic-roughness materials say arrives, from wherever its textures lie."""

import base64
import json
import struct
import zlib
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pytest
from PIL import Image

from ashe_live.errors import UserError
from ashe_live.models.gltf.amounts import amounts_of
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import Alpha
from ashe_live.models.mesh import face_normals
from ashe_live.models.parsing import limits
from tests.models.gltf_files import CORNERS, UVS, Document, png

RED, GREEN = (255, 0, 0, 255), (0, 200, 0, 255)


def test_every_number_and_map_arrives(tmp_path: Path) -> None:
    document = Document()
    maps = [document.embedded(png((10 * k, 20, 30, 255))) for k in range(5)]
    document.quad(
        material={
            "pbrMetallicRoughness": {
                "baseColorFactor": [1, 0.5, 0.25, 0.75],
                "baseColorTexture": maps[0],
                "metallicFactor": 0.3,
                "roughnessFactor": 0.6,
                "metallicRoughnessTexture": maps[1],
            },
            "normalTexture": {**maps[2], "scale": 0.7},
            "occlusionTexture": {**maps[3], "strength": 0.4},
            "emissiveFactor": [1, 0.5, 0],
            "emissiveTexture": maps[4],
            "alphaMode": "MASK",
            "alphaCutoff": 0.35,
            "doubleSided": True,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3.0}},
        },
        TEXCOORD_0=document.accessor(UVS),
    )
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    material = part.material
    assert material.base_colour == pytest.approx((1, 0.5, 0.25, 0.75), abs=1 / 255)
    assert (material.metallic, material.roughness) == (0.3, 0.6)
    assert (material.normal_scale, material.occlusion_strength, material.alpha_cutoff) == (0.7, 0.4, 0.35)
    assert material.emissive == pytest.approx((3.0, 1.5, 0.0))
    assert material.alpha is Alpha.CUT_OUT
    assert material.double_sided
    assert [texels[0, 0, 0] for texels in material.maps.values()] == [0, 10, 20, 30, 40]
    np.testing.assert_allclose(part.uvs, np.column_stack([UVS[:, 0], 1 - UVS[:, 1]]))


@pytest.mark.parametrize(("mode", "triangles"), [(0, 0), (1, 0), (2, 0), (3, 0), (4, 2), (5, 4), (6, 4), (None, 2)])
def test_six_corners_are_as_many_triangles_as_their_mode_says(mode: int | None, triangles: int) -> None:
    """Of points and lines there are none, however many corners they have."""
    document = Document()
    document.quad()
    if mode is not None:
        document.json["meshes"][0]["primitives"][0]["mode"] = mode
    assert amounts_of(document.json).triangles == triangles


def test_what_is_not_said_has_gltfs_defaults(tmp_path: Path) -> None:
    document = Document()
    document.quad(material={})
    material = load_model_file(document.save(tmp_path / "quad.glb")).parts[0].material
    assert (material.metallic, material.roughness) == (1.0, 1.0)
    assert material.base_colour == (1, 1, 1, 1)
    assert material.emissive == (0, 0, 0)
    assert material.alpha is Alpha.OPAQUE
    assert not material.double_sided


def test_a_part_begins_at_its_buffers_start_and_the_first_scene_is_shown_where_nothing_else_is_said(
    tmp_path: Path,
) -> None:
    """Such a part may be all of its buffer."""
    document = Document()
    document.json["meshes"].append({"primitives": [{"attributes": {"POSITION": document.accessor(CORNERS[:3])}}]})
    document.json["nodes"] = [{"mesh": 0}, {"mesh": 0, "scale": [3, 3, 3]}]
    document.json["scenes"] = [{"nodes": [0]}, {"nodes": [1]}]
    del document.json["scene"], document.json["bufferViews"][0]["byteOffset"]
    (part,) = load_model_file(document.save(tmp_path / "a.gltf")).parts
    assert np.ptp(part.vertices, axis=0).max() == pytest.approx(1.0)
    document.json["scene"] = 1
    (part,) = load_model_file(document.save(tmp_path / "a.gltf")).parts
    assert np.ptp(part.vertices, axis=0).max() == pytest.approx(3.0)


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_textures_come_from_wherever_they_lie(tmp_path: Path, suffix: str) -> None:
    (tmp_path / "my picture.png").write_bytes(png(RED))
    document = Document()
    places = [
        document.embedded(png(RED)),
        document.texture({"uri": "data:image/png;base64," + base64.b64encode(png(RED)).decode()}),
        document.texture({"uri": "my%20picture.png"}),
    ]
    for place in places:
        document.quad(material={"pbrMetallicRoughness": {"baseColorTexture": place}}, TEXCOORD_0=document.accessor(UVS))
    for part in load_model_file(document.save(tmp_path / f"quads{suffix}")).parts:
        assert tuple(part.material.base_map[0, 0]) == RED


@pytest.mark.parametrize("uri", ["../secret.png", "%2e%2e/secret.png", "/etc/hostname", "sub/../../secret.png"])
def test_no_texture_comes_from_outside_the_folder(tmp_path: Path, uri: str) -> None:
    (tmp_path / "secret.png").write_bytes(png(RED))
    (tmp_path / "model").mkdir()
    document = Document()
    texture = document.texture({"uri": uri})
    document.quad(material={"pbrMetallicRoughness": {"baseColorTexture": texture}}, TEXCOORD_0=document.accessor(UVS))
    model = load_model_file(document.save(tmp_path / "model" / "quad.glb"))
    assert not model.parts[0].material.maps
    assert model.notes == (f"its picture {uri} is not beside it, and is left out",)


def test_data_in_an_address_may_be_percent_encoded(tmp_path: Path) -> None:
    """As any part of an address, base64 too: RFC 3986, 2.1, and RFC 2397."""
    document = Document()
    document.quad()
    path = document.save(tmp_path / "quad.gltf")
    plain = load_model_file(path).parts[0]
    content = json.loads(path.read_text())
    (buffer,) = content["buffers"]
    kind, _, data = buffer["uri"].partition(",")
    buffer["uri"] = f"{kind},{quote(data, safe='')}"
    assert "%2" in buffer["uri"]
    path.write_text(json.dumps(content))
    np.testing.assert_array_equal(load_model_file(path).parts[0].vertices, plain.vertices)


def test_texture_that_cannot_be_read_is_said(tmp_path: Path) -> None:
    document = Document()
    texture = document.texture({"uri": "data:image/png;base64,AAAA"})
    document.quad(material={"pbrMetallicRoughness": {"baseColorTexture": texture}}, TEXCOORD_0=document.accessor(UVS))
    with pytest.raises(UserError, match=r"baseColorTexture cannot be read"):
        load_model_file(document.save(tmp_path / "quad.glb"))


def test_without_its_pictures_a_model_is_drawn_by_its_factors(tmp_path: Path) -> None:
    """But neither glows all over, nor is metal all over, as the factors beside these maps are 1 by rule."""
    document = Document()
    document.quad(
        material={
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 0.125, 1],
                "baseColorTexture": document.texture({"uri": "colour.png"}),
                "metallicRoughnessTexture": document.texture({"uri": "metal.png"}),
            },
            "emissiveTexture": document.texture({"uri": "glow.png"}),
            "emissiveFactor": [1, 1, 1],
        },
        TEXCOORD_0=document.accessor(UVS),
    )
    model = load_model_file(document.save(tmp_path / "quad.glb"))
    material = model.parts[0].material
    assert material.base_colour == (0.5, 0.25, 0.125, 1)
    assert (material.metallic, material.emissive, material.maps) == (0, (0, 0, 0), {})
    assert model.notes == tuple(
        f"its picture {name}.png is not beside it, and is left out" for name in ("colour", "metal", "glow")
    )


def test_truncated_picture_is_said(tmp_path: Path) -> None:
    document = Document()
    noise = Image.fromarray(np.random.default_rng(1).integers(0, 255, (64, 64, 3), dtype=np.uint8))
    noise.save(tmp_path / "noise.png")
    texture = document.embedded((tmp_path / "noise.png").read_bytes()[:3000])
    document.quad(material={"pbrMetallicRoughness": {"baseColorTexture": texture}}, TEXCOORD_0=document.accessor(UVS))
    with pytest.raises(UserError, match="malformed"):
        load_model_file(document.save(tmp_path / "quad.glb"))


def test_maps_are_laid_out_by_two_sets_of_coordinates_and_no_third(tmp_path: Path) -> None:
    document = Document()
    sets = [document.accessor(np.float32(UVS * share)) for share in (1, 0.5, 0.25)]
    picture = document.embedded(png(RED))
    # KHR_texture_transform's set is the one that counts where it names one.
    second = {**picture, "texCoord": 2, "extensions": {"KHR_texture_transform": {"texCoord": 1}}}
    document.quad(material={"occlusionTexture": {**picture, "texCoord": 1}}, TEXCOORD_0=sets[0], TEXCOORD_1=sets[1])
    document.quad(
        material={
            "pbrMetallicRoughness": {"baseColorTexture": picture, "metallicRoughnessTexture": second},
            "occlusionTexture": {**picture, "texCoord": 1},
            "emissiveTexture": {**picture, "texCoord": 2},
            "emissiveFactor": [1, 1, 1],
            "normalTexture": picture,
        },
        **{f"TEXCOORD_{number}": place for number, place in enumerate(sets)},
    )
    model = load_model_file(document.save(tmp_path / "quads.glb"))
    alone, beside = sorted(model.parts, key=lambda part: part.material.base_map is not None)
    assert alone.more_uvs is None
    np.testing.assert_allclose(alone.uvs[:, 0], UVS[:, 0] * 0.5)
    np.testing.assert_allclose(beside.uvs[:, 0], UVS[:, 0])
    np.testing.assert_allclose(beside.more_uvs[:, 0], UVS[:, 0] * 0.5)
    assert beside.material.layout("metallic_roughness_map").uv_set == 1
    assert beside.material.layout("occlusion_map").uv_set == 1
    # Both sets are taken by then, and a map may be laid out by either.
    assert beside.material.layout("normal_map").uv_set == 0
    assert beside.material.normal_map is not None
    # What is left out leaves nothing behind: its factor alone would make the whole of it glow.
    assert beside.material.emissive_map is None
    assert beside.material.emissive == (0, 0, 0)
    assert any("third set" in note for note in model.notes)


@pytest.mark.parametrize(("kind", "is_said"), [(np.uint8, True), (np.uint16, True), (np.uint8, False)])
def test_normalised_integers_are_shares_of_one(tmp_path: Path, kind: type, is_said: bool) -> None:
    """Colours are, even where the file does not say so: they can be nothing else."""
    largest = np.iinfo(kind).max
    document = Document()
    colours = np.array([(largest, 0, largest // 5, largest)] * 4, dtype=kind)
    document.quad(
        material={"pbrMetallicRoughness": {"baseColorTexture": document.embedded(png(GREEN))}},
        TEXCOORD_0=document.accessor((UVS * largest).astype(kind), normalised=True),
        COLOR_0=document.accessor(colours, normalised=is_said),
    )
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    np.testing.assert_allclose(part.uvs, np.column_stack([UVS[:, 0], 1 - UVS[:, 1]]), atol=1e-6)
    np.testing.assert_allclose(part.colours, [(1, 0, 0.2, 1)] * 4, atol=1e-4)  # linear in glTF


def test_a_primitive_without_positions_is_not_drawn(tmp_path: Path) -> None:
    """3.7.2.1: such a primitive is to be skipped; the others are drawn."""
    document = Document()
    document.quad()
    primitives = document.json["meshes"][0]["primitives"]
    primitives.append({"attributes": {"NORMAL": primitives[0]["attributes"]["NORMAL"]}})
    assert load_model_file(document.save(tmp_path / "a.glb")).triangle_count == 2


def test_a_node_that_mirrors_keeps_the_front_of_what_has_no_normals(tmp_path: Path) -> None:
    """3.7.4: where the node's determinant is negative, triangles run clockwise."""
    document = Document()
    document.quad({"scale": [-1, 1, 1]})
    del document.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]
    (part,) = load_model_file(document.save(tmp_path / "a.glb")).parts
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * len(part.normals), atol=1e-6)
    assert (face_normals(part.vertices, part.triangles)[:, 1] < 0).all()


def test_an_index_beyond_the_vertices_is_said(tmp_path: Path) -> None:
    document = Document()
    document.quad()
    document.json["meshes"][0]["primitives"][0]["indices"] = document.accessor(np.uint16([0, 1, 4]))
    with pytest.raises(UserError, match="a triangle names vertex 4 of 4"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_attributes_may_be_interleaved(tmp_path: Path) -> None:
    """2.6.1 and 3.6.2: each begins at its accessor's offset, and goes on by its view's stride; -128 counts as -127."""
    fields = [("place", "<i1", 3), ("gap", "<i1"), ("colour", "<u2", 4), ("normal", "<i1", 3), ("end", "<i1")]
    rows = np.zeros(4, np.dtype(fields))
    rows["place"], rows["colour"], rows["normal"] = -128 * CORNERS, (65535, 0, 13107, 65535), (0, 0, 127)
    document = Document()
    document.quad({"scale": [-2, -2, 1]})
    view = document.view(b"head" + rows.tobytes())
    document.json["bufferViews"][view]["byteStride"] = rows.itemsize
    own = document.json["meshes"][0]["primitives"][0]["attributes"]
    for name, kind, shape, offset in (
        ("POSITION", 5120, "VEC3", 0),
        ("COLOR_0", 5123, "VEC4", 4),
        ("NORMAL", 5120, "VEC3", 12),
    ):
        own[name] = len(document.json["accessors"])
        accessor = {"bufferView": view, "byteOffset": 4 + offset, "componentType": kind, "count": 4, "type": shape}
        document.json["accessors"].append({**accessor, "normalized": True})
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    corners = {tuple(place) for place in part.vertices.round(6).tolist()}
    assert corners == {(0, 0, 0), (2, 0, 0), (2, 0, 2), (0, 0, 2)}
    np.testing.assert_allclose(part.colours, [(1, 0, 0.2, 1)] * 4, atol=1e-6)
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * 4, atol=1e-6)


def test_vertex_colours_without_alpha_are_opaque(tmp_path: Path) -> None:
    document = Document()
    document.quad(COLOR_0=document.accessor(np.float32([(0.1, 0.2, 0.3)] * 4)))
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    np.testing.assert_allclose(part.colours, [(0.1, 0.2, 0.3, 1)] * 4, atol=1e-6)


def test_vertex_colours_reflect_no_more_than_all_light_and_no_less_than_none(tmp_path: Path) -> None:
    """3.7.2.1: they are to be clamped to the range from 0 to 1."""
    document = Document()
    document.quad(COLOR_0=document.accessor(np.float32([(4, 0.5, -1, 1.5)] * 4)))
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    np.testing.assert_array_equal(part.colours, [(1, 0.5, 0, 1)] * 4)


def test_without_normals_every_triangle_is_a_plane(tmp_path: Path) -> None:
    """glTF 2.0, 3.7.2.1. Both sides of the ridge lean by 10 degrees, which in other formats is smooth."""
    height = np.tan(np.radians(10))
    ridge = np.float32([(-1, 0, 0), (0, height, -1), (0, height, 1), (1, 0, 0)])
    document = Document()
    document.quad()
    places, faces = document.accessor(ridge), document.accessor(np.uint16([0, 2, 1, 1, 2, 3]))
    document.json["meshes"] = [{"primitives": [{"attributes": {"POSITION": places}, "indices": faces}]}]
    (part,) = load_model_file(document.save(tmp_path / "ridge.glb")).parts
    leaning = np.sin(np.radians(10))
    seen = part.normals[part.triangles]
    np.testing.assert_allclose(seen[:, :, 0], [[-leaning] * 3, [leaning] * 3], atol=1e-6)
    np.testing.assert_allclose(seen[:, :, 2], np.cos(np.radians(10)), atol=1e-6)


def test_without_scenes_every_node_is_drawn_once(tmp_path: Path) -> None:
    document = Document()
    document.quad({"translation": [3, 0, 0]})
    document.json["nodes"].append({"children": [0], "translation": [0, 2, 0]})
    del document.json["scenes"], document.json["scene"]
    model = load_model_file(document.save(tmp_path / "library.glb"))
    assert model.triangle_count == 2
    np.testing.assert_allclose(model.bounds, [(3, 0, 2), (4, 0, 3)], atol=1e-6)


def test_the_scene_that_the_file_names_is_shown(tmp_path: Path) -> None:
    document = Document()
    document.quad()
    document.quad({"scale": [5, 5, 5]})
    document.json["scenes"], document.json["scene"] = [{"nodes": [0]}, {"nodes": [1]}], 1
    model = load_model_file(document.save(tmp_path / "quad.glb"))
    np.testing.assert_allclose(np.ptp(model.bounds, axis=0), (5, 0, 5))
    assert model.notes == ("one of its 2 scenes is shown",)


def test_nodes_are_placed_turned_and_scaled_one_within_another(tmp_path: Path) -> None:
    document = Document()
    document.quad(node={"scale": [2, 3, 1], "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]})
    document.json["nodes"].append({"translation": [10, 0, 0], "scale": [1, 2, 1], "children": [0]})
    document.json["scenes"][0]["nodes"] = [1]
    part = load_model_file(document.save(tmp_path / "quad.glb")).parts[0]
    x, y = CORNERS[:, 0] * 2, CORNERS[:, 1] * 3
    expected = np.column_stack([10 - y, np.zeros(4), 2 * x])  # turned by 90 degrees about z, then y up to z up
    np.testing.assert_allclose(np.sort(part.vertices, axis=0)[[0, -1]], np.sort(expected, axis=0)[[0, -1]], atol=1e-5)
    np.testing.assert_allclose(np.abs(part.normals @ (0, 1, 0)), 1, atol=1e-6)


def test_node_scaled_to_nothing_is_left_out(tmp_path: Path) -> None:
    document = Document()
    document.quad()
    document.quad(node={"scale": [0, 0, 0]})
    assert load_model_file(document.save(tmp_path / "quads.glb")).triangle_count == 2


def test_picture_is_one_value_however_often_it_is_used(tmp_path: Path) -> None:
    document = Document()
    texture = document.embedded(png(RED))
    for roughness in (0.3, 0.6):
        factors = {"baseColorTexture": texture, "roughnessFactor": roughness}
        document.quad(material={"pbrMetallicRoughness": factors}, TEXCOORD_0=document.accessor(UVS))
    first, second = load_model_file(document.save(tmp_path / "quads.glb")).parts
    assert first.material.base_map.base is second.material.base_map.base


def test_maps_without_coordinates_are_left_out(tmp_path: Path) -> None:
    document = Document()
    document.quad(material={"pbrMetallicRoughness": {"baseColorTexture": document.embedded(png(RED))}})
    assert load_model_file(document.save(tmp_path / "quad.glb")).parts[0].material.maps == {}


def test_what_is_needed_and_not_known_is_refused(tmp_path: Path) -> None:
    document = Document()
    document.quad()
    document.json["extensionsRequired"] = ["EXT_unheard_of"]
    with pytest.raises(UserError, match="EXT_unheard_of"):
        load_model_file(document.save(tmp_path / "quad.glb"))


def test_more_than_the_limits_is_refused_before_it_is_allocated(tmp_path: Path, monkeypatch) -> None:
    """Counts that the file claims; none of it exists."""
    document = Document()
    document.quad()
    document.json["accessors"][-1]["count"] = 3 * (limits.MAX_TRIANGLES + 1)
    with pytest.raises(UserError, match="2,000,001 triangles"):
        load_model_file(document.save(tmp_path / "many.glb"))
    document = Document()
    document.quad()
    document.json["accessors"].append({"componentType": 5126, "count": 10**12, "type": "VEC4"})
    with pytest.raises(UserError, match="16,000,000,000,108 bytes"):
        load_model_file(document.save(tmp_path / "bomb.glb"))
    document = Document()
    document.quad()
    document.json["nodes"] += [{"mesh": 0}] * 10
    document.json["scenes"][0]["nodes"] = list(range(11))
    monkeypatch.setattr(limits, "MAX_TRIANGLES", 21)
    with pytest.raises(UserError, match="22 triangles"):
        load_model_file(document.save(tmp_path / "instances.glb"))


def test_too_many_texels_are_refused(tmp_path: Path, monkeypatch) -> None:
    document = Document()
    header = b"IHDR" + struct.pack(">II", 9000, 9000) + png(RED)[24:29]  # what is said before anything is decoded
    large = png(RED)[:12] + header + struct.pack(">I", zlib.crc32(header)) + png(RED)[33:]
    document.quad(
        material={"pbrMetallicRoughness": {"baseColorTexture": document.embedded(large)}},
        TEXCOORD_0=document.accessor(UVS),
    )
    with pytest.raises(UserError, match="9000 x 9000 texels"):
        load_model_file(document.save(tmp_path / "large.glb"))
    document = Document()
    for k in range(3):
        document.quad(
            material={"pbrMetallicRoughness": {"baseColorTexture": document.embedded(png((k, 0, 0, 255)))}},
            TEXCOORD_0=document.accessor(UVS),
        )
    monkeypatch.setattr(limits, "MAX_MODEL_TEXELS", 40)
    with pytest.raises(UserError, match="48 texels together"):
        load_model_file(document.save(tmp_path / "many.glb"))


@pytest.mark.parametrize("indexed", [True, False])
@pytest.mark.parametrize(("mode", "expected"), [(5, [(0, 1, 2), (2, 1, 3)]), (6, [(0, 1, 2), (0, 2, 3)])])
def test_strips_and_fans_are_triangles(tmp_path: Path, mode: int, expected: list, indexed: bool) -> None:
    """Section 3.7.2.1 of the specification."""
    document = Document()
    document.quad()
    primitive = document.json["meshes"][0]["primitives"][0]
    primitive["mode"] = mode
    places = [0, 1, 2, 3] if mode == 6 else [0, 1, 3, 2]  # a strip goes to and fro
    if indexed:
        primitive["indices"] = document.accessor(np.uint16(places))
    else:
        del primitive["indices"]
        primitive["attributes"]["POSITION"] = document.accessor(CORNERS[places])
    part = load_model_file(document.save(tmp_path / "a.glb")).parts[0]
    given = CORNERS[places][np.array(expected)] @ np.float32([(1, 0, 0), (0, 0, 1), (0, -1, 0)])  # z up
    np.testing.assert_allclose(_sorted(part.vertices[part.triangles]), _sorted(given), atol=1e-6)
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * len(part.normals), atol=1e-6)


def _sorted(triangles: np.ndarray) -> np.ndarray:
    """Each from its least corner on, in its sense; all by their places."""
    turned = [
        np.roll(corners, -min(range(3), key=lambda at: tuple(corners[at])), axis=0) for corners in triangles.tolist()
    ]
    return np.array(sorted(np.asarray(corners).tolist() for corners in turned))


def test_a_fan_of_many_keeps_its_sense(tmp_path: Path) -> None:
    angles = np.linspace(0, 6, 20)
    rim = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    document = Document()
    document.quad()
    position = document.accessor(np.float32([(0, 0, 0), *rim]))
    document.json["meshes"][0]["primitives"] = [{"attributes": {"POSITION": position}, "mode": 6}]
    part = load_model_file(document.save(tmp_path / "disc.glb")).parts[0]
    assert len(part.triangles) == 19
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * len(part.normals), atol=1e-6)


def test_a_strip_of_many_keeps_its_sense(tmp_path: Path) -> None:
    """Every other triangle of it runs the other way round (3.7.2.1); without normals this alone tells its front."""
    places = np.float32([(across, upwards, 0) for across in range(8) for upwards in (1, 0)])
    document = Document()
    document.quad()
    primitive = {"attributes": {"POSITION": document.accessor(places)}, "mode": 5}
    document.json["meshes"][0]["primitives"] = [primitive]
    (part,) = load_model_file(document.save(tmp_path / "band.glb")).parts
    assert len(part.triangles) == 14
    np.testing.assert_allclose(part.normals, [(0, -1, 0)] * len(part.normals), atol=1e-6)
    areas = np.linalg.norm(face_normals(part.vertices, part.triangles), axis=1) / 2
    np.testing.assert_allclose(areas, 0.5)


def test_every_primitive_of_a_mesh_is_drawn(tmp_path: Path) -> None:
    document = Document()
    document.quad({"translation": [1, 0, 0]})
    document.json["meshes"][0]["primitives"] *= 5
    model = load_model_file(document.save(tmp_path / "a.glb"))
    assert model.triangle_count == 10
    np.testing.assert_allclose(model.bounds[:, 0], (1, 2))
