"""What is done with elements once they are decoded: the extension's appendix B."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def directions(packed: NDArray[Any]) -> NDArray[Any]:
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
        unpacked[:, column] = np.round(values / length * largest)
    return unpacked


def quaternions(packed: NDArray[Any]) -> NDArray[Any]:
    """(n, 4) unit quaternions of which the three smaller components are stored, and which one is the largest."""
    one = (packed[:, 3] | 3).astype(np.float64)
    x, y, z = (packed[:, column] / one * np.sqrt(0.5) for column in range(3))
    w = np.sqrt(np.maximum(0, 1 - x * x - y * y - z * z))
    rows, largest = np.arange(len(packed)), (packed[:, 3] & 3).astype(np.int64)
    unpacked = np.empty_like(packed)
    for step, values in enumerate((w, x, y, z)):
        unpacked[rows, (largest + step) % 4] = np.round(np.clip(values, -1, 1) * 32767)
    return unpacked


def floats(packed: NDArray[np.int32]) -> NDArray[np.float32]:
    """(n, k) of integers whose highest byte is the exponent of two by which the others are multiplied."""
    return np.asarray(np.ldexp((packed << 8 >> 8).astype(np.float32), packed >> 24))


def colours(packed: NDArray[Any]) -> NDArray[Any]:
    """(n, 4) red, green, blue and alpha of luma, two chrominances (signed) and alpha (unsigned all).

    They are of fewer bits than they lie in. How many is told by the highest bit that alpha has set, which is none of
    alpha's own.
    """
    signed = packed.view(f"<i{packed.itemsize}").astype(np.float64)
    luma, orange, green, alpha = packed[:, 0].astype(np.float64), signed[:, 1], signed[:, 2], packed[:, 3].astype(int)
    _, bits = np.frexp(alpha)
    largest = (1 << bits) - 1
    alpha &= largest >> 1
    alpha = alpha << 1 | alpha & 1
    rgba = np.stack([luma + orange - green, luma + green, luma - orange - green, alpha], axis=1)
    whole = np.iinfo(packed.dtype).max
    shares = np.clip(rgba / np.maximum(largest, 1)[:, None], 0, 1)
    return np.asarray(np.round(shares * whole), dtype=packed.dtype)
