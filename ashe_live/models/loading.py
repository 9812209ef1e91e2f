"""Reads glTF, GLB, OBJ, PLY and STL files with trimesh; reads beside the file only, never from a network."""

import io
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import trimesh

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.models.geometry import placed_mesh
from ashe_live.models.gltf_header import read_gltf
from ashe_live.models.limits import MAX_FILE_BYTES, check_accessor, check_triangles, stated_triangles
from ashe_live.models.mesh import Model
from ashe_live.models.surfaces import Surfaces

GLTF_SUFFIXES = (".glb", ".gltf")
SUFFIXES = (*GLTF_SUFFIXES, ".obj", ".ply", ".stl")

# glTF has y up; the model then faces -y, towards a person who reads the marker.
Z_UP_FROM_Y_UP: Float = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def load_model_file(path: Path) -> Model:
    """The model in `path`, its scene graph flattened, z up, in the file's unit.

    Raises UserError when the file is missing, too large, malformed or empty, or names a file outside its folder.
    """
    resolver = _FolderResolver(path.parent)
    problem: Exception | None = None
    try:
        return _read(path, resolver)
    except UserError:
        raise
    except Exception as error:  # a third-party parser of untrusted files raises whatever it stumbles over
        problem = error
    if resolver.refused:
        raise resolver.refusal(path)
    if isinstance(problem, OSError) and problem.filename is not None:
        named = "" if Path(problem.filename) == path else f", which names {problem.filename}"
        raise UserError(f"cannot read the model file {path}{named}", problem.strerror or str(problem)) from problem
    detail = str(problem) if isinstance(problem, ValueError | OSError) else f"{type(problem).__name__}: {problem}"
    first_line = (detail.splitlines() or [""])[0][:120]
    raise UserError(f"the model file {path} is malformed ({first_line})", "export it again") from problem


def _read(path: Path, resolver: "_FolderResolver") -> Model:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise UserError(f"{path} is not a kind of model file known here", f"give one of {', '.join(SUFFIXES)}")
    if path.stat().st_size > MAX_FILE_BYTES:
        raise UserError(f"the model file {path} is too large", f"reduce it to {MAX_FILE_BYTES // 1_000_000} MB")
    content = path.read_bytes()
    surfaces, up = Surfaces(), np.eye(4)
    if suffix in GLTF_SUFFIXES:
        gltf = read_gltf(content)
        check_triangles(path, gltf.triangles)
        check_accessor(path, gltf.largest_accessor)
        content, surfaces, up = gltf.content, Surfaces(gltf.materials), Z_UP_FROM_Y_UP
    else:
        check_triangles(path, stated_triangles(suffix, content))
    # process=True would merge vertices and thereby average normals that the file keeps apart.
    scene = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], resolver=resolver, process=False)
    # trimesh leaves out a texture that it cannot get.
    if resolver.refused:
        raise resolver.refusal(path)
    return _converted(path, scene, surfaces, up)


def _converted(path: Path, scene: Any, surfaces: Surfaces, up: Float) -> Model:
    nodes = [scene.graph[node] for node in scene.graph.nodes_geometry]
    instances = [(up @ np.asarray(T, dtype=np.float64), scene.geometry[name]) for T, name in nodes]
    meshes = [(T, mesh) for T, mesh in instances if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    check_triangles(path, sum(len(mesh.faces) for _, mesh in meshes))
    parts = [part for T, mesh in meshes if (part := placed_mesh(mesh, T, surfaces)) is not None]
    if not parts:
        raise UserError(f"the model file {path} holds no triangles", "export it as a mesh")
    model = Model(path.stem, tuple(parts))
    lower, upper = model.bounds
    if not (np.isfinite(upper - lower).all() and (upper - lower).max() > 0):
        raise UserError(f"the model file {path} has no extent", "export a model that is larger than a point")
    return model


class _FolderResolver(trimesh.resolvers.Resolver):
    """Lets a model file read what lies in its own folder, and remembers what it was refused."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.refused: list[str] = []

    def get(self, name: str) -> bytes:
        path = (self.folder / unquote(name.strip())).resolve()
        if not path.is_relative_to(self.folder):
            self.refused.append(name)
            raise FileNotFoundError(name)
        if path.stat().st_size > MAX_FILE_BYTES:
            raise UserError(f"{path} is too large", f"reduce it to {MAX_FILE_BYTES // 1_000_000} MB")
        return path.read_bytes()

    def refusal(self, model: Path) -> UserError:
        return UserError(
            f"the model file {model} names {self.refused[0]}, outside its own folder", "put what it needs beside it"
        )

    def keys(self) -> list[str]:
        return [path.name for path in self.folder.iterdir()]

    def namespaced(self, namespace: str) -> "_FolderResolver":
        return self if not namespace else _FolderResolver(self.folder / namespace)

    def write(self, name: str, data: bytes) -> None:
        raise NotImplementedError(f"a model is only read: {name}, {len(data)} bytes")
