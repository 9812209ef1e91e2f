"""A glTF file as trimesh is to read it, and what trimesh does not tell of it.

trimesh copies what it does not know, rounds vertex colours, wraps normalised texture coordinates, leaves out the second
set of them and some of a material's numbers, and knows no fans. So it gets a JSON that holds what is drawn and nothing
else. It passes on attributes that begin with an underscore as they are: those are renamed.
"""

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ashe_live.errors import UserError
from ashe_live.models.gltf_amounts import FAN, STRIP, TRIANGLES, amounts_of, check_layout
from ashe_live.models.gltf_schema import checked
from ashe_live.models.limits import check_gltf
from ashe_live.models.malformed import MalformedError
from ashe_live.process.messages import printable

GLB_MAGIC, GLB_JSON = 0x46546C67, 0x4E4F534A
RAW_ATTRIBUTES = ("TEXCOORD_0", "TEXCOORD_1", "COLOR_0")
FAN_MARK = "_FAN"  # an attribute of primitives that trimesh is to read as strips and that are fans
# Textures and materials may look a little plainer than meant; geometry that cannot be decoded is not there at all.
TOLERATED_EXTENSIONS = ("KHR_materials_", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual")
NAME_CHARACTERS = 60
MAPS_OF_MATERIAL = {
    "baseColorTexture": "base_map",
    "metallicRoughnessTexture": "metallic_roughness_map",
    "normalTexture": "normal_map",
    "occlusionTexture": "occlusion_map",
    "emissiveTexture": "emissive_map",
}


@dataclass(frozen=True, slots=True)
class MaterialNotes:
    """A material's numbers that trimesh leaves out."""

    normal_scale: float
    occlusion_strength: float
    emissive_strength: float
    uv_sets: dict[str, int]  # which set of texture coordinates a map is laid out with, by the map's field in Material

    @property
    def uv_set(self) -> int:
        """The set that a mesh of this material gets; maps that are laid out with another are left out."""
        return next(iter(self.uv_sets.values()), 0)


@dataclass(frozen=True, slots=True)
class GltfFile:
    """The file for trimesh to read, and what else its JSON says."""

    content: bytes
    materials: tuple[MaterialNotes, ...]  # trimesh's material is named by its place here


def read_gltf(path: Path, content: bytes) -> GltfFile:
    """From the bytes of the .gltf or .glb at `path`.

    Raises UserError for another version, an unknown extension and for more than the limits, MalformedError for what is
    not as the format asks.
    """
    document, rest = _split(path, content)
    _check_version(path, document)
    required = document.get("extensionsRequired", [])
    for name in required if isinstance(required, list) else []:
        if not (isinstance(name, str) and name.startswith(TOLERATED_EXTENSIONS)):
            said = printable(name, NAME_CHARACTERS)
            raise UserError(f"the model file {path} needs {said}, which is not known here", "export it without that")
    header = {"accessors": [], **checked(document)}
    for place, buffer in enumerate(header.get("buffers", [])):
        if "uri" not in buffer and (rest is None or place > 0):
            raise MalformedError(f"buffers[{place}].uri is missing")
    for mesh in header.get("meshes", []):
        # Without places there is nothing to draw.
        mesh["primitives"] = [primitive for primitive in mesh["primitives"] if "POSITION" in primitive["attributes"]]
    check_gltf(path, amounts_of(header))
    check_layout(header)
    for mesh in header.get("meshes", []):
        # Of points and lines trimesh makes objects that nothing here draws.
        mesh["primitives"] = [
            primitive for primitive in mesh["primitives"] if primitive.get("mode", TRIANGLES) in (TRIANGLES, STRIP, FAN)
        ]
        for primitive in mesh["primitives"]:
            _lead_trimesh(primitive)
    _take_primitives_apart(header)
    for texture in header.get("textures", []):
        texture.update(texture.pop("extensions", {}).get("EXT_texture_webp", {}))
    for material in header.get("materials", []):
        _take_specular_glossiness(material)
    notes = tuple(_notes(material) for material in header.get("materials", []))
    for place, material in enumerate(header.get("materials", [])):
        material["name"] = str(place)
        material.pop("extensions", None)
    return GltfFile(_joined(header, rest), notes)


def _lead_trimesh(primitive: dict[str, Any]) -> None:
    attributes = primitive["attributes"]
    for name in RAW_ATTRIBUTES:
        if name in attributes:
            attributes[f"_{name}"] = attributes.pop(name)
    if primitive.get("mode") == FAN:
        primitive["mode"] = STRIP
        attributes[FAN_MARK] = attributes["POSITION"]


def _take_primitives_apart(header: dict[str, Any]) -> None:
    """One primitive a mesh. Of more trimesh gives each a random name of six digits, and loses those that are alike."""
    meshes: list[dict[str, Any]] = []
    places = []
    for mesh in header.get("meshes", []):
        places.append(range(len(meshes), len(meshes) + len(mesh["primitives"])))
        meshes += [{"primitives": [primitive]} for primitive in mesh["primitives"]]
    nodes = header.get("nodes", [])
    for node in list(nodes):
        own = places[node.pop("mesh")] if "mesh" in node else range(0)
        if len(own) == 1:
            node["mesh"] = own[0]
        elif own:
            node["children"] = [*node.get("children", []), *range(len(nodes), len(nodes) + len(own))]
            nodes += [{"mesh": place} for place in own]
    header["meshes"] = meshes


def _split(path: Path, content: bytes) -> tuple[dict[str, Any], bytes | None]:
    """The JSON, and the chunks that follow it in a GLB."""
    rest = None
    text = content
    if content[:4] == b"glTF":
        if len(content) < 20:
            raise MalformedError("it ends within its first chunk")
        _, version, _, length, kind = struct.unpack_from("<5I", content)
        if version == 1:
            raise _other_version(path, "1")
        if version != 2:
            raise MalformedError(f"its header says that it is of version {version}")
        if kind != GLB_JSON:
            raise MalformedError("its first chunk is not JSON")
        text, rest = content[20 : 20 + length], content[20 + length :]
    try:
        document = json.loads(text)
    except RecursionError:
        raise MalformedError("its JSON is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise MalformedError(f"its JSON breaks off or is damaged in line {error.lineno}") from None
    except ValueError:
        raise MalformedError("its JSON is no text, or holds a number without an end") from None
    if not isinstance(document, dict):
        raise MalformedError("its JSON is not an object")
    return document, rest


def _check_version(path: Path, document: dict[str, Any]) -> None:
    asset = document.get("asset")
    version = asset.get("version") if isinstance(asset, dict) else None
    # In glTF 1.0 meshes have names instead of places, and the version may be missing.
    if isinstance(version, str) and not version.startswith("2."):
        raise _other_version(path, version)
    if isinstance(document.get("meshes"), dict):
        raise _other_version(path, "1.0")


def _other_version(path: Path, version: str) -> UserError:
    return UserError(f"the model file {path} is glTF {printable(version, 16)}", "export it as glTF 2.0")


def _joined(header: dict[str, Any], rest: bytes | None) -> bytes:
    text = json.dumps(header).encode()
    if rest is None:
        return text
    text += b" " * (-len(text) % 4)
    lengths = struct.pack("<5I", GLB_MAGIC, 2, 20 + len(text) + len(rest), len(text), GLB_JSON)
    return lengths + text + rest


def _take_specular_glossiness(material: dict[str, Any]) -> None:
    """What of the old model the new one has too; trimesh would convert whole pictures, whatever their size."""
    old = material.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness")
    if old is None or "pbrMetallicRoughness" in material:
        return
    new = {"metallicFactor": 0.0, "roughnessFactor": 1 - float(old.get("glossinessFactor", 1.0))}
    for theirs, ours in (("diffuseFactor", "baseColorFactor"), ("diffuseTexture", "baseColorTexture")):
        if theirs in old:
            new[ours] = old[theirs]
    material["pbrMetallicRoughness"] = new


def _notes(material: dict[str, Any]) -> MaterialNotes:
    textures = {**material, **material.get("pbrMetallicRoughness", {})}
    used = {name: textures[key] for key, name in MAPS_OF_MATERIAL.items() if key in textures}
    emissive_strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {})
    return MaterialNotes(
        normal_scale=float(used.get("normal_map", {}).get("scale", 1.0)),
        occlusion_strength=float(used.get("occlusion_map", {}).get("strength", 1.0)),
        emissive_strength=float(emissive_strength.get("emissiveStrength", 1.0)),
        uv_sets={name: int(texture.get("texCoord", 0)) for name, texture in used.items()},
    )
