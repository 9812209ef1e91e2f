"""Model files that were damaged: each gives a model that can be drawn, or one line that says why not."""

import copy
import json
import math
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from ashe_live.errors import UserError
from ashe_live.models.loading import load_model_file
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.placement import PlacedModel, placed_on_marker
from tests.fuzz.damaged import HUNTED, files
from tests.models.gltf_files import UVS, Document, png

# Pillow's own words about what it skips, and NumPy's about text that is no number.
pytestmark = [
    pytest.mark.filterwarnings("ignore::UserWarning:PIL"),
    pytest.mark.filterwarnings("ignore:string or file could not be read:DeprecationWarning"),
]
MOST_BYTES = 2_000_000_000
FEW = files(100)
SIDE_M = 0.08
TEXTS = {
    "obj": b"mtllib a.mtl\no one\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
    b"f 1/1/1 2/2/1 3/3/1\nf 1 3 4\nf 1 2 3 4\n",
    "ply": b"ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n"
    b"property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
    b"property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 1 9 9 9\n"
    b"3 0 1 2\n3 0 2 3\n",
    "stl": b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    b"endsolid a\n",
    "mtl": b"newmtl m\nKd 0.5 0.5 0.5\nNs 20\nd 0.5\nmap_Kd a.png\n",
}

numbers = st.one_of(
    st.integers(-3, 9), st.integers(), st.floats(), st.sampled_from([0, -1, 2**31, 2**63, 10**12, math.nan, math.inf])
)
values = st.one_of(
    st.none(), st.booleans(), numbers, st.text(max_size=4), st.just([]), st.just({}), st.lists(numbers, max_size=4)
)


def outcome(path: Path) -> str:
    """A model that the renderer can take, or a UserError's line; any other exception fails the test.

    So does one in our own code, which would be refused as a malformed file.
    """
    try:
        placed = placed_on_marker(load_model_file(path), SIDE_M)
    except UserError as error:
        said = error
    else:
        _assert_drawable(placed)
        return "model"
    assert said.message
    assert said.remedy
    assert "\n" not in str(said)
    cause = said.__cause__
    if not (cause is None or isinstance(cause, MalformedError)):
        files = [frame.filename for frame in traceback.extract_tb(cause.__traceback__)]
        assert any("PIL" in file for file in files), said
    return "refused"


def _assert_drawable(placed: PlacedModel) -> None:
    assert np.isfinite(placed.bounds).all()
    assert np.isfinite(placed.outline).all()
    for part in placed.model.parts:
        assert part.triangles.max() < len(part.vertices)
        np.testing.assert_allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-3)


@pytest.fixture(scope="module", autouse=True)
def _little_memory() -> Iterator[None]:
    """When hunting, of the address space as a reader has it; a MemoryError is no UserError."""
    if not HUNTED:
        yield
        return
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With what the files name."""
    folder = tmp_path_factory.mktemp("models")
    (folder / "a.mtl").write_bytes(TEXTS["mtl"])
    (folder / "a.png").write_bytes(png((255, 0, 0, 255)))
    return folder


@pytest.fixture(scope="module")
def gltf(folder: Path) -> dict[str, Any]:
    """Two quads, one within the other, with whatever is read of a glTF file."""
    document = Document()
    colours = document.accessor(np.full((4, 4), 200, np.uint8), normalised=True)
    picture = document.embedded(png((255, 0, 0, 255)))
    material = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [1, 0.5, 0, 1],
            "baseColorTexture": picture,
            "roughnessFactor": 0.4,
        },
        "normalTexture": {**picture, "scale": 0.5, "texCoord": 1},
        "emissiveFactor": [0, 0.1, 0],
        "alphaMode": "MASK",
        "alphaCutoff": 0.3,
        "doubleSided": True,
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}},
    }
    uvs = {"TEXCOORD_0": document.accessor(UVS), "TEXCOORD_1": document.accessor(UVS)}
    document.quad({"translation": [0, 1, 0], "children": [1]}, material, **uvs, COLOR_0=colours)
    old = {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 0, 0, 1]}}}
    document.quad({"rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 3]}, old)
    document.json["scenes"][0]["nodes"] = [0]
    _add_what_moves(document)
    document.json["bufferViews"][document.json["accessors"][uvs["TEXCOORD_1"]]["bufferView"]]["byteStride"] = 8
    made: dict[str, Any] = json.loads(document.save(folder / "rich.gltf").read_text())
    return made


def _add_what_moves(document: Document) -> None:
    """A sparse array, a morph target, a skin, an animation, a moved map with a sampler, and instances."""
    made = document.json
    first, second = (mesh["primitives"][0] for mesh in made["meshes"])
    made["accessors"][first["attributes"]["POSITION"]]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": document.view(np.uint16([2]).tobytes()), "componentType": 5123},
        "values": {"bufferView": document.view(np.float32([1, 1, 1]).tobytes())},
    }
    first["targets"] = [{"POSITION": document.accessor(np.float32([(0, 0, 1)] * 4))}]
    made["meshes"][0]["weights"] = [0.5]
    second["attributes"] |= {
        "JOINTS_0": document.accessor(np.uint8([(0, 1, 0, 0)] * 4)),
        "WEIGHTS_0": document.accessor(np.float32([(0.5, 0.5, 0, 0)] * 4)),
    }
    bound = document.accessor(np.tile(np.eye(4, dtype=np.float32).reshape(1, 16), (2, 1)))
    made["skins"] = [{"joints": [0, 1], "inverseBindMatrices": bound}]
    made["nodes"][1]["skin"] = 0
    frames, places = document.accessor(np.float32([0, 1])), document.accessor(np.float32([(0, 0, 0), (1, 1, 1)]))
    channel = {"sampler": 0, "target": {"node": 0, "path": "translation"}}
    made["animations"] = [{"samplers": [{"input": frames, "output": places}], "channels": [channel]}]
    made["samplers"] = [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]
    made["textures"][0]["sampler"] = 0
    base = made["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    base["extensions"] = {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 2]}}
    own = {"TRANSLATION": places}
    made["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": own}}


@FEW
@given(data=st.data())
def test_whatever_a_gltf_says_is_a_model_or_a_user_error(folder, gltf, data):
    """One to three values anywhere in a whole document replaced, taken away or doubled."""
    document = copy.deepcopy(gltf)
    for _ in range(data.draw(st.integers(1, 3))):
        at: Any = document
        while True:
            keys = sorted(at) if isinstance(at, dict) else range(len(at))
            key = data.draw(st.sampled_from(keys))
            if not (isinstance(at[key], dict | list) and at[key] and data.draw(st.integers(0, 5))):
                break
            at = at[key]
        if isinstance(at, dict) and data.draw(st.integers(0, 3)) == 0:
            del at[key]
        elif isinstance(at, list) and data.draw(st.integers(0, 3)) == 0:
            at.append(copy.deepcopy(at[key]))
        else:
            at[key] = data.draw(values)
        if not document:
            break
    path = folder / "changed.gltf"
    path.write_text(json.dumps(document), encoding="utf-8")
    outcome(path)


def damaged(whole: bytes, data: st.DataObject) -> bytes:
    content = bytearray(whole)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, max(0, len(content) - 1)))
        length = data.draw(st.integers(0, 4))
        content[at : at + length] = data.draw(
            st.one_of(st.binary(max_size=4), st.sampled_from([b"\n", b" -1", b"9e99"]))
        )
    return bytes(content[: data.draw(st.one_of(st.none(), st.integers(0, len(content))))])


@pytest.mark.parametrize("kind", ["glb", "stl", "ply"])
@FEW
@given(data=st.data())
def test_a_damaged_binary_model_is_a_model_or_a_user_error(folder, kind, data):
    whole = trimesh.creation.box((1, 1, 1)).export(file_type=kind)
    path = folder / f"box.{kind}"
    path.write_bytes(damaged(whole, data))
    outcome(path)


@pytest.mark.parametrize("kind", ["obj", "ply", "stl"])
@FEW
@given(data=st.data())
def test_a_damaged_text_model_is_a_model_or_a_user_error(folder, kind, data):
    (folder / "a.mtl").write_bytes(TEXTS["mtl"])
    path = folder / f"text.{kind}"
    path.write_bytes(damaged(TEXTS[kind], data))
    outcome(path)


@FEW
@given(data=st.data())
def test_a_damaged_material_file_is_a_model_or_a_user_error(folder, data):
    (folder / "a.mtl").write_bytes(damaged(TEXTS["mtl"], data))
    path = folder / "whole.obj"
    path.write_bytes(TEXTS["obj"])
    outcome(path)


@pytest.mark.parametrize("suffix", ["glb", "gltf", "obj", "ply", "stl"])
@FEW
@given(content=st.binary(max_size=300))
def test_any_bytes_are_refused(folder, suffix, content):
    path = folder / f"any.{suffix}"
    path.write_bytes(content)
    assert outcome(path) == "refused"


@pytest.mark.parametrize("kind", ["obj", "ply", "stl"])
def test_undamaged_text_is_a_model(folder, kind):
    (folder / "a.mtl").write_bytes(TEXTS["mtl"])
    (folder / f"good.{kind}").write_bytes(TEXTS[kind])
    assert outcome(folder / f"good.{kind}") == "model"


def test_the_undamaged_document_is_a_model(folder, gltf):
    (folder / "good.gltf").write_text(json.dumps(gltf), encoding="utf-8")
    assert outcome(folder / "good.gltf") == "model"
