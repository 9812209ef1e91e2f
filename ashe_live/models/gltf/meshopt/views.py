"""A compressed view as its extension's JSON describes it: mode, stride and filter say how it is read.

https://github.com/KhronosGroup/glTF/blob/main/extensions/2.0/Khronos/KHR_meshopt_compression/README.md

No wheel that is kept well decodes it: meshoptimizer's own has none for any system, another wants a processor with AVX2.
"""

import numpy as np

from ashe_live.models.gltf.meshopt.elements import elements_of
from ashe_live.models.gltf.meshopt.filters import colours, directions, floats, quaternions
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
            return directions(elements.view(f"<i{stride // 4}")).tobytes()
        case "QUATERNION", 8:
            return quaternions(elements.view("<i2")).tobytes()
        case "EXPONENTIAL", _:
            return floats(elements.view("<i4")).tobytes()
        case "COLOR", 4 | 8:
            return colours(elements.view(f"<u{stride // 4}")).tobytes()
        case ("OCTAHEDRAL" | "QUATERNION" | "COLOR") as filtered, _:
            raise MalformedError(f"{filtered} elements of {stride} bytes")
    return elements.tobytes()
