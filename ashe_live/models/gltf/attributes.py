"""What primitives say of their vertices, compressed by Draco or not: KHR_draco_mesh_compression, decoded by DracoPy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.gltf.arrays import Arrays, as_floats
from ashe_live.models.gltf.layouts import JOINT_SETS
from ashe_live.models.gltf.motion.pose import Shape
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError


class DracoPrimitive:
    """The decompressed content of a primitive. Raises MalformedError if it is no Draco mesh."""

    def __init__(self, content: bytes, attributes: dict[str, int]) -> None:
        """`attributes`: the unique ids of Draco's, by glTF's names."""
        import DracoPy  # few files need its three megabytes

        try:
            mesh = DracoPy.decode(content)
            self.corners: NDArray[np.int64] = np.asarray(mesh.faces, dtype=np.int64).ravel()
            decoded = {attribute["unique_id"]: np.asarray(attribute["data"]) for attribute in mesh.attributes}
        except MemoryError:
            raise
        except Exception as error:  # what a decoder makes of damaged bytes
            raise MalformedError("a primitive's Draco data cannot be decoded") from error
        missing = [name for name, number in attributes.items() if number not in decoded]
        if missing:
            raise MalformedError(f"a primitive's Draco data holds no {missing[0]}")
        self._of_name: dict[str, NDArray[Any]] = {name: decoded[number] for name, number in attributes.items()}

    def __contains__(self, name: str) -> bool:
        return name in self._of_name

    def floats(self, name: str, are_shares: bool) -> Float:
        """(vertices, components): integers as shares of their largest where the caller says so."""
        return as_floats(self._of_name[name], are_shares)


class Attributes:
    """The vertex attributes of a primitive, compressed by Draco or not."""

    def __init__(self, primitive: Json, arrays: Arrays, unpacked: DracoPrimitive | None) -> None:
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

    def corners(self, count: int) -> NDArray[np.int64]:
        """(n,) indices of vertices, before they are made triangles."""
        if self._unpacked is not None:
            return self._unpacked.corners
        if "indices" not in self._primitive:
            return np.arange(count)
        return self._arrays.numbers(self._primitive["indices"]).ravel().astype(np.int64)

    def colours(self) -> Float | None:
        """(n, 4) linear, from 0 to 1; opaque where the file says nothing of alpha."""
        if "COLOR_0" not in self:
            return None
        # "All components of each COLOR_0 accessor element MUST be clamped to [0.0, 1.0] range" (3.7.2.1).
        given = self.floats("COLOR_0", are_shares=True).clip(0, 1)
        return np.hstack([given, np.ones((len(given), 4 - given.shape[1]))])

    def shape(self, has_joints: bool) -> Shape:
        """Places and normals, and what moves them."""
        targets = self._primitive.get("targets", [])
        added = (
            [self._arrays.floats(target[name]) if name in target else None for target in targets]
            for name in ("POSITION", "NORMAL")
        )
        influences = tuple(self._influences()) if has_joints else ()
        places = self.floats("POSITION")
        normals = self.floats("NORMAL") if "NORMAL" in self else None
        return Shape(places, normals, tuple(zip(*added, strict=True)), influences)

    def _influences(self) -> list[tuple[NDArray[np.int64], Float]]:
        """The joints of each vertex (n, 4) and their weights (n, 4), set by set."""
        found = []
        for number in range(JOINT_SETS):
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
