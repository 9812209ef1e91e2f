"""Accessors as arrays: strided, normalised, sparse, from views that are compressed or not."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.gltf.amounts import compression_of, item_bytes
from ashe_live.models.gltf.container import Buffers
from ashe_live.models.gltf.layouts import COMPONENT_TYPES, COMPONENTS
from ashe_live.models.gltf.meshopt.views import decompressed
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError

Numbers = NDArray[Any]


class Arrays:
    """Accessors of a header that `check_layout` has passed. Raises MalformedError for buffers that are too short."""

    def __init__(self, header: Json, buffers: Buffers) -> None:
        self._accessors: list[Json] = header["accessors"]
        self._views: list[Json] = header["bufferViews"]
        self._buffers = buffers
        self._unpacked: dict[int, bytes] = {}

    def view(self, place: int) -> memoryview:
        """The content of a bufferView, decompressed."""
        view = self._views[place]
        compressed = compression_of(view)
        if compressed is None:
            return self._part(view)
        if place not in self._unpacked:
            try:
                self._unpacked[place] = decompressed(bytes(self._part(compressed)), compressed)
            except (IndexError, ValueError) as error:
                said = error if isinstance(error, MalformedError) else "it ends too early"
                raise MalformedError(f"bufferViews[{place}] cannot be decompressed ({said})") from None
        return memoryview(self._unpacked[place])

    def numbers(self, place: int) -> Numbers:
        """(count, components) of an accessor as it is stored."""
        accessor = self._accessors[place]
        dtype, (count, components) = COMPONENT_TYPES[accessor["componentType"]], self.shape(place)
        if "bufferView" in accessor and count > 0:
            stride = self._views[accessor["bufferView"]].get("byteStride", item_bytes(accessor))
            stored: Numbers = np.ndarray(
                (count, components),
                dtype,
                self.view(accessor["bufferView"]),
                accessor.get("byteOffset", 0),
                (stride, dtype.itemsize),
            )
        else:
            stored = np.zeros((count, components), dtype)
        sparse = accessor.get("sparse")
        return stored if sparse is None else self._with(stored, sparse)

    def floats(self, place: int, are_shares: bool = False) -> Float:
        """(count, components): integers as shares of their largest where the accessor, or the caller, says so."""
        return as_floats(self.numbers(place), are_shares or self.is_normalised(place))

    def is_normalised(self, place: int) -> bool:
        """Whether an accessor's integers are shares of their largest."""
        return bool(self._accessors[place].get("normalized", False))

    def shape(self, place: int) -> tuple[int, int]:
        """How many items an accessor has, and components each."""
        return self._accessors[place]["count"], COMPONENTS[self._accessors[place]["type"]]

    def _with(self, stored: Numbers, sparse: Json) -> Numbers:
        """A copy in which a sparse accessor replaces some rows."""
        indices, values = sparse["indices"], sparse["values"]
        which, what = (self.view(part["bufferView"])[part.get("byteOffset", 0) :] for part in (indices, values))
        rows = np.frombuffer(which, COMPONENT_TYPES[indices["componentType"]], sparse["count"])
        given = np.frombuffer(what, stored.dtype, sparse["count"] * stored.shape[1])
        if rows.max() >= len(stored):
            raise MalformedError(f"a sparse accessor replaces item {rows.max()} of {len(stored)}")
        filled = stored.copy()
        filled[rows] = given.reshape(-1, stored.shape[1])
        return filled

    def _part(self, view: Json) -> memoryview:
        return self._buffers.part(view["buffer"], view.get("byteOffset", 0), view["byteLength"])


def as_floats(stored: Numbers, are_shares: bool) -> Float:
    """Numbers of any type; integers as shares of their largest where they are that."""
    if stored.dtype.kind == "f" or not are_shares:
        return stored.astype(np.float64)
    return np.maximum(stored.astype(np.float64) / np.iinfo(stored.dtype).max, -1.0)
