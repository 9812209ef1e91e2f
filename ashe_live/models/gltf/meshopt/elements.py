"""Elements of bytes, as groups of deltas of few bits: the extension's appendix A, mode 0."""

import numpy as np
from numpy.typing import NDArray

from ashe_live.models.parsing.malformed import MalformedError

Bytes = NDArray[np.uint8]
FIRST_VERSION, SECOND_VERSION = 0xA0, 0xA1
GROUP = 16  # elements that share the width of their deltas
MOST_BLOCK_BYTES, MOST_BLOCK_ELEMENTS = 8192, 256
LEAST_TAIL_BYTES = {FIRST_VERSION: 32, SECOND_VERSION: 24}
# Of a group's deltas, in bits; in the second version by the control mode of the byte.
WIDTHS = {FIRST_VERSION: ((0, 2, 4, 8),), SECOND_VERSION: ((0, 1, 2, 4), (1, 2, 4, 8))}
NOTHING, WHOLE = 2, 3  # control modes in which groups have no width: all deltas are 0, or whole bytes
BYTES, SHORTS, WORDS = range(3)  # modes of channels: what of an element's four bytes a delta is of


def elements_of(content: bytes, count: int, stride: int) -> Bytes:
    """(count, stride) from blocks of deltas, byte by byte of an element."""
    version = content[0]
    if version not in WIDTHS:
        raise MalformedError(f"its header is 0x{version:02x}, and neither 0xa0 nor 0xa1")
    data, channels = np.frombuffer(content, np.uint8), stride // 4
    tail = stride if version == FIRST_VERSION else stride + channels
    end = len(data) - max(tail, LEAST_TAIL_BYTES[version])
    if end < 1:
        raise MalformedError("it ends before its tail")
    last = data[len(data) - tail :][:stride]
    modes = np.zeros(channels, np.uint8) if version == FIRST_VERSION else data[len(data) - channels :]
    elements = np.empty((count, stride), np.uint8)
    at, most = 1, min(MOST_BLOCK_BYTES // stride & ~(GROUP - 1), MOST_BLOCK_ELEMENTS)
    for first in range(0, count, most):
        block = elements[first : first + most]
        deltas = np.empty((stride, len(block)), np.uint8)
        controls = [0] * stride
        if version == SECOND_VERSION:
            controls = _pairs(data[at : at + channels])
            at += channels
        for control, row in zip(controls, deltas, strict=True):
            at = _read_row(data, at, row, control, WIDTHS[version])
        if at > end:
            raise MalformedError("it ends before its elements do")
        for channel, mode in enumerate(modes.tolist()):
            own = slice(4 * channel, 4 * channel + 4)
            block[:, own] = _summed(deltas[own].T, last[own], mode)
        last = block[-1]
    return elements


def _read_row(data: Bytes, at: int, row: Bytes, control: int, widths: tuple[tuple[int, ...], ...]) -> int:
    """Fills `row` (n,), the deltas of one byte of a block's elements; returns where the next one's begin."""
    if control == NOTHING:
        row[:] = 0
        return at
    if control == WHOLE:
        row[:] = data[at : at + len(row)]
        return at + len(row)
    groups = -(-len(row) // GROUP)
    deltas = np.empty((groups, GROUP), np.uint8)
    numbers = _pairs(data[at : at + -(-groups // 4)])
    at += -(-groups // 4)
    for number, group in zip(numbers[:groups], deltas, strict=True):
        at = _read_group(data, at, widths[control][number], group)
    row[:] = deltas.ravel()[: len(row)]
    return at


def _pairs(packed: Bytes) -> list[int]:
    """The pairs of bits of bytes (n,), of each the lowest first."""
    pairs: list[int] = (packed[:, None] >> np.array((0, 2, 4, 6), np.uint8) & 3).ravel().tolist()
    return pairs


def _read_group(data: Bytes, at: int, bits: int, deltas: Bytes) -> int:
    """Fills `deltas` (GROUP,) from `at` on, of so many bits each; returns where the next group begins."""
    if bits == 0:
        deltas[:] = 0
        return at
    if bits == 8:
        deltas[:] = data[at : at + GROUP]
        return at + GROUP
    packed = data[at : at + GROUP * bits // 8, None]
    shifts = np.arange(0, 8, bits, dtype=np.uint8)
    sentinel = (1 << bits) - 1
    # The first delta has a byte's highest bits, but for single ones, where it has the lowest.
    deltas[:] = (packed >> (shifts if bits == 1 else shifts[::-1]) & sentinel).ravel()
    # A sentinel stands for a delta that is too large for the width, and follows the group as a whole byte.
    is_whole = deltas == sentinel
    begin = at + len(packed)
    end = begin + int(np.count_nonzero(is_whole))
    deltas[is_whole] = data[begin:end]
    return end


def _summed(deltas: Bytes, last: Bytes, mode: int) -> Bytes:
    """(n, 4) of what `deltas` (n, 4) add to one another and to `last` (4,)."""
    kind, turn = mode & 15, mode >> 4
    if kind > WORDS or (turn and kind != WORDS):
        raise MalformedError(f"a channel is of mode 0x{mode:02x}")
    steps, begin = (np.ascontiguousarray(each).view(f"<u{1 << kind}") for each in (deltas, last))
    if kind == WORDS:
        turned = steps if turn == 0 else steps >> turn | steps << 32 - turn
        return np.asarray(np.bitwise_xor.accumulate(turned, axis=0) ^ begin).view(np.uint8)
    signed = (steps >> 1) ^ -(steps & 1)
    return np.asarray(np.cumsum(signed, axis=0, dtype=steps.dtype) + begin).view(np.uint8)
