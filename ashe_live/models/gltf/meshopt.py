"""Views compressed by meshoptimizer: EXT_meshopt_compression, bitstream and filters as in its appendices A and B.

https://github.com/KhronosGroup/glTF/blob/main/extensions/2.0/Vendor/EXT_meshopt_compression/README.md

No wheel that is kept well decodes it: meshoptimizer's own has none for any system, another wants a processor with AVX2.
"""

from collections import deque
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError

Bytes = NDArray[np.uint8]
GROUP = 16  # elements that share the width of their deltas
MOST_BLOCK_BYTES, MOST_BLOCK_ELEMENTS = 8192, 256
LEAST_TAIL_BYTES = 32
FIFO = 16


def decompressed(content: bytes, compression: Json) -> bytes:
    """`content` as the extension's JSON describes it. Raises MalformedError, or IndexError where it ends too early."""
    stride, count, mode = compression["byteStride"], compression["count"], compression["mode"]
    if mode != "ATTRIBUTES":
        if stride not in (2, 4):
            raise MalformedError(f"indices of {stride} bytes")
        decode = _triangles if mode == "TRIANGLES" else _indices
        return np.fromiter(decode(content, count), np.uint32, count).astype(f"<u{stride}").tobytes()
    if stride % 4 or stride > 256:
        raise MalformedError(f"elements of {stride} bytes")
    elements = _attributes(content, count, stride)
    match compression.get("filter", "NONE"), stride:
        case "OCTAHEDRAL", 4 | 8:
            elements = _octahedral(elements.view(f"<i{stride // 4}"))
        case "QUATERNION", 8:
            elements = _quaternions(elements.view("<i2"))
        case "EXPONENTIAL", _:
            packed = elements.view("<i4")
            elements = np.ldexp((packed << 8 >> 8).astype(np.float32), packed >> 24)
        case ("OCTAHEDRAL" | "QUATERNION") as filtered, _:
            raise MalformedError(f"{filtered} elements of {stride} bytes")
    return elements.tobytes()


def _attributes(content: bytes, count: int, stride: int) -> Bytes:
    """(count, stride) from blocks of deltas, byte by byte of an element."""
    if content[0] != 0xA0:
        raise MalformedError(f"its header is 0x{content[0]:02x} and not 0xa0")
    data = np.frombuffer(content, np.uint8)
    if len(data) < 1 + max(stride, LEAST_TAIL_BYTES):
        raise MalformedError("it ends before its tail")
    last = data[len(data) - stride :].copy()
    elements = np.empty((count, stride), np.uint8)
    at, most = 1, min(MOST_BLOCK_BYTES // stride & ~(GROUP - 1), MOST_BLOCK_ELEMENTS)
    for first in range(0, count, most):
        block = elements[first : first + most]
        groups = -(-len(block) // GROUP)
        deltas = np.empty((stride, groups, GROUP), np.uint8)
        for byte in range(stride):
            widths = data[at : at + -(-groups // 4), None] >> np.array((0, 2, 4, 6), np.uint8) & 3
            at += -(-groups // 4)
            for group, width in enumerate(widths.ravel()[:groups].tolist()):
                at = _read_group(data, at, width, deltas[byte, group])
        plain = deltas.reshape(stride, -1)[:, : len(block)]
        signed = (plain >> 1) ^ -(plain & 1)
        block[:] = (np.cumsum(signed, axis=1, dtype=np.uint8) + last[:, None]).T
        last = block[-1]
    return elements


def _read_group(data: Bytes, at: int, width: int, deltas: Bytes) -> int:
    """Fills `deltas` (GROUP,) from `at` on, 0, 2, 4 or 8 bits each by `width`; returns where the next group begins."""
    if width == 0:
        deltas[:] = 0
        return at
    if width == 3:
        deltas[:] = data[at : at + GROUP]
        return at + GROUP
    bits = 2 * width
    packed = data[at : at + GROUP * bits // 8, None]
    shifts = np.arange(8 - bits, -1, -bits, dtype=np.uint8)
    sentinel = (1 << bits) - 1
    deltas[:] = (packed >> shifts & sentinel).ravel()
    # A sentinel stands for a delta that is too large for the width, and follows the group as a whole byte.
    is_whole = deltas == sentinel
    begin = at + len(packed)
    end = begin + int(np.count_nonzero(is_whole))
    deltas[is_whole] = data[begin:end]
    return end


class _Stream:
    """The bytes beside the codes: LEB128 integers, and zigzag deltas to the last index."""

    def __init__(self, content: bytes, at: int) -> None:
        self._content, self._at = content, at
        self.last = 0

    def byte(self) -> int:
        self._at += 1
        return self._content[self._at - 1]

    def integer(self) -> int:
        value = shift = 0
        while shift < 35:
            byte = self.byte()
            value |= (byte & 127) << shift
            if byte < 128:
                return value & 0xFFFFFFFF
            shift += 7
        raise MalformedError("an index is of more than 32 bits")

    def index(self) -> int:
        value = self.integer()
        self.last = self.last + (value >> 1 ^ -(value & 1)) & 0xFFFFFFFF
        return self.last


def _indices(content: bytes, count: int) -> Iterator[int]:
    """Any indices, each as its difference from one of two that came before it."""
    if content[0] != 0xD1:
        raise MalformedError(f"its header is 0x{content[0]:02x} and not 0xd1")
    stream, last = _Stream(content, 1), [0, 0]
    for _ in range(count):
        value = stream.integer()
        baseline, delta = value & 1, value >> 2 ^ -(value >> 1 & 1)
        last[baseline] = last[baseline] + delta & 0xFFFFFFFF
        yield last[baseline]


def _triangles(content: bytes, count: int) -> Iterator[int]:
    """Indices of a list of triangles, each by an edge or by vertices that were met shortly before."""
    if content[0] != 0xE1:
        raise MalformedError(f"its header is 0x{content[0]:02x} and not 0xe1")
    if count % 3:
        raise MalformedError(f"{count} indices are no triangles")
    met = _MetEdges(content[-16:], _Stream(content, 1 + count // 3))
    for code in content[1 : 1 + count // 3]:
        high, low = code >> 4, code & 15
        yield from met.at_edge(high, low) if high < 15 else met.apart(low)


class _MetEdges:
    """The edges and vertices that were met last, the newest first, by which a triangle's code names its own."""

    def __init__(self, table: bytes, stream: _Stream) -> None:
        """`table`: the two places that follow from the low half of a code."""
        self._table, self._stream = table, stream
        self._edges, self._vertices = deque([(0, 0)] * FIFO, FIFO), deque([0] * FIFO, FIFO)
        self._next_vertex = 0

    def at_edge(self, number: int, low: int) -> tuple[int, int, int]:
        """A triangle that has an edge of an earlier one."""
        a, b = self._edges[number]
        if low == 0:
            c = self._new_vertex()
        elif low < 13:
            c = self._vertices[low]
        elif low < 15:
            c = self._stream.last = self._stream.last + (1 if low == 14 else -1) & 0xFFFFFFFF
        else:
            c = self._stream.index()
        if not 0 < low < 13:
            self._vertices.appendleft(c)
        self._edges.extendleft([(c, b), (a, c)])
        return a, b, c

    def apart(self, low: int) -> tuple[int, int, int]:
        """A triangle that shares vertices with earlier ones at most."""
        pair = self._table[low] if low < 14 else self._stream.byte()
        if low >= 14 and pair == 0:
            self._next_vertex = 0
        places = 15 if low == 15 else 0, pair >> 4, pair & 15
        a, b, c = (self._corner(place, may_be_written=low >= 14) for place in places)
        self._vertices.extendleft(corner for corner, place in zip((a, b, c), places, strict=True) if place in (0, 15))
        self._edges.extendleft([(b, a), (c, b), (a, c)])
        return a, b, c

    def _corner(self, place: int, may_be_written: bool) -> int:
        if place == 0:
            return self._new_vertex()
        return self._stream.index() if place == 15 and may_be_written else self._vertices[place - 1]

    def _new_vertex(self) -> int:
        self._next_vertex += 1
        return self._next_vertex - 1


def _octahedral(packed: NDArray[Any]) -> NDArray[Any]:
    """(n, 4) unit vectors of which x and y of the octahedron are stored, over the third component; the fourth stays."""
    largest = np.iinfo(packed.dtype).max
    x, y, one = (packed[:, column].astype(np.float64) for column in range(3))
    one = np.where(one == 0, 1, one)
    x, y = x / one, y / one
    z = 1 - np.abs(x) - np.abs(y)
    folded = np.minimum(z, 0)
    x, y = x - np.copysign(folded, x), y - np.copysign(folded, y)
    length = np.sqrt(x * x + y * y + z * z)
    unpacked = packed.copy()
    for column, values in enumerate((x, y, z)):
        unpacked[:, column] = np.round(np.clip(values / np.where(length == 0, 1, length), -1, 1) * largest)
    return unpacked


def _quaternions(packed: NDArray[Any]) -> NDArray[Any]:
    """(n, 4) unit quaternions of which the three smaller components are stored, and which one is the largest."""
    one = (packed[:, 3] | 3).astype(np.float64)
    x, y, z = (packed[:, column] / np.where(one == 0, 1, one) * np.sqrt(0.5) for column in range(3))
    w = np.sqrt(np.maximum(0, 1 - x * x - y * y - z * z))
    rows, largest = np.arange(len(packed)), (packed[:, 3] & 3).astype(np.int64)
    unpacked = np.empty_like(packed)
    for step, values in enumerate((w, x, y, z)):
        unpacked[rows, (largest + step) % 4] = np.round(np.clip(values, -1, 1) * 32767)
    return unpacked
