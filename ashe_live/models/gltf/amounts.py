"""What a glTF's JSON says it takes: told before anything of it is allocated, or walked through node by node.

The JSON is one that `schema.checked` has passed.
"""

from ashe_live.models.gltf.layouts import ATTRIBUTES, COMPONENT_TYPES, COMPONENTS, DISPLACED, INDICES
from ashe_live.models.gltf.schema import COMPRESSED_VIEWS
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.limits import GltfAmounts
from ashe_live.models.parsing.malformed import MalformedError

TRIANGLES, STRIP, FAN = 4, 5, 6  # modes of primitives; the others are points and lines


def amounts_of(header: Json) -> GltfAmounts:
    """Raises MalformedError when its nodes are no tree, or a primitive is none."""
    accessors, nodes = header["accessors"], header["nodes"]
    meshes = [mesh["primitives"] for mesh in header["meshes"]]
    triangles = [sum(_triangles(primitive, accessors) for primitive in mesh) for mesh in meshes]
    vertices = [sum(accessors[primitive["attributes"]["POSITION"]]["count"] for primitive in mesh) for mesh in meshes]
    parts = [len(mesh) for mesh in meshes]
    drawn: list[tuple[int, int]] = [(node["mesh"], instances(node, accessors)) for node in nodes if "mesh" in node]

    def most(of_meshes: list[int]) -> int:
        return max(sum(of_meshes), sum(of_meshes[mesh] * times for mesh, times in drawn))

    views = sum(view["byteLength"] for view in header["bufferViews"])
    arrays = sum(accessor["count"] * item_bytes(accessor) for accessor in accessors)
    node_count, depth = _tree(header)
    return GltfAmounts(most(triangles), most(vertices), most(parts), max(views, arrays), node_count, depth)


def instances(node: Json, accessors: list[Json]) -> int:
    """How often a node's mesh is drawn."""
    counts: list[int] = [accessors[place]["count"] for place in instancing_of(node).values()]
    return min(counts, default=1)


def instancing_of(node: Json) -> dict[str, int]:
    """The accessors by which a node's mesh is drawn several times, by what they hold; none if it is drawn once."""
    attributes: dict[str, int] = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {})
    return attributes


def compression_of(view: Json) -> Json | None:
    """The extension that describes how a view is compressed; None if it is not."""
    extensions: Json = view.get("extensions", {})
    return next((extensions[name] for name in COMPRESSED_VIEWS if name in extensions), None)


def item_bytes(accessor: Json) -> int:
    components: int = COMPONENTS[accessor["type"]]
    return components * COMPONENT_TYPES[accessor["componentType"]].itemsize


def check_layout(header: Json) -> None:
    """Raises MalformedError where an array reaches beyond what it lies in, or is not of the kind that it is used as."""
    accessors, views = header["accessors"], header["bufferViews"]
    for place, view in enumerate(views):
        _check_view(place, view, header["buffers"])
    for place, accessor in enumerate(accessors):
        _check_accessor(f"accessors[{place}]", accessor, views)
    for mesh_place, mesh in enumerate(header["meshes"]):
        for place, primitive in enumerate(mesh["primitives"]):
            _check_primitive(f"meshes[{mesh_place}].primitives[{place}]", primitive, accessors)


def _check_view(place: int, view: Json, buffers: list[Json]) -> None:
    compressed = compression_of(view)
    if compressed is not None and compressed["byteStride"] * compressed["count"] != view["byteLength"]:
        held = f"{compressed['count']} times {compressed['byteStride']} bytes"
        raise MalformedError(f"bufferViews[{place}] is of {view['byteLength']} bytes, and its compression of {held}")
    source = compressed or view
    end, length = source.get("byteOffset", 0) + source["byteLength"], buffers[source["buffer"]]["byteLength"]
    if end > length:
        raise MalformedError(f"bufferViews[{place}] ends at byte {end} of a buffer of {length}")


def _check_accessor(where: str, accessor: Json, views: list[Json]) -> None:
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
    for part, size in (("indices", COMPONENT_TYPES[sparse["indices"]["componentType"]].itemsize), ("values", item)):
        place = sparse[part]
        end = place.get("byteOffset", 0) + sparse["count"] * size
        _check_end(f"{where}.sparse.{part}", end, views[place["bufferView"]])


def _check_end(where: str, end: int, view: Json) -> None:
    if end > view["byteLength"]:
        raise MalformedError(f"{where} ends at byte {end} of a bufferView of {view['byteLength']}")


def _check_primitive(where: str, primitive: Json, accessors: list[Json]) -> None:
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


def _corners(primitive: Json, accessors: list[Json]) -> int:
    return int(accessors[primitive.get("indices", primitive["attributes"]["POSITION"])]["count"])


def _triangles(primitive: Json, accessors: list[Json]) -> int:
    corners = _corners(primitive, accessors)
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        return corners // 3
    return max(corners - 2, 0) if mode in (STRIP, FAN) else 0


def roots_of(header: Json) -> list[int]:
    """The nodes at the top of the scene that is shown; of a file without scenes those within no other."""
    scenes: list[Json] = header["scenes"]
    if scenes:
        return list(scenes[header.get("scene", 0)].get("nodes", []))
    within = {child for node in header["nodes"] for child in node.get("children", [])}
    return [place for place in range(len(header["nodes"])) if place not in within]


def _tree(header: Json) -> tuple[int, int]:
    """Number of the scene's nodes, and depth of their tree.

    Raises MalformedError when one stands in two places.
    """
    nodes, level = header["nodes"], roots_of(header)
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
