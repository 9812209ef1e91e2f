"""Where nodes and joints are: as the file's first animation begins, or as the nodes themselves say."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.parsing.malformed import MalformedError

PATHS = {"translation": 3, "rotation": 4, "scale": 3}
VERTICES_AT_ONCE = 1 << 16


class Pose:
    """Of a header that `checked` has passed and whose scene is a tree."""

    def __init__(self, header: dict[str, Any], arrays: Arrays, is_animated: bool) -> None:
        self._arrays = arrays
        self._nodes: list[dict[str, Any]] = header.get("nodes", [])
        self._skins: list[dict[str, Any]] = header.get("skins", [])
        self._first: dict[tuple[int, str], Float] = {}
        if is_animated:
            self._begin(header["animations"][0])
        self.worlds: dict[int, Float] = {}  # (4, 4) of every node of the scene that is seen
        scenes = header.get("scenes", [])
        self._place(scenes[header.get("scene", 0)].get("nodes", []) if scenes else [])
        self._joints: dict[int, Float] = {}

    def _begin(self, animation: dict[str, Any]) -> None:
        for channel in animation["channels"]:
            node, path = channel["target"].get("node"), channel["target"]["path"]
            if node is None or path not in (*PATHS, "weights"):
                continue
            if channel["sampler"] >= len(animation["samplers"]):
                raise MalformedError(f"a channel names sampler {channel['sampler']} of {len(animation['samplers'])}")
            sampler = animation["samplers"][channel["sampler"]]
            frames, values = self._arrays.numbers(sampler["input"]), self._arrays.floats(sampler["output"])
            # A cubic spline has three values each frame: the tangents are around what is reached.
            is_cubic = sampler.get("interpolation") == "CUBICSPLINE"
            each = len(values) // max(1, len(frames) * (3 if is_cubic else 1))
            first = values[each : 2 * each] if is_cubic else values[:each]
            if each and first.size == PATHS.get(path, first.size) and np.isfinite(first).all():
                self._first[node, path] = first.ravel()

    def _place(self, roots: list[int]) -> None:
        waiting = [(place, np.eye(4)) for place in roots]
        while waiting:
            place, parent = waiting.pop()
            node = self._nodes[place]
            if not node.get("extensions", {}).get("KHR_node_visibility", {}).get("visible", True):
                continue
            self.worlds[place] = world = parent @ self._local(place, node)
            waiting += [(child, world) for child in node.get("children", [])]

    def _local(self, place: int, node: dict[str, Any]) -> Float:
        moved = {path: self._first.get((place, path), node.get(path)) for path in PATHS}
        if "matrix" in node and not any((place, path) in self._first for path in PATHS):
            return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        return matrix_of(moved["translation"], moved["rotation"], moved["scale"])

    def weights(self, place: int, mesh: dict[str, Any]) -> Float:
        """Of the mesh's morph targets, at the node."""
        first = self._first.get((place, "weights"))
        given = self._nodes[place].get("weights", mesh.get("weights", ()))
        return np.asarray(given if first is None else first, dtype=np.float64)

    def joints(self, place: int) -> Float | None:
        """(joints, 4, 4) from the skin's bind pose to the scene, for the node at `place`; None without a skin."""
        skin = self._nodes[place].get("skin")
        if skin is None:
            return None
        if skin not in self._joints:
            joints = self._skins[skin]["joints"]
            bound = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
            if "inverseBindMatrices" in self._skins[skin]:
                stored = self._arrays.floats(self._skins[skin]["inverseBindMatrices"])
                if stored.shape[1] != 16 or len(stored) < len(joints):
                    raise MalformedError(f"skins[{skin}] has fewer inverse bind matrices than joints")
                bound = stored[: len(joints)].reshape(-1, 4, 4).swapaxes(1, 2)
            self._joints[skin] = np.stack([self.worlds.get(joint, np.eye(4)) for joint in joints]) @ bound
        return self._joints[skin]

    def instances(self, place: int) -> list[Float]:
        """(4, 4) each, from a mesh at the node to the scene: one, or as many as the node says."""
        own = self._nodes[place].get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {})
        if not own:
            return [self.worlds[place]]
        names = ("TRANSLATION", "ROTATION", "SCALE")
        columns = [self._arrays.floats(own[name]) if name in own else None for name in names]
        count = min(len(column) for column in columns if column is not None)
        rows = ([None if column is None else column[at] for column in columns] for at in range(count))
        return [self.worlds[place] @ matrix_of(*row) for row in rows]


def matrix_of(translation: Any, rotation: Any, scale: Any) -> Float:
    """(4, 4) that scales, then turns by the quaternion x, y, z, w, then moves; None for what is not done."""
    matrix: Float = np.eye(4)
    if rotation is not None:
        x, y, z, w = (float(value) for value in rotation)
        length = math.sqrt(x * x + y * y + z * z + w * w)
        if length > 0 and math.isfinite(length):
            x, y, z, w = x / length, y / length, z / length, w / length
            matrix[:3, :3] = (
                (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
            )
    if scale is not None:
        matrix[:3, :3] *= np.asarray(scale, dtype=np.float64)
    if translation is not None:
        matrix[:3, 3] = translation
    return matrix


def skinned(
    vertices: Float, normals: Float | None, joints: Float, influences: list[tuple[NDArray[np.int64], Float]]
) -> tuple[Float, Float | None]:
    """Vertices (n, 3) and normals (n, 3) moved by joints (m, 4, 4); an influence is joints (n, 4) and weights (n, 4).

    Linear blend skinning: section 3.7.3.3 of the specification. Raises MalformedError for joints that are not there.
    """
    for indices, _ in influences:
        if len(indices) and indices.max() >= len(joints):
            raise MalformedError(f"a vertex follows joint {indices.max()} of {len(joints)}")
    moved, turned = np.empty_like(vertices), None if normals is None else np.empty_like(normals)
    for first in range(0, len(vertices), VERTICES_AT_ONCE):
        some = slice(first, first + VERTICES_AT_ONCE)
        total = sum(weights[some].sum(axis=1) for _, weights in influences)
        blended = np.zeros((len(vertices[some]), 3, 4))
        for indices, weights in influences:
            for column in range(indices.shape[1]):
                blended += weights[some, column, None, None] * joints[indices[some, column], :3]
        blended /= np.where(total > 0, total, 1)[:, None, None]
        moved[some] = np.einsum("nij,nj->ni", blended[:, :, :3], vertices[some]) + blended[:, :, 3]
        if normals is not None and turned is not None:
            turned[some] = np.einsum("nij,nj->ni", blended[:, :, :3], normals[some])
    return moved, turned
