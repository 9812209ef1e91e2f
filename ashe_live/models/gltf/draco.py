"""Primitives compressed by Draco: KHR_draco_mesh_compression, decoded by DracoPy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.parsing.malformed import MalformedError


class DracoPrimitive:
    """What the compressed bytes of a primitive hold. Raises MalformedError for what is no Draco mesh."""

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

    def numbers(self, name: str) -> NDArray[Any]:
        """(vertices, components) as it was compressed."""
        return self._of_name[name]

    def floats(self, name: str, are_shares: bool) -> Float:
        """(vertices, components): integers as shares of their largest where the caller says so."""
        stored = self._of_name[name]
        if stored.dtype.kind == "f" or not are_shares:
            return stored.astype(np.float64)
        return np.maximum(stored.astype(np.float64) / np.iinfo(stored.dtype).max, -1.0)
