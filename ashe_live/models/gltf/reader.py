"""A glTF file's meshes, as its scene shows them when its first animation begins.

A reader of our own over the schema: those that there are take arrays for granted that a file only claims, and leave out
without a word what they do not know.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.models.geometry import RawMesh
from ashe_live.models.gltf.amounts import FAN, STRIP, TRIANGLES, amounts_of, check_layout
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.gltf.container import Buffers, split
from ashe_live.models.gltf.draco import DracoPrimitive
from ashe_live.models.gltf.materials import Materials
from ashe_live.models.gltf.missing import note_what_is_missing
from ashe_live.models.gltf.pose import Pose, skinned
from ashe_live.models.gltf.schema import UV_SETS, checked
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.limits import check_gltf
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import Notes
from ashe_live.process.messages import printable

DRACO = "KHR_draco_mesh_compression"
NAME_CHARACTERS = 60
DRAWN = {
    DRACO,
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "EXT_texture_webp",
    "EXT_mesh_gpu_instancing",
    "KHR_node_visibility",
}
# What is drawn in their place looks much like it; a note says what is missing.
TOLERATED = ("KHR_materials_", "KHR_texture_basisu", "KHR_lights_punctual", "KHR_xmp", "KHR_animation_pointer")


def read_gltf(path: Path, content: bytes, folder: Folder, notes: Notes) -> Iterator[tuple[Float, RawMesh]]:
    """Each mesh with the (4, 4) that places it in the scene, from the bytes of the .gltf or .glb at `path`.

    Raises UserError for another version, an unknown extension and for more than the limits, MalformedError for what is
    not as the format asks.
    """
    document, binary = split(path, content)
    _check_extensions(path, document)
    header = {"accessors": [], **checked(document)}
    for mesh in header.get("meshes", []):
        # Without places there is nothing to draw.
        mesh["primitives"] = [primitive for primitive in mesh["primitives"] if "POSITION" in primitive["attributes"]]
    check_gltf(path, amounts_of(header))
    check_layout(header)
    note_what_is_missing(document, header, notes)
    arrays = Arrays(header, Buffers(header, binary, folder))
    is_animated = bool(header.get("animations"))
    reader = _Reader(header, arrays, Materials(header, arrays, folder, notes), notes)
    drawn = list(reader.meshes(Pose(header, arrays, is_animated)))
    if is_animated and not any(_has_extent(T, mesh) for T, mesh in drawn):
        # Things that are to grow begin as nothing.
        drawn = list(reader.meshes(Pose(header, arrays, is_animated=False)))
    yield from drawn


def _check_extensions(path: Path, document: dict[str, Any]) -> None:
    required = document.get("extensionsRequired", [])
    for name in required if isinstance(required, list) else []:
        if not (isinstance(name, str) and (name in DRAWN or name.startswith(TOLERATED))):
            said = printable(name, NAME_CHARACTERS)
            raise UserError(f"the model file {path} needs {said}, which is not supported", "export it without that")


def _has_extent(T: Float, mesh: RawMesh) -> bool:
    spread = np.ptp(mesh.vertices[mesh.triangles].reshape(-1, 3) @ T[:3, :3].T, axis=0) if len(mesh.triangles) else 0
    return bool(np.any(spread > 0))


class _Reader:
    def __init__(self, header: dict[str, Any], arrays: Arrays, materials: Materials, notes: Notes) -> None:
        self._header = header
        self._arrays = arrays
        self._materials = materials
        self._notes = notes
        self._decoded: dict[int, DracoPrimitive] = {}

    def meshes(self, pose: Pose) -> Iterator[tuple[Float, RawMesh]]:
        # In the order of nodes, whatever the way in which the scene was walked through.
        for place in sorted(pose.worlds):
            node = self._header["nodes"][place]
            if "mesh" not in node:
                continue
            given = self._header["meshes"][node["mesh"]]
            weights, joints = pose.weights(place, given), pose.joints(place)
            for primitive in given["primitives"]:
                if primitive.get("mode", TRIANGLES) not in (TRIANGLES, STRIP, FAN):
                    self._notes.add("points and lines are left out")
                    continue
                mesh = self._mesh(primitive, weights, joints)
                # A skin's joints say where it is, and the node that bears it does not.
                for T in [np.eye(4)] if joints is not None else pose.instances(place):
                    yield T, mesh

    def _mesh(self, primitive: dict[str, Any], weights: Float, joints: Float | None) -> RawMesh:
        attributes = _Attributes(primitive, self._arrays, self._unpacked(primitive))
        vertices, normals = attributes.floats("POSITION"), attributes.optional("NORMAL")
        for weight, target in zip(weights, primitive.get("targets", []), strict=False):
            if weight and "POSITION" in target:
                vertices = vertices + weight * self._arrays.floats(target["POSITION"])
            if weight and normals is not None and "NORMAL" in target:
                normals = normals + weight * self._arrays.floats(target["NORMAL"])
        if joints is not None and (influences := attributes.influences()):
            if not np.isfinite(vertices).all():
                raise MalformedError("vertices hold a value that is not finite")
            vertices, normals = skinned(vertices, normals, joints, influences)
        there = frozenset(number for number in range(UV_SETS) if f"TEXCOORD_{number}" in attributes)
        # Draco's faces are triangles, whatever they were compressed from.
        mode = TRIANGLES if DRACO in primitive.get("extensions", {}) else primitive.get("mode", TRIANGLES)
        material, sets = self._materials.material(primitive.get("material"), there)
        uvs = [_from_bottom_left(attributes.floats(f"TEXCOORD_{number}")) for number in sets]
        return RawMesh(
            vertices=vertices,
            triangles=_triangles(attributes.corners(len(vertices)), mode),
            material=material,
            normals=normals,
            uvs=uvs[0] if uvs else None,
            more_uvs=uvs[1] if len(uvs) > 1 else None,
            colours=attributes.colours(),
        )

    def _unpacked(self, primitive: dict[str, Any]) -> DracoPrimitive | None:
        packed = primitive.get("extensions", {}).get(DRACO)
        if packed is None:
            return None
        view = packed["bufferView"]
        if view not in self._decoded:
            self._decoded[view] = DracoPrimitive(bytes(self._arrays.view(view)), packed["attributes"])
        return self._decoded[view]


class _Attributes:
    """What a primitive says of its vertices, compressed by Draco or not."""

    def __init__(self, primitive: dict[str, Any], arrays: Arrays, unpacked: DracoPrimitive | None) -> None:
        self._primitive = primitive
        self._places: dict[str, int] = primitive["attributes"]
        self._arrays = arrays
        self._unpacked = unpacked

    def __contains__(self, name: str) -> bool:
        return name in self._places

    def floats(self, name: str, are_shares: bool = False) -> Float:
        if self._unpacked is None or name not in self._unpacked:
            return self._arrays.floats(self._places[name], are_shares)
        is_share = are_shares or self._arrays.is_normalised(self._places[name])
        return self._checked(name, self._unpacked.floats(name, is_share))

    def optional(self, name: str) -> Float | None:
        return self.floats(name) if name in self else None

    def corners(self, count: int) -> NDArray[np.int64]:
        """(n,) indices of vertices, before they are made triangles."""
        if self._unpacked is not None:
            return self._unpacked.corners
        if "indices" not in self._primitive:
            return np.arange(count)
        return self._arrays.numbers(self._primitive["indices"]).ravel().astype(np.int64)

    def colours(self) -> Float | None:
        """(n, 4) linear; opaque where the file says nothing of alpha."""
        if "COLOR_0" not in self:
            return None
        given = self.floats("COLOR_0", are_shares=True)
        return np.hstack([given, np.ones((len(given), 4 - given.shape[1]))])

    def influences(self) -> list[tuple[NDArray[np.int64], Float]]:
        """Of joints: which (n, 4), and how much of each (n, 4)."""
        found = []
        for number in range(2):
            joints, weights = f"JOINTS_{number}", f"WEIGHTS_{number}"
            if joints in self and weights in self:
                which = self.floats(joints).astype(np.int64)
                found.append((which, self.floats(weights, are_shares=True)))
        return found

    def _checked(self, name: str, values: Float) -> Float:
        shape = self._arrays.shape(self._places[name])
        if values.shape != shape:
            raise MalformedError(f"a primitive's Draco data holds {values.shape} of {name}, and its accessor {shape}")
        return values


def _triangles(corners: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """(m, 3) of a list, a strip or a fan: section 3.7.2.1 of the specification."""
    if mode == TRIANGLES:
        return corners.reshape(-1, 3)
    if len(corners) < 3:
        return np.empty((0, 3), np.int64)
    if mode == FAN:
        return np.column_stack([corners[1:-1], corners[2:], np.full(len(corners) - 2, corners[0])])
    strip = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    strip[1::2] = strip[1::2][:, [0, 2, 1]]
    return strip


def _from_bottom_left(uvs: Float) -> Float:
    return np.column_stack([uvs[:, 0], 1 - uvs[:, 1]])
