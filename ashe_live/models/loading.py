"""Reads glTF, GLB, OBJ, PLY and STL files with trimesh; reads beside the file only, never from a network."""

import io
import stat
import warnings
from pathlib import Path, PureWindowsPath
from typing import Any
from urllib.parse import unquote

import numpy as np
import trimesh
from PIL.Image import DecompressionBombWarning

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.models.geometry import placed_mesh
from ashe_live.models.gltf_header import read_gltf
from ashe_live.models.limits import MAX_FILE_BYTES, check_gltf, check_text, check_triangles
from ashe_live.models.mesh import Model
from ashe_live.models.surfaces import Surfaces

GLTF_SUFFIXES = (".glb", ".gltf")
SUFFIXES = (*GLTF_SUFFIXES, ".obj", ".ply", ".stl")

# glTF has y up; the model then faces -y, towards a person who reads the marker.
Z_UP_FROM_Y_UP: Float = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def load_model_file(path: Path) -> Model:
    """The model in `path`, its scene graph flattened, z up, in the file's unit.

    Raises UserError when the file is missing, too large, malformed or empty, or names a file outside its folder;
    MemoryError where that is limited.
    """
    resolver = _FolderResolver(path)
    problem: Exception | None = None
    try:
        with warnings.catch_warnings():
            # Pillow warns of large pictures at a limit of its own; ours are in limits.py.
            warnings.simplefilter("ignore", DecompressionBombWarning)
            return _read(path, resolver)
    except (UserError, MemoryError):  # memory is limited by who calls this
        raise
    except Exception as error:  # a third-party parser of untrusted files raises whatever it stumbles over
        problem = error
    if resolver.refusal is not None:
        raise resolver.refusal
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
    content = _content(path, MAX_FILE_BYTES)
    surfaces, up = Surfaces(), np.eye(4)
    if suffix in GLTF_SUFFIXES:
        gltf = read_gltf(content)
        check_gltf(path, gltf.amounts)
        content, surfaces, up = gltf.content, Surfaces(gltf.materials), Z_UP_FROM_Y_UP
    else:
        check_text(path, content)
    # process=True would merge vertices and thereby average normals that the file keeps apart.
    scene = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], resolver=resolver, process=False)
    # trimesh leaves out a texture that it cannot get.
    if resolver.refusal is not None:
        raise resolver.refusal
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


def _content(path: Path, most_bytes: int) -> bytes:
    """Raises UserError for more than `most_bytes`, and for what is no file: a pipe would be waited for."""
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise UserError(f"cannot read {path}, which is not a file", "give a model's file")
    if status.st_size > most_bytes:
        raise UserError(f"{path} is too large", f"reduce what the model reads to {MAX_FILE_BYTES // 1_000_000} MB")
    return path.read_bytes()


class _FolderResolver(trimesh.resolvers.Resolver):
    """Lets a model file read what lies in its own folder, and remembers why it was refused something."""

    def __init__(self, model: Path) -> None:
        self.refusal: UserError | None = None
        self._model = model
        self._folder = model.parent.resolve()
        self._bytes_left = MAX_FILE_BYTES

    def get(self, name: str) -> bytes:
        relative = unquote(name.strip())
        # Before it is looked at: on Windows that of another machine would be asked for.
        is_elsewhere = bool(PureWindowsPath(relative).anchor)
        path = self._folder if is_elsewhere else (self._folder / relative).resolve()
        try:
            if is_elsewhere or not path.is_relative_to(self._folder):
                raise UserError(
                    f"the model file {self._model} names {name}, outside its own folder", "put what it needs beside it"
                )
            content = _content(path, self._bytes_left)
        except UserError as refusal:
            # trimesh goes on without a texture that it cannot get.
            self.refusal = refusal
            raise
        self._bytes_left -= len(content)
        return content

    def keys(self) -> list[str]:
        raise NotImplementedError("only what is named is read")

    def namespaced(self, namespace: str) -> "_FolderResolver":
        raise NotImplementedError(f"a model has one folder: {namespace}")

    def write(self, name: str, data: bytes) -> None:
        raise NotImplementedError(f"a model is only read: {name}, {len(data)} bytes")
