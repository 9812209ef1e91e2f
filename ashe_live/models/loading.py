"""Reads glTF, GLB, OBJ, PLY and STL files with trimesh; reads beside the file only, never from a network."""

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.files.reading import read_bytes
from ashe_live.models.folder import FolderResolver
from ashe_live.models.geometry import placed_mesh
from ashe_live.models.gltf_header import read_gltf
from ashe_live.models.limits import MAX_FILE_BYTES, check_surfaces, check_text, check_triangles
from ashe_live.models.malformed import MalformedError
from ashe_live.models.merging import merged
from ashe_live.models.mesh import Model
from ashe_live.models.obj_text import drawn_lines
from ashe_live.models.surfaces import Surfaces

GLTF_SUFFIXES = (".glb", ".gltf")
SUFFIXES = (*GLTF_SUFFIXES, ".obj", ".ply", ".stl")
BROKEN_BODY = {
    **dict.fromkeys(GLTF_SUFFIXES, "its buffers do not hold what its accessors say"),
    ".obj": "a line is not OBJ, or a face names what is not there",
    ".ply": "it does not hold what its header says",
    ".stl": "it is neither text STL nor binary STL",
}

# glTF has y up; the model then faces -y, towards a person who reads the marker.
Z_UP_FROM_Y_UP: Float = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def load_model_file(path: Path) -> Model:
    """The model in `path`, its scene graph flattened, z up, in the file's unit.

    Raises UserError when the file is missing, too large, malformed or empty, or names a file that is missing or outside
    its folder; MemoryError where that is limited.
    """
    try:
        return _read(path)
    except (UserError, MemoryError):
        raise
    except Exception as error:  # a third-party parser of untrusted files raises anything, or its values do when used
        said = error if isinstance(error, MalformedError) else BROKEN_BODY[path.suffix.lower()]
        raise UserError(f"the model file {path} is malformed ({said})", "export it again") from error


def _read(path: Path) -> Model:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise UserError(f"{path} is not a kind of model file known here", f"give one of {', '.join(SUFFIXES)}")
    content = read_bytes(path, MAX_FILE_BYTES)
    surfaces, up = Surfaces(), np.eye(4)
    if suffix in GLTF_SUFFIXES:
        gltf = read_gltf(path, content)
        content, surfaces, up = gltf.content, Surfaces(gltf.materials), Z_UP_FROM_Y_UP
    else:
        check_text(path, content)
        if suffix == ".obj":
            content = drawn_lines(content)
    resolver = FolderResolver(path, MAX_FILE_BYTES)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # What trimesh, Pillow and NumPy have to say about a damaged file is said by our errors.
        warnings.simplefilter("ignore")
        scene = _parsed(content, suffix, resolver)
        return _converted(path, scene, surfaces, up)


def _parsed(content: bytes, suffix: str, resolver: FolderResolver) -> Any:
    """trimesh's scene. Raises what `resolver` refused, and whatever trimesh stumbles over."""
    try:
        # process=True would merge vertices and thereby average normals that the file keeps apart.
        return trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], resolver=resolver, process=False)
    finally:
        # trimesh goes on without a texture that it cannot get.
        if resolver.refusal is not None:
            raise resolver.refusal


def _converted(path: Path, scene: Any, surfaces: Surfaces, up: Float) -> Model:
    nodes = [scene.graph[node] for node in scene.graph.nodes_geometry]
    instances = [(up @ np.asarray(T, dtype=np.float64), scene.geometry[name]) for T, name in nodes]
    meshes = [(T, mesh) for T, mesh in instances if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    check_triangles(path, sum(len(mesh.faces) for _, mesh in meshes))
    parts = merged(part for T, mesh in meshes if (part := placed_mesh(mesh, T, surfaces)) is not None)
    if not parts:
        raise UserError(f"the model file {path} holds no triangles", "export it as a mesh")
    check_surfaces(path, len(parts))
    model = Model(path.stem, parts)
    lower, upper = model.bounds
    if not (np.isfinite(upper - lower).all() and (upper - lower).max() > 0):
        raise UserError(f"the model file {path} has no extent", "export a model that is larger than a point")
    return model
