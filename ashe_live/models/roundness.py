"""Tells meshes whose triangles stand for a round surface, and are large enough for their edges to be seen."""

import numpy as np

from ashe_live.models.mesh import Mesh, face_normals

LOOKED_AT = 5000  # triangles of a mesh, spread evenly over it
FEW = 0.02  # share of them that must stand for a round surface
SEEN_DEG = 2.0  # angle between a triangle and its corners' normals from which on light ends visibly on its edges
ROUND_DEG = 37.0  # up to which the surface counts as round: where model.frag has NOT_ROUND


def stands_for_round(mesh: Mesh) -> bool:
    """Whether enough triangles lean away from their corners' normals as on a round surface, and not as at an edge."""
    corners = mesh.triangles[:: max(1, len(mesh.triangles) // LOOKED_AT)]
    facing = face_normals(mesh.vertices, corners)
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-30)
    cosines = np.abs(np.einsum("nk,nvk->nv", facing, mesh.normals[corners])).min(axis=1)
    is_round = (cosines < np.cos(np.radians(SEEN_DEG))) & (cosines > np.cos(np.radians(ROUND_DEG)))
    return bool(is_round.mean() > FEW)
