"""How a mesh's maps are looked up by its texture coordinates, as `layout.glsl` reads it."""

from typing import Any

import numpy as np

from ashe_live.models.material import MAPS
from ashe_live.models.mesh import Mesh


def layout_constants(mesh: Mesh) -> dict[str, bool]:
    """Macros of a shader that looks up its maps."""
    is_laid_out = _is_laid_out(mesh)
    return {"laid_out": is_laid_out, "more_uvs": is_laid_out and mesh.more_uvs is not None}


def layout_uniforms(mesh: Mesh) -> dict[str, Any]:
    """The uniforms of such a shader: rows (10, 4) and offsets (5, 2), in the order of MAPS; none if it needs none."""
    if not _is_laid_out(mesh):
        return {}
    rows, offsets = np.zeros((len(MAPS), 2, 4)), np.zeros((len(MAPS), 2))
    for place, name in enumerate(MAPS):
        layout = mesh.material.layout(name)
        matrix = np.array(layout.matrix).reshape(2, 3)
        rows[place, :, 2 * layout.uv_set : 2 * layout.uv_set + 2] = matrix[:, :2]
        offsets[place] = matrix[:, 2]
    return {"map_rows": rows.reshape(-1, 4), "map_offsets": offsets}


def _is_laid_out(mesh: Mesh) -> bool:
    """Whether its maps are not all looked up by the first texture coordinates as they are."""
    return not all(mesh.material.layout(name).is_plain for name in mesh.material.maps)
