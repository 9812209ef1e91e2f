"""How a mesh's maps are looked up by its texture coordinates, as `layout.glsl` reads it."""

from typing import Any

import numpy as np

from ashe_live.models.material import MAPS
from ashe_live.models.mesh import Mesh


def layout_constants(mesh: Mesh) -> dict[str, int]:
    """Macros for a shader whose maps are not all looked up by the first texture coordinates as they are."""
    if all(mesh.material.layout(name).is_plain for name in mesh.material.maps):
        return {}
    return {"laid_out": 1, **({"more_uvs": 1} if mesh.more_uvs is not None else {})}


def layout_uniforms(mesh: Mesh, constants: dict[str, int]) -> dict[str, Any]:
    """The uniforms of such a shader: rows (10, 4) and offsets (5, 2), in the order of MAPS; none for other shaders."""
    if "laid_out" not in constants:
        return {}
    rows, offsets = np.zeros((len(MAPS), 2, 4)), np.zeros((len(MAPS), 2))
    for place, name in enumerate(MAPS):
        layout = mesh.material.layout(name)
        matrix = np.array(layout.matrix).reshape(2, 3)
        rows[place, :, 2 * layout.uv_set : 2 * layout.uv_set + 2] = matrix[:, :2]
        offsets[place] = matrix[:, 2]
    return {"map_rows": rows.reshape(-1, 4), "map_offsets": offsets}
