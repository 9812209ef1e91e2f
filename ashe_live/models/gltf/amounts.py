"""What a glTF's JSON says it takes: told before anything of it is allocated, or walked through node by node.

The JSON is one that `schema.checked` has passed.
"""

from dataclasses import dataclass
from typing import Any

from ashe_live.models.gltf.schema import (
    ATTRIBUTES,
    COMPONENT_BYTES,
    COMPONENTS,
    COMPRESSED_VIEWS,
    DISPLACED,
    INDICES,
)
from ashe_live.models.parsing.malformed import MalformedError

TRIANGLES, STRIP, FAN = 4, 5, 6  # modes of primitives; the others are points and lines


@dataclass(frozen=True, slots=True)
class GltfAmounts:
    """Each counted as often as it is read, used or drawn, whichever is more: what is shared is large in few bytes."""

    triangles: int
    vertices: int
    parts: int  # primitives of meshes
    bytes: int  # of the parts of buffers, or of the arrays made from them
    nodes: int  # of the scene
    depth: int  # of nodes within nodes


def amounts_of(header: dict[str, Any]) -> GltfAmounts:
    """Raises MalformedError when its nodes are no tree, or a primitive is none."""
    accessors, nodes = header.get("accessors", []), header.get("nodes", [])
    meshes = [mesh["primitives"] for mesh in header.get("meshes", [])]
    triangles = [sum(_triangles(primitive, accessors) for primitive in mesh) for mesh in meshes]
    vertices = [sum(accessors[primitive["attributes"]["POSITION"]]["count"] for primitive in mesh) for mesh in meshes]
    parts = [len(mesh) for mesh in meshes]
    drawn: list[tuple[int, int]] = [(node["mesh"], instances(node, accessors)) for node in nodes if "mesh" in node]

    def most(of_meshes: list[int]) -> int:
        return max(sum(of_meshes), sum(of_meshes[mesh] * times for mesh, times in drawn))

    views = sum(view["byteLength"] for view in header.get("bufferViews", []))
    arrays = sum(accessor["count"] * item_bytes(accessor) for accessor in accessors)
    node_count, depth = _tree(header, nodes)
    return GltfAmounts(most(triangles), most(vertices), most(parts), max(views, arrays), node_count, depth)


def instances(node: dict[str, Any], accessors: list[dict[str, Any]]) -> int:
    """How often a node's mesh is drawn."""
    own = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {})
    counts: list[int] = [accessors[place]["count"] for place in own.values()]
    return min(counts, default=1)


def compression_of(view: dict[str, Any]) -> dict[str, Any] | None:
    """The extension that describes how a view is compressed; None if it is not."""
    extensions: dict[str, Any] = view.get("extensions", {})
    return next((extensions[name] for name in COMPRESSED_VIEWS if name in extensions), None)


def item_bytes(accessor: dict[str, Any]) -> int:
    components: int = COMPONENTS[accessor["type"]]
    return components * COMPONENT_BYTES[accessor["componentType"]]


def check_layout(header: dict[str, Any]) -> None:
    """Raises MalformedError where an array reaches beyond what it lies in, or is not of the kind that it is used as."""
    accessors, views = header.get("accessors", []), header.get("bufferViews", [])
    for place, view in enumerate(views):
        _check_view(place, view, header["buffers"])
    for place, accessor in enumerate(accessors):
        _check_accessor(f"accessors[{place}]", accessor, views)
    for mesh_place, mesh in enumerate(header.get("meshes", [])):
        for place, primitive in enumerate(mesh["primitives"]):
            _check_primitive(f"meshes[{mesh_place}].primitives[{place}]", primitive, accessors)


def _check_view(place: int, view: dict[str, Any], buffers: list[dict[str, Any]]) -> None:
    compressed = compression_of(view)
    if compressed is not None and compressed["byteStride"] * compressed["count"] != view["byteLength"]:
        held = f"{compressed['count']} times {compressed['byteStride']} bytes"
        raise MalformedError(f"bufferViews[{place}] is of {view['byteLength']} bytes, and its compression of {held}")
    source = compressed or view
    end, length = source.get("byteOffset", 0) + source["byteLength"], buffers[source["buffer"]]["byteLength"]
    if end > length:
        raise MalformedError(f"bufferViews[{place}] ends at byte {end} of a buffer of {length}")


def _check_accessor(where: str, accessor: dict[str, Any], views: list[dict[str, Any]]) -> None:
    item = item_bytes(accessor)
    if "bufferView" in accessor and accessor["count"] > 0:
        view = views[accessor["bufferView"]]
        end = accessor.get("byteOffset", 0) + (accessor["count"] - 1) * view.get("byteStride", item) + item
        _check_end(where, end, view)
    sparse = accessor.get("sparse")
    if sparse is None:
        return
    if sparse["count"] > accessor["count"]:
        raise MalformedError(f"{where}.sparse.count is {sparse['count']} of {accessor['count']} items")
    for part, size in (("indices", COMPONENT_BYTES[sparse["indices"]["componentType"]]), ("values", item)):
        place = sparse[part]
        end = place.get("byteOffset", 0) + sparse["count"] * size
        _check_end(f"{where}.sparse.{part}", end, views[place["bufferView"]])


def _check_end(where: str, end: int, view: dict[str, Any]) -> None:
    if end > view["byteLength"]:
        raise MalformedError(f"{where} ends at byte {end} of a bufferView of {view['byteLength']}")


def _check_primitive(where: str, primitive: dict[str, Any], accessors: list[dict[str, Any]]) -> None:
    attributes = primitive["attributes"]
    used = {name: (accessors[at], ATTRIBUTES[name]) for name, at in attributes.items()}
    for number, target in enumerate(primitive.get("targets", [])):
        used |= {f"targets[{number}].{name}": (accessors[at], DISPLACED[name]) for name, at in target.items()}
    if "indices" in primitive:
        used["indices"] = accessors[primitive["indices"]], INDICES
    for name, (accessor, (types, component_types)) in used.items():
        if accessor["type"] not in types or accessor["componentType"] not in component_types:
            kind = f"{accessor['type']} of componentType {accessor['componentType']}"
            raise MalformedError(f"{where}: {name} cannot be {kind}")
        count = accessors[attributes["POSITION"]]["count"]
        if name != "indices" and accessor["count"] != count:
            raise MalformedError(f"{where}: {name} has {accessor['count']} items for {count} vertices")
    corners = _corners(primitive, accessors)
    if primitive.get("mode", TRIANGLES) == TRIANGLES and corners % 3:
        raise MalformedError(f"{where} has {corners} corners, which are no triangles")


def _corners(primitive: dict[str, Any], accessors: list[dict[str, Any]]) -> int:
    return int(accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"])


def _triangles(primitive: dict[str, Any], accessors: list[dict[str, Any]]) -> int:
    corners = _corners(primitive, accessors)
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        return corners // 3
    return max(corners - 2, 0) if mode in (STRIP, FAN) else 0


def _tree(header: dict[str, Any], nodes: list[dict[str, Any]]) -> tuple[int, int]:
    """Number of the scene's nodes, and depth of their tree.

    Raises MalformedError when one stands in two places.
    """
    scenes = header.get("scenes", [])
    level = list(scenes[header.get("scene", 0)].get("nodes", [])) if scenes else []
    seen: set[int] = set()
    depth = 0
    while level:
        again = seen.intersection(level)
        if again or len(set(level)) < len(level):
            raise MalformedError(f"node {min(again, default=level[0])} stands in two places")
        seen.update(level)
        level = [child for node in level for child in nodes[node].get("children", [])]
        depth += 1
    return len(seen), depth
