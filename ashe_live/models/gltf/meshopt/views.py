"""A compressed view as its extension's JSON describes it: mode, stride and filter say how it is read, and what is done
with elements once they are decoded (its appendix B).

https://github.com/KhronosGroup/glTF/blob/main/extensions/2.0/Khronos/KHR_meshopt_compression/README.md

No wheel that is kept well decodes it: meshoptimizer's own has none for any system, another wants a processor with AVX2.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.models.gltf.meshopt.elements import elements_of
from ashe_live.models.gltf.meshopt.indices import indices, triangles
from ashe_live.models.parsing.json_kinds import Json
from ashe_live.models.parsing.malformed import MalformedError


def decompressed(content: bytes, compression: Json) -> bytes:
    """`content` as the extension's JSON describes it. Raises MalformedError, or IndexError where it ends too early."""
    stride, count, mode = compression["byteStride"], compression["count"], compression["mode"]
    if mode != "ATTRIBUTES":
        if stride not in (2, 4):
            raise MalformedError(f"indices of {stride} bytes")
        decode = triangles if mode == "TRIANGLES" else indices
        return np.fromiter(decode(content, count), np.uint32, count).astype(f"<u{stride}").tobytes()
    if stride % 4 or stride > 256:
        raise MalformedError(f"elements of {stride} bytes")
    elements = elements_of(content, count, stride)
    match compression.get("filter", "NONE"), stride:
        case "OCTAHEDRAL", 4 | 8:
            return _directions(elements.view(f"<i{stride // 4}")).tobytes()
        case "QUATERNION", 8:
            return _quaternions(elements.view("<i2")).tobytes()
        case "EXPONENTIAL", _:
            return _floats(elements.view("<i4")).tobytes()
        case "COLOR", 4 | 8:
            return _colours(elements.view(f"<u{stride // 4}")).tobytes()
        case ("OCTAHEDRAL" | "QUATERNION" | "COLOR") as filtered, _:
            raise MalformedError(f"{filtered} elements of {stride} bytes")
    return elements.tobytes()


def _directions(packed: NDArray[Any]) -> NDArray[Any]:
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


def _quaternions(packed: NDArray[Any]) -> NDArray[Any]:
    """(n, 4) unit quaternions of which the three smaller components are stored, and which one is the largest."""
    one = (packed[:, 3] | 3).astype(np.float64)
    x, y, z = (packed[:, column] / one * np.sqrt(0.5) for column in range(3))
    w = np.sqrt(np.maximum(0, 1 - x * x - y * y - z * z))
    rows, largest = np.arange(len(packed)), (packed[:, 3] & 3).astype(np.int64)
    unpacked = np.empty_like(packed)
    for step, values in enumerate((w, x, y, z)):
        unpacked[rows, (largest + step) % 4] = np.round(np.clip(values, -1, 1) * 32767)
    return unpacked


def _floats(packed: NDArray[np.int32]) -> NDArray[np.float32]:
    """(n, k) of integers whose highest byte is the exponent of two by which the others are multiplied."""
    return np.asarray(np.ldexp((packed << 8 >> 8).astype(np.float32), packed >> 24))


def _colours(packed: NDArray[Any]) -> NDArray[Any]:
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
