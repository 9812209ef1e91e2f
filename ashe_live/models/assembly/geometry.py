"""From a file's meshes to ours: placed, with a normal for each vertex, wound as their normals say."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float
from ashe_live.models.assembly.shading_normals import (
    completed_normals,
    corner_normals,
    flat_normals,
    has_direction,
    is_inside_out,
    row_keys,
    unit_rows,
    vertex_normals,
)
from ashe_live.models.material import Material
from ashe_live.models.mesh import Float32, Indices, Mesh, Motion, face_normals
from ashe_live.models.parsing.malformed import MalformedError

# Share of a file's normals, of vertices that triangles use, which may be no directions; with more, none is believed.
FEW_MISSING = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class RawMotion:
    """Poses of a mesh, evenly spaced in time; of one of them it is made."""

    vertices: Float32  # (k, n, 3)
    normals: Float32 | None  # (k, n, 3) of any length
    duration_s: float


@dataclass(frozen=True, slots=True, eq=False)
class RawMesh:
    """Triangles as a file has them, in its own frame; nothing of it is checked but the arrays' shapes."""

    vertices: Float | Float32  # (n, 3), in double precision where the file is: maps count metres from far away
    triangles: NDArray[np.int64]  # (m, 3) indices of vertices
    material: Material
    normals: Float | None = None  # (n, 3) of any length
    uvs: Float | None = None  # (n, 2) texture coordinates, origin at the picture's bottom left
    more_uvs: Float | None = None  # (n, 2) a second set
    colours: Float | None = None  # (n, 4) linear RGBA
    motion: RawMotion | None = None
    is_flat: bool = False  # every triangle shaded as a plane, where there are no normals; else smooth


def placed_mesh(raw: RawMesh, T: Float) -> Mesh | None:
    """A mesh moved by T (4, 4) into the model's frame; None when no triangle of it has an area.

    Raises MalformedError for indices out of range and for values that are not finite. Vertices of no triangle may have
    such values: scanners write them where they saw nothing.
    """
    is_used = used_vertices(raw)
    moved = _moved(raw, T, is_used)
    if moved is None:
        return None
    vertices, triangles = moved
    attributes = _attributes(raw, is_used)
    normals = _file_normals(raw, T, triangles)
    if normals is None:
        surface = _with_computed_normals(raw, vertices, triangles, attributes.values())
    else:
        surface = _with_file_normals(raw, vertices, triangles, normals)
    motion = None
    if raw.motion is not None:
        motion = _placed_motion(raw.motion, surface.motion_normals, T, surface.source, surface.triangles)
    kept = {name: values[surface.source] for name, values in attributes.items()}
    return Mesh(
        vertices=vertices[surface.source],
        normals=surface.normals,
        triangles=surface.triangles,
        uvs=kept.get("uvs"),
        colours=kept.get("colours"),
        material=raw.material if "uvs" in kept else raw.material.without_maps(),
        more_uvs=kept.get("more_uvs"),
        motion=motion,
        faces_inwards=surface.faces_inwards and not _may_be_turned(raw),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Surface:
    """Triangles with normals, of those of the file's vertices that are kept."""

    source: NDArray[np.integer]  # (n,) the file's vertices
    triangles: Indices  # (m, 3) indices of `source`
    normals: Float32  # (n, 3) unit
    motion_normals: Float32 | None  # (poses, the file's vertices, 3); None where each pose has its triangles'
    faces_inwards: bool  # as the file has it


def _may_be_turned(raw: RawMesh) -> bool:
    """A single-sided surface keeps its side: hulls that outline a figure, and rooms, face inwards."""
    return raw.material.double_sided


def _with_computed_normals(
    raw: RawMesh, vertices: Float32, triangles: Indices, attributes: Iterable[Float32]
) -> _Surface:
    """The surface with normals by its triangles; corners that are alike in everything become one vertex."""
    faces_inwards = is_inside_out(vertices, triangles)
    if faces_inwards and _may_be_turned(raw):
        triangles = triangles[:, ::-1]
    normals = (flat_normals if raw.is_flat else corner_normals)(vertices, triangles)
    each = triangles.ravel()
    alike = [values[each] for values in attributes]
    if raw.motion is not None:  # what is in one place now may move apart, and what is in one plane may be folded
        own = np.arange(len(each)) // 3 if raw.is_flat else each
        alike.append(own[:, None].astype(np.float32))
    kept, triangles = _welded(vertices[each], normals, *alike)
    return _Surface(each[kept], triangles, normals[kept], None, faces_inwards)


def _with_file_normals(raw: RawMesh, vertices: Float32, triangles: Indices, normals: Float32) -> _Surface:
    """The surface with the file's normals (n, 3), by which its triangles are wound; missing ones are completed."""
    triangles = _wound_like_normals(vertices, triangles, normals)
    normals = completed_normals(normals, vertices, triangles)
    motion_normals = None if raw.motion is None else raw.motion.normals
    faces_inwards = is_inside_out(vertices, triangles)
    if faces_inwards and _may_be_turned(raw):
        triangles, normals = triangles[:, ::-1], -normals
        motion_normals = None if motion_normals is None else -motion_normals
    # What no triangle uses is not seen, and must not count where the model's size is measured.
    source, triangles = _used(triangles, len(vertices))
    return _Surface(source, triangles, normals[source], motion_normals, faces_inwards)


def used_vertices(raw: RawMesh) -> NDArray[np.bool_]:
    """(n,) whether a triangle names the vertex. Raises MalformedError for indices out of range."""
    is_used = np.zeros(len(raw.vertices), np.bool_)
    if len(raw.triangles):
        least, most = raw.triangles.min(), raw.triangles.max()
        if least < 0 or most >= len(is_used):
            raise MalformedError(f"a triangle names vertex {least if least < 0 else most} of {len(is_used)}")
        is_used[raw.triangles.ravel()] = True
    return is_used


def _moved(raw: RawMesh, T: Float, is_used: NDArray[np.bool_]) -> tuple[Float32, Indices] | None:
    """(n, 3) vertices moved by T, and those triangles that have an area, with their fronts outside if T mirrors."""
    vertices = raw.vertices if np.array_equal(T, np.eye(4)) else raw.vertices @ T[:3, :3].T + T[:3, 3]
    vertices = vertices.astype(np.float32)
    _check_finite(vertices, is_used, "vertices")
    triangles = raw.triangles.astype(np.uint32)
    has_area = np.any(face_normals(vertices, triangles) != 0, axis=1)
    triangles = triangles if has_area.all() else triangles[has_area]
    if len(triangles) == 0:
        return None
    return vertices, triangles[:, ::-1] if np.linalg.det(T[:3, :3]) < 0 else triangles


def _check_finite(values: Float32, is_used: NDArray[np.bool_], name: str) -> None:
    is_finite = np.isfinite(values)
    if not is_finite.all() and not is_finite[is_used].all():
        raise MalformedError(f"{name} hold a value that is not finite")


def _attributes(raw: RawMesh, is_used: NDArray[np.bool_]) -> dict[str, Float32]:
    """The file's texture coordinates and colours, one a vertex, by their names in a Mesh."""
    given = {"uvs": raw.uvs, "more_uvs": raw.more_uvs, "colours": raw.colours}
    attributes = {name: values.astype(np.float32) for name, values in given.items() if values is not None}
    for name, values in attributes.items():
        _check_finite(values, is_used, name)
    return attributes


def _placed_motion(
    raw: RawMotion, normals: Float32 | None, T: Float, source: NDArray[np.integer], triangles: Indices
) -> Motion:
    """Moved by T, of the vertices (n,) that the mesh has kept; without `normals` each pose has its triangles'."""
    shape = len(raw.vertices), len(source), 3
    placed, turned = np.empty(shape, np.float32), np.empty(shape, np.float32)
    for number, vertices in enumerate(raw.vertices):
        placed[number] = vertices[source] @ T[:3, :3].T + T[:3, 3]
        if not np.isfinite(placed[number]).all():
            raise MalformedError("an animation moves vertices to no place")
        pointing = vertex_normals(placed[number], triangles) if normals is None else normals[number][source]
        turned[number] = unit_rows(pointing if normals is None else pointing @ np.linalg.inv(T[:3, :3]))
    if not has_direction(turned).all():
        raise MalformedError("an animation turns normals to no direction")
    return Motion(placed, turned, raw.duration_s)


def _file_normals(raw: RawMesh, T: Float, triangles: Indices) -> Float32 | None:
    """(n, 3) unit, moved by T, and 0 for those that are no directions; None when the file brings none, or too few."""
    if raw.normals is None:
        return None
    T_normals = T[:3, :3]
    if not np.linalg.det(T_normals):
        return None
    moved = raw.normals @ np.linalg.inv(T_normals)
    is_known = has_direction(moved)
    if not is_known.all() and np.mean(~is_known[np.unique(triangles)]) > FEW_MISSING:
        return None
    return np.where(is_known[:, None], unit_rows(np.where(is_known[:, None], moved, 0.0)), 0.0).astype(np.float32)


def _welded(places: Float32, normals: Float32, *attributes: Float32) -> tuple[NDArray[np.int64], Indices]:
    """One vertex for all corners (3 m, any) of triangles that are alike in everything.

    Returns the corners (k,) to keep, and triangles (m, 3) of indices to those.
    """
    keys = row_keys(np.hstack([places, np.round(normals, 3), *attributes]))
    _, kept, indices = np.unique(keys, return_index=True, return_inverse=True)
    return kept, indices.reshape(-1, 3).astype(np.uint32)


def _used(triangles: Indices, count: int) -> tuple[NDArray[np.int64], Indices]:
    """Which of `count` vertices triangles use (k,), and triangles (m, 3) of indices to those."""
    is_used = np.zeros(count, np.bool_)
    is_used[triangles.ravel()] = True
    numbers = np.cumsum(is_used, dtype=np.uint32) - np.uint32(1)
    return np.flatnonzero(is_used), numbers[triangles]


def _wound_like_normals(vertices: Float32, triangles: Indices, normals: Float32) -> Indices:
    """Triangles turned so that they run counter-clockwise seen from where their normals point."""
    against = np.einsum("ij,ij->i", face_normals(vertices, triangles), normals[triangles].sum(axis=1)) < 0
    return np.where(against[:, None], triangles[:, ::-1], triangles)
