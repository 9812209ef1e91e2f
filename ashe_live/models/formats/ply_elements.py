"""The container of a PLY file: elements of numbers and lists, as text or as bytes.

Greg Turk, "The PLY polygon file format", 1994. A reader of our own: others that there are take all polygons of a file
for as long as the first, and refuse what Blender writes.
"""

import re
import struct
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.formats.words import with_plain_nan
from ashe_live.models.parsing.malformed import MalformedError

DTYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
HEADER_END = re.compile(rb"(?<=[\r\n])end_header")  # and not what a comment says of it


@dataclass(frozen=True, slots=True)
class Lists:
    """A list for each item of an element."""

    counts: NDArray[np.int64]  # (n,)
    values: Float  # (sum of counts,) list after list


@dataclass(slots=True)
class Element:
    """One kind of items: its description in the header, and the values read."""

    name: str
    count: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)  # name, kind, kind of a list's length
    numbers: dict[str, Float] = field(default_factory=dict)  # (count,) of each property that is no list
    kinds: dict[str, str] = field(default_factory=dict)
    lists: dict[str, Lists] = field(default_factory=dict)


def elements_of(content: bytes) -> dict[str, Element]:
    """The elements of a whole file, by name. Raises MalformedError."""
    order, elements, begin = _header(content)
    if order == "":
        _fill_from_text(elements, content[begin:])
    else:
        for element in elements:
            begin = _fill_from_bytes(element, content, begin, order)
    return {element.name: element for element in elements}


def _header(content: bytes) -> tuple[str, list[Element], int]:
    """The byte order, the elements without their items, and where these begin."""
    found = HEADER_END.search(content)
    if not content.startswith(b"ply") or found is None:
        raise MalformedError("it has no PLY header")
    end = found.start()
    # The format was written for carriage returns alone; bytes that follow them may hold a line feed.
    newline = content.find(b"\n" if b"\n" in content[:end] else b"\r", end)
    begin = newline + 1 if newline >= 0 else len(content)
    order: str | None = None
    elements: list[Element] = []
    for line in content[:end].decode("ascii", "replace").splitlines():
        match line.split():
            case ["format", kind, *_]:
                order = ORDERS.get(kind)
            case ["element", name, count] if count.isdecimal():
                elements.append(Element(name, int(count)))
            case ["property", "list", length, kind, name] if elements and {length, kind} <= DTYPES.keys():
                if DTYPES[length][0] == "f":
                    raise MalformedError(f"the lists {name} have lengths that are no whole numbers")
                elements[-1].properties.append((name, kind, length))
            case ["property", kind, name] if elements and kind in DTYPES:
                elements[-1].properties.append((name, kind, None))
            case [("property" | "element") as word, *_]:
                raise MalformedError(f"its header has a line of {word} that cannot be read")
    if order is None:
        raise MalformedError("its header names no format that is known")
    for element in elements:
        element.kinds = {name: DTYPES[kind] for name, kind, _ in element.properties}
        if len(element.kinds) < len(element.properties):
            raise MalformedError(f"two properties of {element.name} have one name")
    return order, elements, begin


def _fill_from_text(elements: list[Element], text: bytes) -> None:
    words = with_plain_nan(text).split()
    at = 0
    for element in elements:
        if not element.properties:
            continue
        if element.count * len(element.properties) > len(words) - at:
            raise _ended(element)
        try:
            at = _fill_with_words(element, words, at)
        except MalformedError:
            raise
        except ValueError:
            raise MalformedError(f"{element.name} has a value that is no number") from None


def _fill_with_words(element: Element, words: list[bytes], at: int) -> int:
    width = len(element.properties)
    if all(length is None for *_, length in element.properties):
        table = np.array(words[at : at + element.count * width], np.float64).reshape(element.count, width)
        element.numbers = {name: table[:, column] for column, (name, *_) in enumerate(element.properties)}
        return at + element.count * width
    columns: dict[str, list[bytes]] = {name: [] for name, *_ in element.properties}
    counts: dict[str, list[int]] = {name: [] for name, *_ in element.properties}
    for _ in range(element.count):
        for name, _kind, length in element.properties:
            if at >= len(words):
                raise _ended(element)
            if length is None:
                columns[name].append(words[at])
            else:
                count = int(words[at])
                if not 0 <= count < len(words) - at:
                    raise MalformedError(f"a list {name} is said to have {count} values")
                counts[name].append(count)
                columns[name] += words[at + 1 : at + 1 + count]
                at += count
            at += 1
    for name, _kind, length in element.properties:
        values = np.array(columns[name], np.float64)
        if length is None:
            element.numbers[name] = values
        else:
            element.lists[name] = Lists(np.array(counts[name], np.int64), values)
    return at


def _ended(element: Element) -> MalformedError:
    return MalformedError(f"its header says element {element.name} {element.count}, and it ends before")


def _fill_from_bytes(element: Element, content: bytes, begin: int, order: str) -> int:
    """Returns where the next element begins."""
    if not element.properties:
        return begin
    if (after := _fill_alike(element, content, begin, order)) is not None:
        return after
    places, counts, end = _walk(element, content, begin, order)
    all_bytes = np.frombuffer(content, np.uint8)
    for name, _kind, length in element.properties:
        dtype = np.dtype(order + element.kinds[name])
        if length is None:
            values = _gathered(all_bytes, places[name], np.ones(element.count, np.int64), dtype)
            element.numbers[name] = values
        else:
            values = _gathered(all_bytes, places[name], counts[name], dtype)
            element.lists[name] = Lists(counts[name], values)
    return end


def _fill_alike(element: Element, content: bytes, begin: int, order: str) -> int | None:
    """Where every item's lists are as long as the first one's: all at once. None where they are not."""
    if not element.count:
        return None
    _, counts, _ = _walk(replace(element, count=1), content, begin, order)
    fields: list[tuple[str, str] | tuple[str, str, int]] = []
    for number, (name, kind, length) in enumerate(element.properties):
        if length is not None:
            fields.append((f"length {number}", order + DTYPES[length].replace("i", "u")))
        fields.append((f"{number}", order + DTYPES[kind], 1 if length is None else int(counts[name][0])))
    row = np.dtype(fields)
    end = begin + element.count * row.itemsize
    if end > len(content):
        return None
    table = np.frombuffer(content, row, element.count, begin)
    listed = [(number, name) for number, (name, _, length) in enumerate(element.properties) if length is not None]
    if not all((table[f"length {number}"] == counts[name][0]).all() for number, name in listed):
        return None
    for number, (name, _, length) in enumerate(element.properties):
        values = table[f"{number}"].reshape(-1).astype(np.float64)
        if length is None:
            element.numbers[name] = values
        else:
            element.lists[name] = Lists(np.repeat(counts[name], element.count), values)
    return end


def _walk(
    element: Element, content: bytes, at: int, order: str
) -> tuple[dict[str, NDArray[np.int64]], dict[str, NDArray[np.int64]], int]:
    """Where the values of each property begin (count,), how many a list has (count,), and where the last ends."""
    steps: list[tuple[list[int], list[int], struct.Struct | None, int, str]] = []
    for name, kind, length in element.properties:
        read = None if length is None else struct.Struct(order + {"1": "B", "2": "H", "4": "I"}[DTYPES[length][1]])
        steps.append(([], [], read, np.dtype(DTYPES[kind]).itemsize, name))
    size = len(content)
    for _ in range(element.count):
        for places, counts, read, width, name in steps:
            count = 1
            if read is not None:
                if at + read.size > size:
                    raise _ended(element)
                (count,) = read.unpack_from(content, at)
                at += read.size
                counts.append(count)
            places.append(at)
            at += count * width
            if at > size and read is None:
                raise _ended(element)
            if at > size:
                raise MalformedError(f"a list {name} reaches beyond the end of the file")
    found = {name: np.array(places, np.int64) for places, _, _, _, name in steps}
    lengths = {name: np.array(counts, np.int64) for _, counts, _, _, name in steps}
    return found, lengths, at


def _gathered(
    content: NDArray[np.uint8], places: NDArray[np.int64], counts: NDArray[np.int64], dtype: np.dtype[Any]
) -> Float:
    """(sum of counts,) values that begin at `places` (n,), list after list."""
    values = np.empty(int(counts.sum()), np.float64)
    firsts = np.cumsum(counts) - counts
    for count in np.unique(counts):
        if count == 0:
            continue
        rows = np.flatnonzero(counts == count)
        picked = content[places[rows, None] + np.arange(count * dtype.itemsize)]
        values[firsts[rows, None] + np.arange(count)] = picked.reshape(-1).view(dtype).reshape(-1, count)
    return values
