"""What of a glTF's JSON is read here: checked, and copied without all the rest.

What is left out (extras, names, cameras, unknown extensions and attributes) can be of any size and kind. What is kept
has the right type, and every index names something that is there.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#properties-reference
"""

import json
import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.process.messages import printable

Json = dict[str, Any]
# A value's checked copy. The second argument says how many of each property of the document there are.
Kind = Callable[[Any, Mapping[str, int]], Any]

SHOWN_CHARACTERS = 40
LARGEST_INTEGER = 2**53  # that JSON carries between programs
LARGEST = 1e30  # of numbers: products of a few stay finite
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
SHARES = (5126, 5121, 5123)  # floats, and integers as shares of their largest
QUANTISED = (5126, 5120, 5121, 5122, 5123)  # KHR_mesh_quantization
UV_SETS = 4
# Attributes that are drawn, with what the specification lets their accessors be.
Layout = tuple[tuple[str, ...], tuple[int, ...]]
ATTRIBUTES: dict[str, Layout] = {
    "POSITION": (("VEC3",), QUANTISED),
    "NORMAL": (("VEC3",), (5126, 5120, 5122)),
    **{f"TEXCOORD_{number}": (("VEC2",), QUANTISED) for number in range(UV_SETS)},
    "COLOR_0": (("VEC3", "VEC4"), SHARES),
    **{f"JOINTS_{number}": (("VEC4",), (5121, 5123)) for number in range(2)},
    **{f"WEIGHTS_{number}": (("VEC4",), SHARES) for number in range(2)},
}
DISPLACED: dict[str, Layout] = {"POSITION": (("VEC3",), QUANTISED), "NORMAL": (("VEC3",), (5126, 5120, 5122))}
# Properties of views whose content is compressed; the second is the first's successor and reads the same.
COMPRESSED_VIEWS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
TEXTURE_SOURCES = ("EXT_texture_webp", "KHR_texture_basisu")
REPEAT, MIRRORED_REPEAT, CLAMP_TO_EDGE = WRAPS = 10497, 33648, 33071
INDICES: Layout = (("SCALAR",), (5121, 5123, 5125))


class _WrongError(Exception):
    """`where` grows on the way out, from the value to the document."""

    def __init__(self, what: str) -> None:
        super().__init__(what)
        self.what, self.where = what, ""

    def within(self, key: str | int) -> "_WrongError":
        self.where = (f"[{key}]" if isinstance(key, int) else f".{key}") + self.where
        return self


@dataclass(frozen=True, slots=True)
class _Required:
    kind: Kind


def checked(document: Json) -> Json:
    """Raises MalformedError, such as for "nodes[3].mesh is 7, and there are 2 meshes"."""
    counts = {name: len(value) for name, value in document.items() if isinstance(value, list)}
    try:
        copy: Json = _DOCUMENT(document, counts)
    except _WrongError as error:
        raise MalformedError(f"{error.where[1:]} {error.what}") from None
    return copy


def _shown(value: object) -> str:
    match value:
        case dict():
            return "an object"
        case list():
            return f"a list of {len(value)}"
        case _:
            return printable(json.dumps(value), SHOWN_CHARACTERS)


def _object(fields: Mapping[str, Kind | _Required]) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> Json:
        if not isinstance(value, dict):
            raise _WrongError(f"is {_shown(value)}, not an object")
        copy = {}
        for name, field in fields.items():
            if name not in value:
                if isinstance(field, _Required):
                    raise _WrongError("is missing").within(name)
                continue
            try:
                copy[name] = (field.kind if isinstance(field, _Required) else field)(value[name], counts)
            except _WrongError as error:
                raise error.within(name) from None
        return copy

    return check


def _list(kind: Kind, length: int | None = None) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> list[Any]:
        if not isinstance(value, list) or (length is not None and len(value) != length):
            wanted = "a list" if length is None else f"a list of {length} values"
            raise _WrongError(f"is {_shown(value)}, not {wanted}")
        copy = []
        for place, item in enumerate(value):
            try:
                copy.append(kind(item, counts))
            except _WrongError as error:
                raise error.within(place) from None
        return copy

    return check


def _index(of: str) -> Kind:
    def check(value: Any, counts: Mapping[str, int]) -> int:
        count = counts.get(of, 0)
        if type(value) is not int or not 0 <= value < count:
            raise _WrongError(f"is {_shown(value)}, and there are {count} {of}")
        return value

    return check


def _integer(least: int) -> Kind:
    def check(value: Any, _: Mapping[str, int]) -> int:
        if type(value) is not int or not least <= value <= LARGEST_INTEGER:
            raise _WrongError(f"is {_shown(value)}, not an integer from {least}")
        return value

    return check


def _number(value: Any, _: Mapping[str, int]) -> float:
    if type(value) not in (int, float) or abs(value) > LARGEST or not math.isfinite(value):
        raise _WrongError(f"is {_shown(value)}, not a number")
    return float(value)


def _share(value: Any, counts: Mapping[str, int]) -> float:
    return min(max(_number(value, counts), 0.0), 1.0)


def _text(value: Any, _: Mapping[str, int]) -> str:
    if not isinstance(value, str):
        raise _WrongError(f"is {_shown(value)}, not a string")
    return value


def _flag(value: Any, _: Mapping[str, int]) -> bool:
    if not isinstance(value, bool):
        raise _WrongError(f"is {_shown(value)}, not true or false")
    return value


def _one_of(choices: Collection[int | str]) -> Kind:
    def check(value: Any, _: Mapping[str, int]) -> Any:
        if isinstance(value, bool | list | dict) or value not in choices:
            raise _WrongError(f"is {_shown(value)}, not one of {', '.join(map(str, choices))}")
        return value

    return check


_TEXTURE = _object(
    {
        "index": _Required(_index("textures")),
        "texCoord": _integer(0),
        "scale": _number,
        "strength": _share,
        "extensions": _object(
            {
                "KHR_texture_transform": _object(
                    {
                        "offset": _list(_number, 2),
                        "rotation": _number,
                        "scale": _list(_number, 2),
                        "texCoord": _integer(0),
                    }
                )
            }
        ),
    }
)
_MATERIAL = _object(
    {
        "pbrMetallicRoughness": _object(
            {
                "baseColorFactor": _list(_share, 4),
                "baseColorTexture": _TEXTURE,
                "metallicFactor": _share,
                "roughnessFactor": _share,
                "metallicRoughnessTexture": _TEXTURE,
            }
        ),
        "normalTexture": _TEXTURE,
        "occlusionTexture": _TEXTURE,
        "emissiveTexture": _TEXTURE,
        "emissiveFactor": _list(_share, 3),
        "alphaMode": _one_of(("OPAQUE", "MASK", "BLEND")),
        "alphaCutoff": _number,
        "doubleSided": _flag,
        "extensions": _object(
            {
                "KHR_materials_emissive_strength": _object({"emissiveStrength": _number}),
                "KHR_materials_pbrSpecularGlossiness": _object(
                    {
                        "diffuseFactor": _list(_share, 4),
                        "diffuseTexture": _TEXTURE,
                        "specularFactor": _list(_share, 3),
                        "glossinessFactor": _share,
                        "specularGlossinessTexture": _TEXTURE,
                    }
                ),
                "KHR_materials_transmission": _object({"transmissionFactor": _share}),
                "KHR_materials_unlit": _object({}),
            }
        ),
    }
)
_PRIMITIVE = _object(
    {
        "attributes": _Required(_object(dict.fromkeys(ATTRIBUTES, _index("accessors")))),
        "indices": _index("accessors"),
        "material": _index("materials"),
        "mode": _one_of(range(7)),
        "targets": _list(_object(dict.fromkeys(DISPLACED, _index("accessors")))),
        "extensions": _object(
            {
                "KHR_draco_mesh_compression": _object(
                    {
                        "bufferView": _Required(_index("bufferViews")),
                        "attributes": _Required(_object(dict.fromkeys(ATTRIBUTES, _integer(0)))),
                    }
                )
            }
        ),
    }
)
_COMPRESSED = _object(
    {
        "buffer": _Required(_index("buffers")),
        "byteOffset": _integer(0),
        "byteLength": _Required(_integer(0)),
        "byteStride": _Required(_integer(1)),
        "count": _Required(_integer(0)),
        "mode": _Required(_one_of(("ATTRIBUTES", "TRIANGLES", "INDICES"))),
        "filter": _one_of(("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL")),
    }
)
_SPARSE = _object(
    {
        "count": _Required(_integer(1)),
        "indices": _Required(
            _object(
                {
                    "bufferView": _Required(_index("bufferViews")),
                    "byteOffset": _integer(0),
                    "componentType": _Required(_one_of(INDICES[1])),
                }
            )
        ),
        "values": _Required(_object({"bufferView": _Required(_index("bufferViews")), "byteOffset": _integer(0)})),
    }
)
_CHANNEL = _object(
    {
        "sampler": _Required(_integer(0)),
        "target": _Required(_object({"node": _index("nodes"), "path": _Required(_text)})),
    }
)
_SAMPLER = _object(
    {
        "input": _Required(_index("accessors")),
        "output": _Required(_index("accessors")),
        "interpolation": _one_of(("LINEAR", "STEP", "CUBICSPLINE")),
    }
)
_INSTANCES = dict.fromkeys(("TRANSLATION", "ROTATION", "SCALE"), _index("accessors"))
_DOCUMENT = _object(
    {
        "asset": _Required(_object({"version": _Required(_text)})),
        "scene": _index("scenes"),
        "scenes": _list(_object({"nodes": _list(_index("nodes"))})),
        "nodes": _list(
            _object(
                {
                    "children": _list(_index("nodes")),
                    "mesh": _index("meshes"),
                    "skin": _index("skins"),
                    "weights": _list(_number),
                    "matrix": _list(_number, 16),
                    "translation": _list(_number, 3),
                    "rotation": _list(_number, 4),
                    "scale": _list(_number, 3),
                    "extensions": _object(
                        {
                            "EXT_mesh_gpu_instancing": _object({"attributes": _Required(_object(_INSTANCES))}),
                            "KHR_node_visibility": _object({"visible": _flag}),
                        }
                    ),
                }
            )
        ),
        "meshes": _list(_object({"primitives": _Required(_list(_PRIMITIVE)), "weights": _list(_number)})),
        "skins": _list(
            _object({"joints": _Required(_list(_index("nodes"))), "inverseBindMatrices": _index("accessors")})
        ),
        "animations": _list(
            _object({"channels": _Required(_list(_CHANNEL)), "samplers": _Required(_list(_SAMPLER)), "name": _text})
        ),
        "accessors": _list(
            _object(
                {
                    "bufferView": _index("bufferViews"),
                    "byteOffset": _integer(0),
                    "componentType": _Required(_one_of(COMPONENT_BYTES)),
                    "count": _Required(_integer(0)),
                    "type": _Required(_one_of(COMPONENTS)),
                    "normalized": _flag,
                    "sparse": _SPARSE,
                }
            )
        ),
        "bufferViews": _list(
            _object(
                {
                    "buffer": _Required(_index("buffers")),
                    "byteOffset": _integer(0),
                    "byteLength": _Required(_integer(0)),
                    "byteStride": _integer(1),
                    "extensions": _object(dict.fromkeys(COMPRESSED_VIEWS, _COMPRESSED)),
                }
            )
        ),
        "buffers": _list(_object({"uri": _text, "byteLength": _Required(_integer(0))})),
        "materials": _list(_MATERIAL),
        "textures": _list(
            _object(
                {
                    "source": _index("images"),
                    "sampler": _index("samplers"),
                    "extensions": _object(dict.fromkeys(TEXTURE_SOURCES, _object({"source": _index("images")}))),
                }
            )
        ),
        "samplers": _list(_object({"magFilter": _integer(0), "wrapS": _one_of(WRAPS), "wrapT": _one_of(WRAPS)})),
        "images": _list(_object({"uri": _text, "bufferView": _index("bufferViews"), "mimeType": _text})),
    }
)
