"""PLY, parsed by trimesh."""

import io
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.colour import linear_from_srgb
from ashe_live.models.formats.mtl import pictured
from ashe_live.models.geometry import RawMesh
from ashe_live.models.material import UNKNOWN, Material
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import Notes
from ashe_live.models.parsing.pictures import Pictures


def read_ply(content: bytes, folder: Folder, _notes: Notes) -> Iterator[RawMesh]:
    """Raises UserError for a texture that cannot be read, and whatever trimesh raises for a damaged file."""
    import trimesh  # only here, as no other format needs it, and every start of the program would wait for it

    material = _material(content, folder)
    # process=True would merge vertices and thereby average normals that the file keeps apart.
    scene = trimesh.load_scene(io.BytesIO(content), file_type="ply", process=False, skip_materials=True)
    for mesh in scene.geometry.values():
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            yield _converted(mesh, material)


def _material(content: bytes, folder: Folder) -> Material:
    for line in content[: content.find(b"end_header")].splitlines():
        if line.startswith(b"comment TextureFile "):
            name = line.removeprefix(b"comment TextureFile ").decode(errors="replace").strip()
            return pictured(UNKNOWN, Pictures().texels(name, partial(folder.get, name), f"texture {name}"))
    return UNKNOWN


def _converted(mesh: Any, material: Material) -> RawMesh:
    visual = mesh.visual
    colours = None
    if visual.kind == "face":
        mesh.unmerge_vertices()  # each triangle has a colour, and so corners of its own
        colours = np.repeat(visual.face_colors, 3, axis=0)
    elif visual.kind == "vertex":
        colours = visual.vertex_colors
    places = np.asarray(mesh.vertices, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] != 3:
        raise MalformedError(f"its vertices have {places.shape[-1]} coordinates and not three")
    uvs = getattr(visual, "uv", None)
    has_uvs = uvs is not None and np.ndim(uvs) == 2 and len(uvs) == len(places) and np.shape(uvs)[1] >= 2
    # trimesh computes normals when asked; only its cache tells whether the file brought them.
    has_normals = "vertex_normals" in mesh._cache.cache
    return RawMesh(
        vertices=places,
        triangles=np.asarray(mesh.faces, dtype=np.int64),
        material=material,
        normals=np.asarray(mesh.vertex_normals, dtype=np.float64) if has_normals else None,
        uvs=np.asarray(uvs, dtype=np.float64)[:, :2] if has_uvs else None,
        colours=None if colours is None else _linear(colours),
    )


def _linear(colours: Any) -> Float:
    encoded = np.asarray(colours, dtype=np.float64) / 255
    return np.column_stack([linear_from_srgb(encoded[:, :3]), encoded[:, 3]])
