"""Indices as codes and bytes: the extension's appendix A, modes 1 and 2."""

from collections import deque
from collections.abc import Iterator

from ashe_live.models.parsing.malformed import MalformedError

FIFO = 16


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


def indices(content: bytes, count: int) -> Iterator[int]:
    """Any indices, each as its difference from one of two that came before it."""
    if content[0] != 0xD1:
        raise MalformedError(f"its header is 0x{content[0]:02x} and not 0xd1")
    stream, last = _Stream(content, 1), [0, 0]
    for _ in range(count):
        value = stream.integer()
        baseline, delta = value & 1, value >> 2 ^ -(value >> 1 & 1)
        last[baseline] = last[baseline] + delta & 0xFFFFFFFF
        yield last[baseline]


def triangles(content: bytes, count: int) -> Iterator[int]:
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
        a, b, c = map(self._corner, places)
        self._vertices.extendleft(corner for corner, place in zip((a, b, c), places, strict=True) if place in (0, 15))
        self._edges.extendleft([(b, a), (c, b), (a, c)])
        return a, b, c

    def _corner(self, place: int) -> int:
        if place == 0:
            return self._new_vertex()
        return self._stream.index() if place == 15 else self._vertices[place - 1]

    def _new_vertex(self) -> int:
        self._next_vertex += 1
        return self._next_vertex - 1
