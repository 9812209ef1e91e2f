"""A glTF file's meshes, as its scene shows them, and as its first animation moves them.

The reader is our own, as those that exist trust a file's claims about its arrays, and silently leave out what they do
not support.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.models.assembly.geometry import RawMesh
from ashe_live.models.gltf.amounts import FAN, STRIP, TRIANGLES, amounts_of, check_layout
from ashe_live.models.gltf.arrays import Arrays
from ashe_live.models.gltf.attributes import Attributes, DracoPrimitive
from ashe_live.models.gltf.container import Buffers, split
from ashe_live.models.gltf.layouts import UV_SETS
from ashe_live.models.gltf.materials import GltfMaterials
from ashe_live.models.gltf.missing import note_what_is_missing
from ashe_live.models.gltf.motion.animation import Animation
from ashe_live.models.gltf.motion.playing import Drawn, played
from ashe_live.models.gltf.motion.pose import Pose, Shape, are_mirroring
from ashe_live.models.gltf.schema import checked
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.limits import check_gltf
from ashe_live.models.parsing.notes import NAME_CHARACTERS, Notes
from ashe_live.process.messages import printable

DRACO = "KHR_draco_mesh_compression"
SUPPORTED = {
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


def read_gltf(path: Path, content: bytes, folder: Folder, notes: Notes) -> list[tuple[Float, RawMesh]]:
    """Each mesh with the (4, 4) that places it in the scene, from the bytes of the .gltf or .glb at `path`.

    Raises UserError for another version, an unknown extension and for more than the limits, MalformedError for what is
    not as the format asks.
    """
    document, binary = split(path, content)
    _check_extensions(path, document)
    header = checked(document)
    for mesh in header["meshes"]:
        # Without places there is nothing to draw.
        mesh["primitives"] = [primitive for primitive in mesh["primitives"] if "POSITION" in primitive["attributes"]]
    check_gltf(path, amounts_of(header))
    check_layout(header)
    note_what_is_missing(document, header, notes)
    arrays = Arrays(header, Buffers(header, binary, folder))
    reader = _Reader(header, arrays, GltfMaterials(header, arrays, folder, notes), notes)
    animation = Animation(header, arrays)
    drawn = list(reader.drawn(Pose(header, arrays, animation.at(0.0))))
    if animation.is_damaged:
        notes.add("what of its animation is damaged is left out")
    if not animation.moving:
        return [(each.T, each.mesh) for each in drawn]
    if animation.left_out:
        notes.add(f"{animation.left_out} of its {len(header['animations'])} animations are not played")
    moving = played(header, arrays, drawn, animation)
    if moving is not None:
        return moving
    notes.add("its animation is too long to be played: it stands as that begins")
    if not any(each.has_extent for each in drawn):
        # Things that are to grow begin as nothing.
        drawn = list(reader.drawn(Pose(header, arrays, {})))
    return [(each.T, each.mesh) for each in drawn]


def _check_extensions(path: Path, document: Json) -> None:
    required = document.get("extensionsRequired", [])
    for name in required if isinstance(required, list) else []:
        if not (isinstance(name, str) and (name in SUPPORTED or name.startswith(TOLERATED))):
            said = printable(name, NAME_CHARACTERS)
            raise UserError(f"the model file {path} needs {said}, which is not supported", "export it without that")


class _Reader:
    """Makes a RawMesh of each primitive of the scene's nodes."""

    def __init__(self, header: Json, arrays: Arrays, materials: GltfMaterials, notes: Notes) -> None:
        self._header = header
        self._arrays = arrays
        self._materials = materials
        self._notes = notes
        self._decoded: dict[tuple[int, tuple[tuple[str, int], ...]], DracoPrimitive] = {}  # by view and attributes

    def drawn(self, pose: Pose) -> Iterator[Drawn]:
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
                shape, mesh = self._mesh(primitive, weights, joints)
                # A skin's joints say where it is, and the node that bears it does not.
                for number, T in enumerate([np.eye(4)] if joints is not None else pose.instances(place)):
                    yield Drawn(place, number, shape, T, mesh)

    def _mesh(self, primitive: Json, weights: Float, joints: Float | None) -> tuple[Shape, RawMesh]:
        attributes = Attributes(primitive, self._arrays, self._unpacked(primitive))
        shape = attributes.shape(joints is not None)
        vertices, normals = shape.posed(weights, joints)
        there = frozenset(number for number in range(UV_SETS) if f"TEXCOORD_{number}" in attributes)
        # Draco's faces are triangles, whatever they were compressed from.
        mode = TRIANGLES if DRACO in primitive.get("extensions", {}) else primitive.get("mode", TRIANGLES)
        material, sets = self._materials.material(primitive.get("material"), there)
        uvs = [_from_bottom_left(attributes.floats(f"TEXCOORD_{number}")) for number in sets]
        triangles = _triangles(attributes.corners(len(vertices)), mode)
        return shape, RawMesh(
            vertices=vertices,
            triangles=triangles if joints is None or not are_mirroring(joints) else triangles[:, ::-1],
            material=material,
            normals=normals,
            uvs=uvs[0] if uvs else None,
            more_uvs=uvs[1] if len(uvs) > 1 else None,
            colours=attributes.colours(),
            # "When normals are not specified, client implementations MUST calculate flat normals" (3.7.2.1).
            is_flat="NORMAL" not in attributes,
        )

    def _unpacked(self, primitive: Json) -> DracoPrimitive | None:
        packed = primitive.get("extensions", {}).get(DRACO)
        if packed is None:
            return None
        view, attributes = packed["bufferView"], packed["attributes"]
        key = view, tuple(sorted(attributes.items()))
        if key not in self._decoded:
            self._decoded[key] = DracoPrimitive(bytes(self._arrays.view(view)), attributes)
        return self._decoded[key]


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
