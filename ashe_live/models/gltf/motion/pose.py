"""Where nodes and joints are, and with them the vertices that follow: at a moment of an animation, or without one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.gltf.amounts import instancing_of, roots_of
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.gltf.motion.animation import PATHS, Changes
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError

VERTICES_AT_ONCE = 1 << 16


class Pose:
    """Places of nodes and joints, for a header that `checked` has passed and whose scene is a tree."""

    def __init__(self, header: Json, arrays: Arrays, changes: Changes) -> None:
        """`changes`: what an animation does to nodes at that moment."""
        self._arrays = arrays
        self._nodes: list[Json] = header["nodes"]
        self._skins: list[Json] = header["skins"]
        self._changes = changes
        self.worlds: dict[int, Float] = {}  # (4, 4) of every node of the scene that is seen
        self._all_worlds: dict[int, Float] = {}  # of the others too: what is not seen may move a skin that is
        self._place(roots_of(header))
        self._joints: dict[int, Float] = {}

    def _place(self, roots: list[int]) -> None:
        waiting = [(place, np.eye(4), True) for place in roots]
        while waiting:
            place, parent, is_seen = waiting.pop()
            node = self._nodes[place]
            is_seen &= node.get("extensions", {}).get("KHR_node_visibility", {}).get("visible", True)
            self._all_worlds[place] = world = parent @ self._local(place, node)
            if is_seen:
                self.worlds[place] = world
            waiting += [(child, world, is_seen) for child in node.get("children", [])]

    def _local(self, place: int, node: Json) -> Float:
        moved = {path: self._changes.get((place, path), node.get(path)) for path in PATHS}
        if "matrix" in node and not any((place, path) in self._changes for path in PATHS):
            return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        return matrix_of(moved["translation"], moved["rotation"], moved["scale"])

    def weights(self, place: int, mesh: Json) -> Float:
        """(t,) weights of the mesh's morph targets, at the node."""
        changed = self._changes.get((place, "weights"))
        given = self._nodes[place].get("weights", mesh.get("weights", ()))
        return np.asarray(given if changed is None else changed, dtype=np.float64)

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
            self._joints[skin] = np.stack([self._all_worlds.get(joint, np.eye(4)) for joint in joints]) @ bound
        return self._joints[skin]

    def moved_by(self, targets: frozenset[tuple[int, str]]) -> frozenset[int]:
        """Nodes with meshes that look different when these nodes and paths change."""
        moved: set[int] = {node for node, path in targets if path in PATHS}
        waiting = list(moved)
        while waiting:
            children = set(self._nodes[waiting.pop()].get("children", [])) - moved
            moved |= children
            waiting += children
        skins = {number for number, skin in enumerate(self._skins) if moved.intersection(skin["joints"])}
        follow = {place for place, node in enumerate(self._nodes) if node.get("skin") in skins}
        # A skin's joints say where it is, and the node that bears it does not.
        stand = {place for place in moved if "skin" not in self._nodes[place]}
        return frozenset(follow | stand | {node for node, path in targets if path == "weights"})

    def instances(self, place: int) -> list[Float]:
        """(4, 4) each, from a mesh at the node to the scene: one, or as many as the node says."""
        own = instancing_of(self._nodes[place])
        if not own:
            return [self.worlds[place]]
        names = ("TRANSLATION", "ROTATION", "SCALE")
        columns = [self._arrays.floats(own[name]) if name in own else None for name in names]
        count = min(len(column) for column in columns if column is not None)
        rows = ([None if column is None else column[at] for column in columns] for at in range(count))
        return [self.worlds[place] @ matrix_of(*row) for row in rows]


def of_normals(turns: Float) -> Float:
    """(..., 3, 3) that turn normals where matrices (..., 3, 3) move places, also where these flatten: cofactors."""
    x, y, z = np.moveaxis(turns, -1, 0)
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)
    is_mirrored = (x * cofactors[..., 0]).sum(axis=-1) < 0
    return np.where(is_mirrored[..., None, None], -cofactors, cofactors)


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


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A primitive's vertices before anything moves them, and what may."""

    vertices: Float  # (n, 3)
    normals: Float | None  # (n, 3)
    targets: tuple[tuple[Float | None, Float | None], ...]  # (n, 3) what each morph target adds to vertices, normals
    influences: tuple[tuple[NDArray[np.int64], Float], ...]  # of joints: which (n, 4), and how much of each (n, 4)

    def posed(self, weights: Float, joints: Float | None) -> tuple[Float, Float | None]:
        """Vertices and normals with so much of each target (t,), then moved by joints (m, 4, 4)."""
        vertices, normals = self.vertices, self.normals
        for weight, (moved, turned) in zip(weights, self.targets, strict=False):
            if weight and moved is not None:
                vertices = vertices + weight * moved
            if weight and normals is not None and turned is not None:
                normals = normals + weight * turned
        if joints is not None and self.influences:
            if not np.isfinite(vertices).all():
                raise MalformedError("vertices hold a value that is not finite")
            vertices, normals = skinned(vertices, normals, joints, self.influences)
        return vertices, normals


def skinned(
    vertices: Float, normals: Float | None, joints: Float, influences: Sequence[tuple[NDArray[np.int64], Float]]
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
            turned[some] = np.einsum("nij,nj->ni", of_normals(blended[:, :, :3]), normals[some])
    return moved, turned


def are_mirroring(joints: Float) -> bool:
    """Whether most of the joints (m, 4, 4) mirror what follows them, so that its triangles' fronts lie behind."""
    return bool((np.linalg.det(joints[:, :3, :3]) < 0).mean() > 0.5)
