"""Reads glTF, GLB, OBJ, PLY and STL files with trimesh; reads beside the file only, never from a network."""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image as PillowImage

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import linear_from_srgb
from ashe_live.errors import UserError
from ashe_live.models.mesh import WHITE, Float32, Indices, LinearRGBA, Mesh, Model
from ashe_live.models.shading_normals import corner_normals, face_normals, unit_rows

SUFFIXES = (".glb", ".gltf", ".obj", ".ply", ".stl")
MAX_FILE_BYTES = 200_000_000
MAX_TRIANGLES = 2_000_000
MAX_TEXTURE_PX = 2048

# glTF has y up; the model then faces -y, towards a person who reads the marker.
Z_UP_FROM_Y_UP: Float = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def load_model_file(path: Path) -> Model:
    """The model in `path`, its scene graph flattened, z up, in the file's unit.

    Raises UserError when the file is missing, too large, malformed or empty, or names a file outside its folder.
    """
    scene = _read_scene(path)
    nodes = [scene.graph[node] for node in scene.graph.nodes_geometry]
    instances = [(np.asarray(T, dtype=np.float64), scene.geometry[name]) for T, name in nodes]
    placed = [(T, mesh) for T, mesh in instances if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    if not placed:
        raise UserError(f"the model file {path} holds no triangles", "export it as a mesh")
    triangles = sum(len(mesh.faces) for _, mesh in placed)
    if triangles > MAX_TRIANGLES:
        raise UserError(
            f"the model file {path} has {triangles:,} triangles", f"reduce it to {MAX_TRIANGLES:,} or fewer"
        )
    is_gltf = path.suffix.lower() in (".glb", ".gltf")
    to_z_up = Z_UP_FROM_Y_UP if is_gltf else np.eye(4)
    try:
        parts = tuple(_part(mesh, to_z_up @ T, colours_are_linear=is_gltf) for T, mesh in placed)
        model = Model(path.stem, parts)
    except (ValueError, IndexError) as error:
        raise UserError(f"the model file {path} is malformed ({error})", "export it again") from error
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
        path = (self.folder / name.strip()).resolve()
        if not path.is_relative_to(self.folder):
            self.refused.append(name)
            raise FileNotFoundError(name)
        return path.read_bytes()

    def keys(self) -> list[str]:
        return [path.name for path in self.folder.iterdir()]

    def namespaced(self, namespace: str) -> "_FolderResolver":
        return self if not namespace else _FolderResolver(self.folder / namespace)

    def write(self, name: str, data: bytes) -> None:
        raise NotImplementedError(f"a model is only read: {name}, {len(data)} bytes")


def _read_scene(path: Path) -> Any:
    if path.suffix.lower() not in SUFFIXES:
        raise UserError(f"{path} is not a kind of model file known here", f"give one of {', '.join(SUFFIXES)}")
    resolver = _FolderResolver(path.parent)
    scene, problem = None, None
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise UserError(f"the model file {path} is too large", f"reduce it to {MAX_FILE_BYTES // 1_000_000} MB")
        with path.open("rb") as file:
            file_type = path.suffix.lower()[1:]
            # process=True would merge vertices and thereby average normals that the file keeps apart.
            scene = trimesh.load_scene(file, file_type=file_type, resolver=resolver, process=False)
    except UserError:
        raise
    except Exception as error:  # a third-party parser of untrusted files raises whatever it stumbles over
        problem = error
    # trimesh leaves out a texture that it cannot get, but fails without a buffer.
    if resolver.refused:
        raise UserError(
            f"the model file {path} names {resolver.refused[0]}, outside its own folder", "put what it needs beside it"
        )
    if isinstance(problem, OSError):
        raise UserError(f"cannot read the model file {path}", problem.strerror or str(problem)) from problem
    if problem is not None:
        detail = f"{type(problem).__name__}: {problem}".splitlines()[0][:120]
        raise UserError(f"the model file {path} is malformed ({detail})", "export it again") from problem
    return scene


def _part(mesh: Any, T: Float, colours_are_linear: bool) -> Mesh:
    """One geometry of the file, moved by T (4, 4) into the model's frame."""
    vertices = (np.asarray(mesh.vertices, dtype=np.float64) @ T[:3, :3].T + T[:3, 3]).astype(np.float32)
    triangles = np.asarray(mesh.faces).astype(np.uint32)
    if len(vertices) <= triangles.max():
        raise ValueError(f"a triangle names vertex {triangles.max()} of {len(vertices)}")
    if np.linalg.det(T[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    attributes = _attributes(mesh, colours_are_linear)
    # trimesh computes normals when asked; only its cache tells whether the file brought them.
    if "vertex_normals" in mesh._cache.cache and mesh.vertex_normals.shape == vertices.shape:
        file_normals = np.asarray(mesh.vertex_normals, dtype=np.float64) @ np.linalg.inv(T[:3, :3])
        normals = unit_rows(file_normals).astype(np.float32)
        triangles = _wound_like_normals(vertices, triangles, normals)
    else:
        normals = corner_normals(vertices, triangles)
        corners = triangles.ravel()
        vertices, triangles = vertices[corners], np.arange(corners.size, dtype=np.uint32).reshape(-1, 3)
        attributes = {name: values[corners] for name, values in attributes.items()}
    base_colour, base_texture = _material(mesh)
    if "uvs" not in attributes:
        base_texture = None
    return Mesh(
        vertices=vertices,
        normals=normals,
        triangles=triangles,
        uvs=attributes.get("uvs"),
        colours=attributes.get("colours"),
        base_colour=base_colour,
        base_texture=base_texture,
        double_sided=_is_double_sided(mesh),
    )


def _wound_like_normals(vertices: Float32, triangles: Indices, normals: Float32) -> Indices:
    """Triangles turned so that they run counter-clockwise seen from where their normals point."""
    against = np.einsum("ij,ij->i", face_normals(vertices, triangles), normals[triangles].sum(axis=1)) < 0
    return np.where(against[:, None], triangles[:, ::-1], triangles)


def _attributes(mesh: Any, colours_are_linear: bool) -> dict[str, Float32]:
    """What the file says of each vertex beyond its place."""
    found: dict[str, Float32] = {}
    visual = mesh.visual
    uvs = getattr(visual, "uv", None)
    if uvs is not None and len(uvs) == len(mesh.vertices):
        found["uvs"] = np.asarray(uvs, dtype=np.float32)
    if visual.kind in ("vertex", "face"):
        encoded = np.asarray(visual.vertex_colors, dtype=np.float64) / 255
        rgb = encoded[:, :3] if colours_are_linear else linear_from_srgb(encoded[:, :3])
        found["colours"] = np.column_stack([rgb, encoded[:, 3]]).astype(np.float32)
    return found


def _material(mesh: Any) -> tuple[LinearRGBA, Image | None]:
    material = getattr(mesh.visual, "material", None)
    if isinstance(material, trimesh.visual.material.PBRMaterial):
        factor = material.baseColorFactor
        rgba = WHITE if factor is None else tuple(np.asarray(factor, dtype=np.float64) / 255)
        picture = material.baseColorTexture
    elif isinstance(material, trimesh.visual.material.SimpleMaterial):
        picture = material.image
        diffuse = np.asarray(material.diffuse, dtype=np.float64) / 255
        # OBJ exporters write an arbitrary grey beside a texture.
        rgba = WHITE if picture is not None else (*linear_from_srgb(diffuse[:3]), diffuse[3])
    else:
        return WHITE, None
    red, green, blue, alpha = (float(value) for value in rgba)
    return (red, green, blue, alpha), None if picture is None else _texture(picture)


def _is_double_sided(mesh: Any) -> bool:
    """What glTF says, whose default is no; the other formats cannot say, and many of their files have holes."""
    material = getattr(mesh.visual, "material", None)
    return bool(material.doubleSided) if isinstance(material, trimesh.visual.material.PBRMaterial) else True


def _texture(picture: PillowImage.Image) -> Image:
    """(h, w, 4) uint8 sRGB, no side longer than MAX_TEXTURE_PX."""
    reduced = picture.convert("RGBA")
    reduced.thumbnail((MAX_TEXTURE_PX, MAX_TEXTURE_PX), PillowImage.Resampling.LANCZOS)
    return np.asarray(reduced, dtype=np.uint8)
