"""What trimesh does not tell of a glTF file: read from its JSON before, and partly rewritten in it.

trimesh rounds vertex colours, wraps normalised texture coordinates, and leaves out the second set of them and some of
a material's numbers. It passes on attributes that begin with an underscore as they are, so those are renamed.
"""

import json
import struct
from dataclasses import dataclass
from typing import Any

from ashe_live.errors import UserError
from ashe_live.models.gltf_amounts import GltfAmounts, amounts_of

GLB_MAGIC, GLB_JSON = 0x46546C67, 0x4E4F534A
TRIANGLES = (4, 5)  # the modes of primitives that trimesh reads as such: triangles and strips
RAW_ATTRIBUTES = ("TEXCOORD_0", "TEXCOORD_1", "COLOR_0")
# Textures and materials may look a little plainer than meant; geometry that cannot be decoded is not there at all.
TOLERATED_EXTENSIONS = ("KHR_materials_", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual")
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
    amounts: GltfAmounts


def read_gltf(content: bytes) -> GltfFile:
    """From a .gltf's or .glb's bytes. Raises UserError for an unknown extension, and else as the parser does."""
    header, rest = _split(content)
    required = header.get("extensionsRequired", [])
    unknown = [name for name in required if not str(name).startswith(TOLERATED_EXTENSIONS)]
    if unknown:
        raise UserError(f"the model file needs {unknown[0]}, which is not known here", "export it without compression")
    amounts = amounts_of(header)
    for mesh in header.get("meshes", []):
        # Of points and lines trimesh makes objects that nothing here draws.
        mesh["primitives"] = [primitive for primitive in mesh["primitives"] if primitive.get("mode", 4) in TRIANGLES]
        for primitive in mesh["primitives"]:
            primitive.pop("extensions", None)  # compressed geometry, in the size that its blob says
            attributes = primitive["attributes"]
            for name in RAW_ATTRIBUTES:
                if name in attributes:
                    attributes[f"_{name}"] = attributes.pop(name)
    for material in header.get("materials", []):
        _take_specular_glossiness(material)
    notes = tuple(_notes(material) for material in header.get("materials", []))
    for place, material in enumerate(header.get("materials", [])):
        material["name"] = str(place)
        material.pop("extensions", None)
    return GltfFile(_joined(header, rest), notes, amounts)


def _split(content: bytes) -> tuple[dict[str, Any], bytes | None]:
    """The JSON, and the chunks that follow it in a GLB."""
    rest = None
    text = content
    if content[:4] == b"glTF":
        _, version, _, length, kind = struct.unpack_from("<5I", content)
        if version != 2 or kind != GLB_JSON:
            raise ValueError("not glTF 2.0")
        text, rest = content[20 : 20 + length], content[20 + length :]
    header = json.loads(text)
    if not isinstance(header, dict):
        raise ValueError("its JSON is not an object")
    return header, rest


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
