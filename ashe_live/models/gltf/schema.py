"""What of a glTF's JSON is read here: checked, and copied without all the rest.

What is left out (extras, names, cameras, unknown extensions and attributes) can be of any size and kind. What is kept
has the right type, and every index names something that is there.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#properties-reference
"""

from ashe_live.models.gltf.layouts import ATTRIBUTES, COMPONENT_TYPES, COMPONENTS, DISPLACED, INDICES
from ashe_live.models.parsing.json_kinds import (
    Json,
    Required,
    WrongValueError,
    flag,
    index_of,
    integer_from,
    list_of,
    number,
    object_of,
    one_of,
    share,
    text,
)
from ashe_live.models.parsing.malformed import MalformedError

# Properties of views whose content is compressed; the second is the first's successor, and has the same fields.
COMPRESSED_VIEWS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
TEXTURE_SOURCES = ("EXT_texture_webp", "KHR_texture_basisu")
REPEAT, MIRRORED_REPEAT, CLAMP_TO_EDGE = WRAPS = 10497, 33648, 33071

_TEXTURE_INFO = object_of(
    {
        "index": Required(index_of("textures")),
        "texCoord": integer_from(0),
        "scale": number,
        "strength": share,
        "extensions": object_of(
            {
                "KHR_texture_transform": object_of(
                    {
                        "offset": list_of(number, 2),
                        "rotation": number,
                        "scale": list_of(number, 2),
                        "texCoord": integer_from(0),
                    }
                )
            }
        ),
    }
)
_MATERIAL = object_of(
    {
        "pbrMetallicRoughness": object_of(
            {
                "baseColorFactor": list_of(share, 4),
                "baseColorTexture": _TEXTURE_INFO,
                "metallicFactor": share,
                "roughnessFactor": share,
                "metallicRoughnessTexture": _TEXTURE_INFO,
            }
        ),
        "normalTexture": _TEXTURE_INFO,
        "occlusionTexture": _TEXTURE_INFO,
        "emissiveTexture": _TEXTURE_INFO,
        "emissiveFactor": list_of(share, 3),
        "alphaMode": one_of(("OPAQUE", "MASK", "BLEND")),
        "alphaCutoff": number,
        "doubleSided": flag,
        "extensions": object_of(
            {
                "KHR_materials_clearcoat": object_of(
                    {"clearcoatFactor": share, "clearcoatRoughnessFactor": share, "clearcoatTexture": _TEXTURE_INFO}
                ),
                "KHR_materials_emissive_strength": object_of({"emissiveStrength": number}),
                "KHR_materials_pbrSpecularGlossiness": object_of(
                    {
                        "diffuseFactor": list_of(share, 4),
                        "diffuseTexture": _TEXTURE_INFO,
                        "specularFactor": list_of(share, 3),
                        "glossinessFactor": share,
                        "specularGlossinessTexture": _TEXTURE_INFO,
                    }
                ),
                "KHR_materials_transmission": object_of(
                    {"transmissionFactor": share, "transmissionTexture": _TEXTURE_INFO}
                ),
                "KHR_materials_unlit": object_of({}),
            }
        ),
    }
)
_PRIMITIVE = object_of(
    {
        "attributes": Required(object_of(dict.fromkeys(ATTRIBUTES, index_of("accessors")))),
        "indices": index_of("accessors"),
        "material": index_of("materials"),
        "mode": one_of(range(7)),
        "targets": list_of(object_of(dict.fromkeys(DISPLACED, index_of("accessors")))),
        "extensions": object_of(
            {
                "KHR_draco_mesh_compression": object_of(
                    {
                        "bufferView": Required(index_of("bufferViews")),
                        "attributes": Required(object_of(dict.fromkeys(ATTRIBUTES, integer_from(0)))),
                    }
                )
            }
        ),
    }
)
_COMPRESSED = object_of(
    {
        "buffer": Required(index_of("buffers")),
        "byteOffset": integer_from(0),
        "byteLength": Required(integer_from(0)),
        "byteStride": Required(integer_from(1)),
        "count": Required(integer_from(0)),
        "mode": Required(one_of(("ATTRIBUTES", "TRIANGLES", "INDICES"))),
        "filter": one_of(("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")),
    }
)
_SPARSE = object_of(
    {
        "count": Required(integer_from(1)),
        "indices": Required(
            object_of(
                {
                    "bufferView": Required(index_of("bufferViews")),
                    "byteOffset": integer_from(0),
                    "componentType": Required(one_of(INDICES[1])),
                }
            )
        ),
        "values": Required(object_of({"bufferView": Required(index_of("bufferViews")), "byteOffset": integer_from(0)})),
    }
)
_CHANNEL = object_of(
    {
        "sampler": Required(integer_from(0)),
        "target": Required(object_of({"node": index_of("nodes"), "path": Required(text)})),
    }
)
_ANIMATION_SAMPLER = object_of(
    {
        "input": Required(index_of("accessors")),
        "output": Required(index_of("accessors")),
        "interpolation": one_of(("LINEAR", "STEP", "CUBICSPLINE")),
    }
)
_NODE = object_of(
    {
        "children": list_of(index_of("nodes")),
        "mesh": index_of("meshes"),
        "skin": index_of("skins"),
        "weights": list_of(number),
        "matrix": list_of(number, 16),
        "translation": list_of(number, 3),
        "rotation": list_of(number, 4),
        "scale": list_of(number, 3),
        "extensions": object_of(
            {
                "EXT_mesh_gpu_instancing": object_of(
                    {
                        "attributes": Required(
                            object_of(dict.fromkeys(("TRANSLATION", "ROTATION", "SCALE"), index_of("accessors")))
                        )
                    }
                ),
                "KHR_node_visibility": object_of({"visible": flag}),
            }
        ),
    }
)
_ACCESSOR = object_of(
    {
        "bufferView": index_of("bufferViews"),
        "byteOffset": integer_from(0),
        "componentType": Required(one_of(COMPONENT_TYPES)),
        "count": Required(integer_from(0)),
        "type": Required(one_of(COMPONENTS)),
        "normalized": flag,
        "sparse": _SPARSE,
    }
)
_BUFFER_VIEW = object_of(
    {
        "buffer": Required(index_of("buffers")),
        "byteOffset": integer_from(0),
        "byteLength": Required(integer_from(0)),
        "byteStride": integer_from(1),
        "extensions": object_of(dict.fromkeys(COMPRESSED_VIEWS, _COMPRESSED)),
    }
)
_TEXTURE = object_of(
    {
        "source": index_of("images"),
        "sampler": index_of("samplers"),
        "extensions": object_of(dict.fromkeys(TEXTURE_SOURCES, object_of({"source": index_of("images")}))),
    }
)
_LISTS = {
    "scenes": object_of({"nodes": list_of(index_of("nodes"))}),
    "nodes": _NODE,
    "meshes": object_of({"primitives": Required(list_of(_PRIMITIVE)), "weights": list_of(number)}),
    "skins": object_of({"joints": Required(list_of(index_of("nodes"))), "inverseBindMatrices": index_of("accessors")}),
    "animations": object_of(
        {"channels": Required(list_of(_CHANNEL)), "samplers": Required(list_of(_ANIMATION_SAMPLER))}
    ),
    "accessors": _ACCESSOR,
    "bufferViews": _BUFFER_VIEW,
    "buffers": object_of({"uri": text, "byteLength": Required(integer_from(0))}),
    "materials": _MATERIAL,
    "textures": _TEXTURE,
    "samplers": object_of({"magFilter": integer_from(0), "wrapS": one_of(WRAPS), "wrapT": one_of(WRAPS)}),
    "images": object_of({"uri": text, "bufferView": index_of("bufferViews")}),
}
_DOCUMENT = object_of(
    {
        "asset": Required(object_of({"version": Required(text)})),
        "scene": index_of("scenes"),
        **{name: list_of(kind) for name, kind in _LISTS.items()},
    }
)


def checked(document: Json) -> Json:
    """The document's copy, in which every list is there, if only an empty one.

    Raises MalformedError, such as for "nodes[3].mesh is 7, and there are 2 meshes".
    """
    counts = {name: len(value) for name, value in document.items() if isinstance(value, list)}
    try:
        copy: Json = _DOCUMENT(document, counts)
    except WrongValueError as error:
        raise MalformedError(f"{error.where[1:]} {error.what}") from None
    return {**{name: [] for name in _LISTS}, **copy}
