"""Simplifies a model for ambient occlusion, which draws it many times and does not need every detail.

Vertex clustering (Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993): of
all vertices in a cell of a grid one is kept, and with it the triangles that do not collapse.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh
from ashe_live.models.placement import PlacedModel

MOST_TRIANGLES = 30_000  # a model of up to this many is not simplified
CELLS = 64  # along the longest side of a model


@dataclass(frozen=True, slots=True, eq=False)
class StandIn:
    """The simplified model, and which of its vertices are whose."""

    placed: PlacedModel
    vertices: tuple[NDArray[np.integer] | slice, ...]  # for each part's vertices the one that stands in for them


def stand_in_for(placed: PlacedModel) -> StandIn:
    """The model itself where it is small. Parts that move, or that have holes, always stand in for themselves."""
    parts = placed.model.parts
    if placed.model.triangle_count <= MOST_TRIANGLES:
        return StandIn(placed, (slice(None),) * len(parts))
    cell = float((placed.bounds[1] - placed.bounds[0]).max()) / CELLS
    coarse, vertices = zip(*(_coarse(part, cell) for part in parts), strict=True)
    return StandIn(PlacedModel(replace(placed.model, parts=coarse), placed.bounds), vertices)


def _coarse(mesh: Mesh, cell: float) -> tuple[Mesh, NDArray[np.integer] | slice]:
    if mesh.motion is not None or mesh.material.alpha is not Alpha.OPAQUE:
        return mesh, slice(None)
    columns = np.floor((mesh.vertices - mesh.vertices.min(axis=0)) / cell).astype(np.int64)
    sides = columns.max(axis=0) + 1
    cells = (columns[:, 0] * sides[1] + columns[:, 1]) * sides[2] + columns[:, 2]
    _, kept, of_vertex = np.unique(cells, return_index=True, return_inverse=True)
    corners = of_vertex[mesh.triangles]
    apart = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    if not apart.any():
        return mesh, slice(None)
    triangles = np.unique(corners[apart], axis=0).astype(np.uint32)
    material = Material(double_sided=mesh.material.double_sided)
    stand_in = Mesh(
        mesh.vertices[kept], mesh.normals[kept], triangles, material=material, faces_inwards=mesh.faces_inwards
    )
    return stand_in, of_vertex
