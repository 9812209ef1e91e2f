"""The kinds of numbers that accessors hold, and which of them each use allows.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#accessor-data-types
"""

from typing import Any

import numpy as np

BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT, FLOAT = 5120, 5121, 5122, 5123, 5125, 5126
COMPONENT_TYPES: dict[int, np.dtype[Any]] = {
    BYTE: np.dtype("<i1"),
    UNSIGNED_BYTE: np.dtype("<u1"),
    SHORT: np.dtype("<i2"),
    UNSIGNED_SHORT: np.dtype("<u2"),
    UNSIGNED_INT: np.dtype("<u4"),
    FLOAT: np.dtype("<f4"),
}
# How many of them an element of each type has.
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
NORMALISED = (FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT)  # floats, and integers as shares of their largest
QUANTISED = (FLOAT, BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT)  # KHR_mesh_quantization
UV_SETS = 4
JOINT_SETS = 2  # of four joints and weights each
# What the specification lets an accessor be: its elements' types, and their components'.
Layout = tuple[tuple[str, ...], tuple[int, ...]]
# What morph targets displace of what is drawn; then all attributes that are drawn.
DISPLACED: dict[str, Layout] = {"POSITION": (("VEC3",), QUANTISED), "NORMAL": (("VEC3",), (FLOAT, BYTE, SHORT))}
ATTRIBUTES: dict[str, Layout] = {
    **DISPLACED,
    **{f"TEXCOORD_{number}": (("VEC2",), QUANTISED) for number in range(UV_SETS)},
    "COLOR_0": (("VEC3", "VEC4"), NORMALISED),
    **{f"JOINTS_{number}": (("VEC4",), (UNSIGNED_BYTE, UNSIGNED_SHORT)) for number in range(JOINT_SETS)},
    **{f"WEIGHTS_{number}": (("VEC4",), NORMALISED) for number in range(JOINT_SETS)},
}
INDICES: Layout = (("SCALAR",), (UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT))
