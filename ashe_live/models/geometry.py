"""From trimesh's meshes to ours: placed, with a normal for each vertex, wound as their normals say."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.gltf_header import FAN_MARK
from ashe_live.models.malformed import MalformedError
from ashe_live.models.mesh import Float32, Indices, Mesh
from ashe_live.models.shading_normals import corner_normals, face_normals, is_inside_out, row_keys, unit_rows
from ashe_live.models.surfaces import Surfaces


def placed_mesh(mesh: Any, T: Float, surfaces: Surfaces) -> Mesh | None:
    """A trimesh moved by T (4, 4) into the model's frame; None when no triangle of it has an area.

    Raises MalformedError for indices out of range and for values that are not finite.
    """
    if mesh.visual.kind == "face":
        mesh.unmerge_vertices()  # each triangle has a colour, and so corners of its own
    places = np.asarray(mesh.vertices, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] != 3:
        raise MalformedError(f"its vertices have {places.shape[-1]} coordinates and not three")
    vertices = (places @ T[:3, :3].T + T[:3, 3]).astype(np.float32)
    corners = _fan(mesh.faces) if FAN_MARK in mesh.vertex_attributes else np.asarray(mesh.faces)
    if corners.min() < 0 or len(vertices) <= corners.max():
        raise MalformedError(f"a triangle names vertex {corners.max()} of {len(vertices)}")
    triangles = corners.astype(np.uint32)
    if not np.isfinite(vertices).all():
        raise MalformedError("vertices hold a value that is not finite")
    triangles = triangles[np.any(face_normals(vertices, triangles) != 0, axis=1)]
    if len(triangles) == 0:
        return None
    is_mirrored = np.linalg.det(T[:3, :3]) < 0
    if is_mirrored:
        triangles = triangles[:, ::-1]
    attributes = _attributes(mesh, surfaces)
    for name, values in attributes.items():
        if not np.isfinite(values).all():
            raise MalformedError(f"{name} hold a value that is not finite")
    normals = _file_normals(mesh, T)
    if normals is None:
        if is_inside_out(vertices, triangles):
            triangles = triangles[:, ::-1]
        normals = corner_normals(vertices, triangles)
        each = triangles.ravel()
        kept, triangles = _welded(vertices[each], normals, *(values[each] for values in attributes.values()))
        normals, vertices = normals[kept], vertices[each[kept]]
        attributes = {name: values[each[kept]] for name, values in attributes.items()}
    else:
        triangles = _wound_like_normals(vertices, triangles, normals)
        if is_inside_out(vertices, triangles):
            triangles, normals = triangles[:, ::-1], -normals
    material = surfaces.material(mesh.visual)
    if "uvs" not in attributes:
        material = material.without_maps()
    return Mesh(
        vertices=vertices,
        normals=normals,
        triangles=triangles,
        uvs=attributes.get("uvs"),
        colours=attributes.get("colours"),
        material=material,
    )


def _fan(strip: NDArray[np.int64]) -> NDArray[np.int64]:
    """(m, 3) triangles that share their first corner, from those that trimesh made of the same corners as a strip."""
    is_turned = np.arange(len(strip)) % 2 == 1  # (a, b, c) is (c, b, a) there
    last = np.where(is_turned, strip[:, 0], strip[:, 2])
    return np.column_stack([np.full(len(strip), strip[0, 0]), strip[:, 1], last])


def _file_normals(mesh: Any, T: Float) -> Float32 | None:
    """(n, 3) unit, moved by T; None when the file brings none, or some that are no directions."""
    # trimesh computes normals when asked; only its cache tells whether the file brought them.
    if "vertex_normals" not in mesh._cache.cache or mesh.vertex_normals.shape != mesh.vertices.shape:
        return None
    T_normals = T[:3, :3]
    if not np.linalg.det(T_normals):
        return None
    moved = np.asarray(mesh.vertex_normals, dtype=np.float64) @ np.linalg.inv(T_normals)
    if not np.isfinite(moved).all() or not np.any(moved, axis=1).all():
        return None
    return unit_rows(moved).astype(np.float32)


def _welded(places: Float32, normals: Float32, *attributes: Float32) -> tuple[NDArray[np.int64], Indices]:
    """One vertex for all corners (3 m, any) of triangles that are alike in everything.

    Returns the corners (k,) to keep, and triangles (m, 3) of indices to those.
    """
    keys = row_keys(np.hstack([places, np.round(normals, 3), *attributes]))
    _, kept, indices = np.unique(keys, return_index=True, return_inverse=True)
    return kept, indices.reshape(-1, 3).astype(np.uint32)


def _wound_like_normals(vertices: Float32, triangles: Indices, normals: Float32) -> Indices:
    """Triangles turned so that they run counter-clockwise seen from where their normals point."""
    against = np.einsum("ij,ij->i", face_normals(vertices, triangles), normals[triangles].sum(axis=1)) < 0
    return np.where(against[:, None], triangles[:, ::-1], triangles)


def _attributes(mesh: Any, surfaces: Surfaces) -> dict[str, Float32]:
    """What the file says of each vertex beyond its place."""
    found: dict[str, Float32] = {}
    visual, raw = mesh.visual, mesh.vertex_attributes
    # Attributes of glTF are renamed (gltf_header.py) and come as the file has them.
    gltf_uvs = raw.get(f"_TEXCOORD_{surfaces.uv_set(visual)}")
    uvs = getattr(visual, "uv", None)
    if gltf_uvs is not None:
        u, v = _in_unit_range(gltf_uvs).T
        found["uvs"] = np.column_stack([u, 1 - v]).astype(np.float32)
    elif uvs is not None and np.ndim(uvs) == 2 and len(uvs) == len(mesh.vertices) and np.shape(uvs)[1] >= 2:
        found["uvs"] = np.asarray(uvs, dtype=np.float32)[:, :2]  # an OBJ may have a third
    if "_COLOR_0" in raw:
        colours = _in_unit_range(raw["_COLOR_0"])
        opaque = np.ones((len(colours), 4 - colours.shape[1]))
        found["colours"] = np.hstack([colours, opaque]).astype(np.float32)
    elif visual.kind in ("vertex", "face"):
        of_corners = np.repeat(visual.face_colors, 3, axis=0) if visual.kind == "face" else visual.vertex_colors
        encoded = np.asarray(of_corners, dtype=np.float64) / 255
        found["colours"] = np.column_stack([linear_from_srgb(encoded[:, :3]), encoded[:, 3]]).astype(np.float32)
    return found


def _in_unit_range(values: NDArray[Any]) -> Float:
    """Integers as glTF normalises them, floats as they are."""
    scale = 1.0 if values.dtype.kind == "f" else float(np.iinfo(values.dtype).max)
    return np.asarray(values, dtype=np.float64) / scale
