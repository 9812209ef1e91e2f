"""Model files made to harm: each is refused with one line, before much memory is taken, and reads nothing else."""

import json
import os
import re
import socket
import struct
import sys
import tempfile
import tracemalloc
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from ashe_live.errors import UserError
from ashe_live.models import loading, reading
from ashe_live.models.loading import load_model_file
from ashe_live.models.material import UNKNOWN
from ashe_live.models.parsing import limits
from ashe_live.models.reading import read_model
from ashe_live.process.children import Limits
from tests.models.gltf_files import UVS, Document, png

LITTLE_BYTES = 20e6
PYTHONS_WORDS = re.compile(r"\w(Error|Exception|Warning)\b|subscript|\b(dict|int|str|NoneType|ndarray|dtype)\b")
RED = (255, 0, 0)
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def claimed_png(width: int, height: int) -> bytes:
    """A picture of that size by its header, and of one byte by its content."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")


def with_material(make: Callable[[dict[str, int]], dict[str, Any]], *pictures: bytes) -> Document:
    document = Document()
    for picture in pictures:
        document.quad(material=make(document.embedded(picture)), TEXCOORD_0=document.accessor(UVS))
    return document


def textured(*pictures: bytes) -> Document:
    return with_material(lambda texture: {"pbrMetallicRoughness": {"baseColorTexture": texture}}, *pictures)


def old_material(*pictures: bytes) -> Document:
    extension = "KHR_materials_pbrSpecularGlossiness"
    return with_material(lambda texture: {"extensions": {extension: {"diffuseTexture": texture}}}, *pictures)


def changed(change: Callable[[Document, dict[str, Any]], object]) -> Document:
    """A good quad, then changed."""
    document = Document()
    document.quad()
    change(document, document.json)
    return document


def _overlapping_views(document: Document, it: dict[str, Any]) -> None:
    document.view(bytes(2_000_000))
    it["bufferViews"] += [{"buffer": 0, "byteOffset": 1, "byteLength": 2_000_000}] * 100


def _shared_accessor(document: Document, it: dict[str, Any]) -> None:
    position = document.accessor(np.zeros((100_000, 3), np.float32))
    primitive = {"attributes": {"POSITION": position}, "indices": it["meshes"][0]["primitives"][0]["indices"]}
    it["meshes"][0]["primitives"] = [primitive] * 100


def _unused_meshes(document: Document, it: dict[str, Any]) -> None:
    indices = document.accessor(np.zeros(300_000, np.uint16))
    it["meshes"] += [{"primitives": [{"attributes": {"POSITION": 0}, "indices": indices}]}] * 30


def _long_strips(document: Document, it: dict[str, Any]) -> None:
    indices = document.accessor(np.zeros(300_000, np.uint16))
    strips = [{"attributes": {"POSITION": 0}, "indices": indices, "mode": mode} for mode in (5, 6)]
    it["meshes"].append({"primitives": 4 * strips})


def _sparse_beyond(document: Document, it: dict[str, Any]) -> None:
    indices, values = document.view(np.arange(4, dtype=np.uint16).tobytes()), document.view(bytes(12))
    parts = {"indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}}
    it["accessors"][0]["sparse"] = {"count": 4, **parts}


def _short_displacement(document: Document, it: dict[str, Any]) -> None:
    of_three = document.accessor(np.zeros((3, 3), np.float32))
    it["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}, {"POSITION": of_three}]


def _many_nodes(_: Document, it: dict[str, Any]) -> None:
    it["nodes"] = [{"mesh": 0}] * (limits.MAX_PARTS + 1)
    it["scenes"][0]["nodes"] = list(range(limits.MAX_PARTS + 1))


def _deep_nodes(_: Document, it: dict[str, Any]) -> None:
    it["nodes"] = [{"children": [place + 1], "mesh": 0} for place in range(5000)] + [{"mesh": 0}]


def _diamond(_: Document, it: dict[str, Any]) -> None:
    it["nodes"] = [{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]


def _flat_nodes(_: Document, it: dict[str, Any]) -> None:
    it["nodes"] = [{"mesh": 0}] + [{}] * limits.MAX_NODES
    it["scenes"][0]["nodes"] = list(range(limits.MAX_NODES + 1))


def _without(kind: str, key: str) -> Callable[[], Document]:
    return lambda: changed(lambda _, it: it[kind][0].pop(key))


def _with(kind: str, **values: object) -> Callable[[], Document]:
    return lambda: changed(lambda _, it: it[kind][0].update(values))


BODYLESS = {"componentType": 5126, "count": 5_000_000, "type": "MAT4"}
GLTF: dict[str, tuple[str, Callable[[], Document]]] = {
    "views that overlap": ("bytes", lambda: changed(_overlapping_views)),
    "a view that makes room": (
        "byteLength is -9",
        lambda: changed(lambda _, it: it["bufferViews"].append({"buffer": 0, "byteLength": -9})),
    ),
    "accessors of nothing": ("bytes", lambda: changed(lambda _, it: it["accessors"].extend([BODYLESS] * 9))),
    "a shared accessor": ("vertices", lambda: changed(_shared_accessor)),
    "meshes that no node uses": ("triangles", lambda: changed(_unused_meshes)),
    "strips and fans": ("2,399,986 triangles", lambda: changed(_long_strips)),
    "too many parts": ("parts", lambda: changed(_many_nodes)),
    "nodes too deep": ("nodes within nodes", lambda: changed(_deep_nodes)),
    "too many nodes": ("20,001 nodes", lambda: changed(_flat_nodes)),
    "a need of many words": (
        r"needs x x x.* \.\.\. .*x x, which is not supported",
        lambda: changed(lambda _, it: it.update(extensionsRequired=["x " * 4000])),
    ),
    "a need in control sequences": (
        r"needs \\x1b\[31m\\u202e, which is not supported",
        lambda: changed(lambda _, it: it.update(extensionsRequired=["\x1b[31m\u202e"])),
    ),
    "a need that is no name": (
        "needs None, which",
        lambda: changed(lambda _, it: it.update(extensionsRequired=[None])),
    ),
    "an older version": (
        "is glTF 1.0: export it as glTF 2.0",
        lambda: changed(lambda _, it: it["asset"].update(version="1.0")),
    ),
    "an older version that does not say so": (
        "is glTF 1.0: export it as glTF 2.0",
        lambda: changed(lambda _, it: it.update(asset={}, meshes={"cube": {}})),
    ),
    "no version": ("asset.version is missing", lambda: changed(lambda _, it: it["asset"].clear())),
    "nodes of another kind": (
        "nodes is an object, not a list",
        lambda: changed(lambda _, it: it.update(nodes={}, scenes=[], scene=0) or it.pop("scene")),
    ),
    "a mesh that is not there": (r"nodes\[0\].mesh is 7, and there are 1 meshes", _with("nodes", mesh=7)),
    "a mesh that is a word": (r'nodes\[0\].mesh is "cube", and there are 1 meshes', _with("nodes", mesh="cube")),
    "a short matrix": (r"nodes\[0\].matrix is a list of 3, not a list of 16 values", _with("nodes", matrix=[1, 2, 3])),
    "a mesh without primitives": (r"meshes\[0\].primitives is missing", _without("meshes", "primitives")),
    "an array of an unknown type": (
        r"accessors\[0\].type is \"VEC5\", not one of SCALAR",
        _with("accessors", type="VEC5"),
    ),
    "places on a plane": (r"primitives\[0\]: POSITION cannot be VEC2", _with("accessors", type="VEC2")),
    "fewer normals than places": ("NORMAL has 4 items for 3 vertices", _with("accessors", count=3)),
    "a displacement of fewer places": (
        r"primitives\[0\]: targets\[1\].POSITION has 3 items for 4 vertices",
        lambda: changed(_short_displacement),
    ),
    "an array beyond its part": (
        r"accessors\[0\] ends at byte 60 of a bufferView of 48",
        _with("accessors", byteOffset=12),
    ),
    "an item beyond its part": (
        r"accessors\[3\] ends at byte 52 of a bufferView of 48",
        lambda: changed(
            lambda _, it: it["accessors"].append(
                {"bufferView": 0, "byteOffset": 40, "componentType": 5126, "count": 1, "type": "VEC3"}
            )
        ),
    ),
    "a part beyond the buffer": (r"bufferViews\[0\] ends at byte 999999", _with("bufferViews", byteLength=999999)),
    "a part of no buffer": (r"bufferViews\[0\].buffer is 4, and there are 1 buffers", _with("bufferViews", buffer=4)),
    "two corners": (
        r"primitives\[0\] has 5 corners, which are no triangles",
        lambda: changed(lambda _, it: it["accessors"][2].update(count=5)),
    ),
    "a node within itself": ("two places", lambda: changed(lambda _, it: it["nodes"][0].update(children=[0]))),
    "a node in two places": ("two places", lambda: changed(_diamond)),
    "a child twice": (
        "node 1 stands in two places",
        lambda: changed(lambda _, it: it.update(nodes=[{"children": [1, 1]}, {"mesh": 0}])),
    ),
    "places in whole numbers": (
        r"primitives\[0\]: POSITION cannot be VEC3 of componentType 5125",
        _with("accessors", componentType=5125),
    ),
    "corners by signed numbers": (
        r"primitives\[0\]: indices cannot be SCALAR of componentType 5122",
        lambda: changed(lambda _, it: it["accessors"][2].update(componentType=5122)),
    ),
    "a stride beyond its part": (
        r"accessors\[0\] ends at byte 768 of a bufferView of 48",
        lambda: changed(lambda _, it: it["bufferViews"][0].update(byteStride=252)),
    ),
    "sparse items beyond their part": (
        r"accessors\[0\].sparse.values ends at byte 48 of a bufferView of 12",
        lambda: changed(_sparse_beyond),
    ),
    "a stride past the end": (
        "malformed",
        lambda: changed(lambda _, it: it["bufferViews"][0].update(byteStride=2**40)),
    ),
    "a stride backwards": ("malformed", lambda: changed(lambda _, it: it["bufferViews"][0].update(byteStride=-12))),
    "an offset before the start": (
        "malformed",
        lambda: changed(lambda _, it: it["bufferViews"][0].update(byteOffset=-(10**6))),
    ),
    "a place that is no number": (
        "not a number",
        lambda: changed(lambda _, it: it["nodes"][0].update(translation=[float("nan"), 0, 0])),
    ),
    "a place at the end of the world": (
        r"is 1e\+300, too large a number: at most 1e\+30 is read",
        lambda: changed(lambda _, it: it["nodes"][0].update(translation=[1e300, 0, 0])),
    ),
    "lines": ("no triangles", lambda: changed(lambda _, it: it["meshes"][0]["primitives"][0].update(mode=1))),
    "a mesh of nothing": ("no triangles", lambda: changed(lambda _, it: it["meshes"][0].update(primitives=[]))),
    "a picture of 30,000 x 30,000": ("more than 8192 x 8192", lambda: textured(claimed_png(30_000, 30_000))),
    "a picture of 9,000 x 9,000": ("9000 x 9000", lambda: textured(claimed_png(9_000, 9_000))),
    "an old material's picture": ("9000 x 9000", lambda: old_material(claimed_png(9_000, 9_000))),
    "a picture that is a program": (
        "format EPS",
        lambda: textured(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n"),
    ),
}


@pytest.mark.parametrize("name", GLTF)
def test_a_hostile_gltf_is_refused_with_little_memory(tmp_path: Path, name: str) -> None:
    said, make = GLTF[name]
    assert_refused_with_little_memory(make().save(tmp_path / "hostile.glb"), said)


PLY = b"ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
LIST = b"element face %d\nproperty list %s int vertex_indices\nend_header\n"
LITTLE_ENDIAN = b"binary_little_endian"
FACET = b"facet normal 0 0 1\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
TEXTS: dict[str, tuple[str, str, Callable[[], bytes]]] = {
    "a polygon of all corners": ("obj", "triangles", lambda: TRIANGLE + b"f" + b" 1 2 3" * 700_000),
    "a polygon over many lines": ("obj", "triangles", lambda: TRIANGLE + b"f" + b" 1 2 3 \\\r\n" * 700_000),
    "a material for each face": (
        "obj",
        "materials",
        lambda: TRIANGLE + b"".join(b"usemtl m%d\nf 1 2 3\n" % number for number in range(1001)),
    ),
    "JSON nested too deeply": ("gltf", "nested too deeply", lambda: b"[" * 1_000_000),
    "JSON that breaks off": ("gltf", "damaged in line 2", lambda: b'{"asset":\n {'),
    "JSON that is no text": ("gltf", "no text", lambda: b'{"asset": "\xff"}'),
    "a number of 9,000 digits": ("gltf", "without an end", lambda: b'{"scene": ' + b"9" * 9000 + b"}"),
    "a header that breaks off": ("glb", "within its first chunk", lambda: b"glTF\2\0\0\0"),
    "an older binary": ("glb", "is glTF 1: export", lambda: b"glTF\1" + bytes(40)),
    "empty lines": ("obj", "lines", lambda: b"\n" * (limits.MAX_OBJ_LINES + 1)),
    "a corner that is not there": ("obj", "malformed", lambda: TRIANGLE + b"f 1 2 99999999999\n"),
    "a solid for each face": ("stl", "solids", lambda: b"solid a\n" + (FACET + b"endsolid\nsolid\n") * 1001),
    "text of many facets": ("stl", "triangles", lambda: b"solid a\n" + FACET + b"vertex 0 0 0\n" * 6_000_000),
    "lines of nothing": (
        "ply",
        "lines",
        lambda: PLY % (b"ascii", 3) + LIST % (1, b"uchar") + b"\r" * (limits.MAX_LINES + 1),
    ),
    "vertices of nothing": ("ply", "malformed", lambda: PLY % (LITTLE_ENDIAN, 10**14) + LIST % (1, b"uchar")),
    "a list of 2^32": ("ply", "malformed", lambda: PLY % (LITTLE_ENDIAN, 0) + LIST % (9, b"uint") + b"\xff" * 99),
    "faces of nothing": ("ply", "triangles", lambda: PLY % (LITTLE_ENDIAN, 3) + LIST % (10**9, b"uchar") + bytes(99)),
    "a zip": ("glb", "ZIP", lambda: b"PK\x03\x04" + bytes(1000)),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_hostile_file_is_refused_with_little_memory(tmp_path: Path, name: str) -> None:
    suffix, said, make = TEXTS[name]
    path = tmp_path / f"hostile.{suffix}"
    path.write_bytes(make())
    assert_refused_with_little_memory(path, said)


def assert_refused_with_little_memory(path: Path, said: str) -> None:
    """And in the format's words: Python's own speak of errors, and of types that no format has."""
    tracemalloc.start()
    try:
        with pytest.raises(UserError, match=said) as caught:
            load_model_file(path)
        assert not PYTHONS_WORDS.search(str(caught.value))
        assert path.name in str(caught.value)  # of several models on one command line
        assert tracemalloc.get_traced_memory()[1] < LITTLE_BYTES + 3 * path.stat().st_size
    finally:
        tracemalloc.stop()


@pytest.fixture
def no_network(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("a connection was tried")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    monkeypatch.setattr(socket, "getaddrinfo", refuse)


@pytest.mark.usefixtures("no_network")
@pytest.mark.parametrize(
    "uri",
    [
        "http://127.0.0.1/a.png",
        "https://example.org/a.png",
        "ftp://example.org/a.png",
        "file:///etc/hostname",
        "//example.org/share/a.png",
        "\\\\example.org\\share\\a.png",
        "C:\\secret.png",
        "C:/secret.png",
        "..\\secret.png",
        "%2e%2e%2fsecret.png",
        "a.png/../../secret.png",
        "/proc/self/environ",
        "",
        ".",
        "\0",
    ],
)
def test_nothing_but_files_of_the_folder_is_read(tmp_path: Path, uri: str) -> None:
    (tmp_path / "secret.png").write_bytes(png(RED))
    (tmp_path / "model").mkdir()
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.texture({"uri": uri})}}
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    path = document.save(tmp_path / "model" / "hostile.glb")
    model = load_model_file(path)
    assert not model.parts[0].material.maps
    assert "is not beside it, and is left out" in model.notes[0]
    assert model.notes[0].isprintable()


@pytest.mark.usefixtures("no_network")
@pytest.mark.parametrize(
    "uri",
    ["file:///etc/a.bin", "file:a.bin", "http://example.org/a.bin", "HTTPS:a.bin", "http://example.org/../../../a.bin"],
)
def test_that_no_address_is_read_is_said(tmp_path: Path, uri: str) -> None:
    """Nor what lies beside the model and has the name that the address ends in."""
    document = Document()
    document.quad()
    (tmp_path / "a.bin").write_bytes(document.buffer)
    path = document.save(tmp_path / "a.gltf")
    header = json.loads(path.read_text())
    header["buffers"][0]["uri"] = uri
    path.write_text(json.dumps(header))
    with pytest.raises(UserError, match="only data in it and files beside it are read"):
        load_model_file(path)


def test_a_folder_behind_a_link_is_outside(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "a.png").write_bytes(png(RED))
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "inside").symlink_to(tmp_path / "elsewhere")
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.texture({"uri": "inside/a.png"})}}
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    model = load_model_file(document.save(tmp_path / "model" / "a.glb"))
    assert not model.parts[0].material.maps
    assert "inside/a.png is not beside it" in model.notes[0]


def test_material_file_of_an_obj_outside_its_folder_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 1 0 0\n")
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "a.obj").write_bytes(b"mtllib ../a.mtl\nusemtl m\n" + TRIANGLE + b"f 1 2 3\n")
    model = load_model_file(tmp_path / "model" / "a.obj")
    assert model.parts[0].material is UNKNOWN
    assert model.notes == ("its materials ../a.mtl are missing: it is drawn as plain plastic",)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.glb")
    with pytest.raises(UserError, match="not a file"):
        load_model_file(tmp_path / "pipe.glb")
    document = Document()
    material = {"pbrMetallicRoughness": {"baseColorTexture": document.texture({"uri": "pipe.glb"})}}
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    with pytest.raises(UserError, match="not a file"):
        load_model_file(document.save(tmp_path / "a.glb"))


def test_files_are_small_together_and_not_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    noise = np.random.default_rng(1).integers(0, 255, (64, 64, 3), dtype=np.uint8)
    document = Document()
    for name in ("a.png", "b.png", "c.png"):
        Image.fromarray(noise).save(tmp_path / name)
        material = {"pbrMetallicRoughness": {"baseColorTexture": document.texture({"uri": name})}}
        document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    path = document.save(tmp_path / "a.glb")
    assert len(load_model_file(path).parts) == 3
    monkeypatch.setattr(loading, "MAX_FILE_BYTES", 2 * (tmp_path / "a.png").stat().st_size)
    with pytest.raises(UserError, match="too large"):
        load_model_file(path)


def test_old_material_keeps_its_colour(tmp_path: Path) -> None:
    extension = {"diffuseFactor": [1, 0, 0, 1], "specularFactor": [0.04] * 3, "glossinessFactor": 0.75}
    document = Document()
    document.quad(material={"extensions": {"KHR_materials_pbrSpecularGlossiness": extension}})
    material = load_model_file(document.save(tmp_path / "old.glb")).parts[0].material
    assert material.base_colour == pytest.approx((1, 0, 0, 1), abs=0.01)
    assert material.metallic == pytest.approx(0, abs=0.01)
    assert material.roughness == pytest.approx(0.25)


def test_polygons_are_counted_as_triangles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MAX_TRIANGLES", 20)
    places = b"v 0 0 0\n" * 7
    limits.check_text(Path("a.obj"), places + b"f 1 2 3 4\n" * 10)
    with pytest.raises(UserError, match="22 triangles"):
        limits.check_text(Path("a.obj"), places + b"f 1 2 3 4\n" * 11)


def test_texels_are_counted_before_they_are_decoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However few bytes they take: the last of these has none."""
    monkeypatch.setattr(limits, "MAX_DECODED_TEXELS", 2 * 64 * 64)
    whole, empty = png((*RED, 255), (64, 64)), claimed_png(64, 64)
    assert load_model_file(_of_pictures(whole, whole).save(tmp_path / "two.glb")).parts
    with pytest.raises(UserError, match="more than 8,192 texels in their files"):
        load_model_file(_of_pictures(whole, whole, empty).save(tmp_path / "three.glb"))


def _of_pictures(*pictures: bytes) -> Document:
    """One material's maps, in the order in which they are read."""
    document = Document()
    keys = ("normalTexture", "occlusionTexture", "emissiveTexture")
    material = {key: document.embedded(picture) for key, picture in zip(keys, pictures, strict=False)}
    document.quad(material=material, TEXCOORD_0=document.accessor(UVS))
    return document


def test_a_file_is_not_named_without_end(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(png(RED))
    (tmp_path / "a.mtl").write_bytes(b"".join(b"newmtl %d\nmap_Kd %sa.png\n" % (at, b"./" * at) for at in range(1001)))
    (tmp_path / "a.obj").write_bytes(b"mtllib a.mtl\nusemtl 1\n" + TRIANGLE + b"f 1 2 3\n")
    with pytest.raises(UserError, match="names files more than 1,000 times"):
        load_model_file(tmp_path / "a.obj")


def test_materials_without_end_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_bytes(b"newmtl a\n" * (limits.MAX_MATERIALS + 1))
    (tmp_path / "a.obj").write_bytes(b"mtllib a.mtl\nusemtl a\n" + TRIANGLE + b"f 1 2 3\n")
    with pytest.raises(UserError, match="more than 10,000 materials"):
        load_model_file(tmp_path / "a.obj")


LITTLE = Limits(niceness=10, memory_bytes=700_000_000, processor_s=8, silent=True)


def _much_beside_each_part(_: Document, it: dict[str, Any]) -> None:
    it["meshes"][0]["extras"] = {"words": ["word"] * 200_000}
    it["meshes"][0]["primitives"] *= 500


CHEAP: dict[str, tuple[str, Callable[[], bytes]]] = {
    "objects without end": ("obj", lambda: TRIANGLE + b"".join(b"o %d\nf 1 2 3\n" % at for at in range(20_000))),
    "groups without end": ("obj", lambda: TRIANGLE + b"".join(b"g %d\ns 1\nf 1 2 3\n" % at for at in range(20_000))),
    "the same two materials in turn": ("obj", lambda: TRIANGLE + b"usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n" * 20_000),
    "much beside each part": ("gltf", lambda: _text_of(changed(_much_beside_each_part))),
    "names without end": ("gltf", lambda: _text_of(changed(lambda _, it: it["nodes"][0].update(name="x" * 5_000_000)))),
}


def _text_of(document: Document) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return document.save(Path(folder) / "a.gltf").read_bytes()


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not hold a process to it")
@pytest.mark.parametrize("name", CHEAP)
def test_what_is_not_drawn_takes_next_to_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Each took tens of seconds or gigabytes."""
    monkeypatch.setattr(reading, "LIMITS", LITTLE)
    suffix, make = CHEAP[name]
    (tmp_path / f"cheap.{suffix}").write_bytes(make())
    assert read_model(str(tmp_path / f"cheap.{suffix}"), 0.08).model.parts


def test_what_libraries_say_of_a_damaged_file_is_not_seen(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    header = PLY % (b"ascii", 3) + LIST % (1, b"uchar")
    (tmp_path / "a.ply").write_bytes(
        header.replace(b"element", b"comment TextureFile a.ply\nelement", 1) + b"0 0 0\n" * 3
    )
    with pytest.raises(UserError, match=r"its texture a\.ply cannot be read"):
        read_model(str(tmp_path / "a.ply"), 0.08)
    document = Document()
    document.quad({"matrix": [1e30, 0, 0, 0, 0, 1e30, 0, 0, 0, 0, 1e30, 0, 1e30, 0, 0, 1]})
    document.json["nodes"].append({"children": [0], "scale": [1e30, 1e30, 1e30]})
    document.json["scenes"][0]["nodes"] = [1]
    with pytest.raises(UserError, match="not finite"):
        read_model(str(document.save(tmp_path / "far.glb")), 0.08)
    assert capfd.readouterr() == ("", "")
