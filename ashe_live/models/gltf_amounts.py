"""What a glTF file's JSON says it takes: told before anything of it is allocated, or walked through node by node."""

from dataclasses import dataclass
from typing import Any

COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


@dataclass(frozen=True, slots=True)
class GltfAmounts:
    """Each counted as often as it is read, used or drawn, whichever is more: what is shared is large in few bytes."""

    triangles: int
    vertices: int
    parts: int  # primitives of meshes
    bytes: int  # of the parts of buffers, or of the arrays made from them
    depth: int  # of nodes within nodes


def amounts_of(header: dict[str, Any]) -> GltfAmounts:
    """From a glTF's JSON. Raises ValueError when its nodes are no tree, and else as wrong JSON makes it."""
    accessors, nodes = header.get("accessors", []), header.get("nodes", [])
    meshes = [mesh["primitives"] for mesh in header.get("meshes", [])]
    triangles = [sum(_triangles(primitive, accessors) for primitive in mesh) for mesh in meshes]
    vertices = [sum(_count(accessors[primitive["attributes"]["POSITION"]]) for primitive in mesh) for mesh in meshes]
    parts = [len(mesh) for mesh in meshes]
    drawn: list[int] = [node["mesh"] for node in nodes if "mesh" in node]

    def most(of_meshes: list[int]) -> int:
        return max(sum(of_meshes), sum(of_meshes[mesh] for mesh in drawn))

    views = sum(_count(view, "byteLength") for view in header.get("bufferViews", []))
    return GltfAmounts(
        most(triangles), most(vertices), most(parts), max(views, sum(map(_bytes, accessors))), _depth(header, nodes)
    )


def _count(item: dict[str, Any], key: str = "count") -> int:
    count = int(item[key])
    if count < 0:
        raise ValueError(f"{key} is {count}")  # in a sum it would make room for others
    return count


def _triangles(primitive: dict[str, Any], accessors: list[dict[str, Any]]) -> int:
    corners = _count(accessors[primitive.get("indices", primitive["attributes"]["POSITION"])])
    match primitive.get("mode", 4):
        case 4:
            return corners // 3
        case 5 | 6:
            return max(corners - 2, 0)
        case _:
            return 0


def _bytes(accessor: dict[str, Any]) -> int:
    components: int = COMPONENTS[accessor["type"]]
    return _count(accessor) * components * COMPONENT_BYTES[accessor["componentType"]]


def _depth(header: dict[str, Any], nodes: list[dict[str, Any]]) -> int:
    """How many nodes stand one within another, at most. Raises ValueError when one stands in two places."""
    scenes = header.get("scenes", [])
    level = list(scenes[header.get("scene", 0)].get("nodes", [])) if scenes else []
    seen: set[int] = set()
    depth = 0
    while level:
        again = seen.intersection(level)
        if again or len(set(level)) < len(level):
            raise ValueError(f"node {min(again, default=level[0])} stands in two places")
        seen.update(level)
        level = [child for node in level for child in nodes[node].get("children", [])]
        depth += 1
    return depth
