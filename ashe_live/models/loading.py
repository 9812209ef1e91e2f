"""Reads glTF, GLB, OBJ, PLY and STL files; reads beside the file only, never from a network."""

import itertools
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.errors import UserError
from ashe_live.files.reading import opened, read_bytes
from ashe_live.models.assembly import invisible, overlaps
from ashe_live.models.assembly.geometry import RawMesh, placed_mesh, used_vertices
from ashe_live.models.assembly.merging import merged
from ashe_live.models.assembly.mirroring import words_on_mirrors
from ashe_live.models.assembly.up import Y_UP, guessed_up, z_up_from
from ashe_live.models.formats.obj import read_obj
from ashe_live.models.formats.ply import read_ply
from ashe_live.models.formats.stl import read_stl
from ashe_live.models.gltf.reader import read_gltf
from ashe_live.models.mesh import Model
from ashe_live.models.parsing.folder import Folder
from ashe_live.models.parsing.kinds import check_kind, in_utf8
from ashe_live.models.parsing.limits import MAX_FILE_BYTES, check_surfaces, check_text, check_triangles
from ashe_live.models.parsing.malformed import MalformedError
from ashe_live.models.parsing.notes import WITHOUT_COORDINATES, Notes

GLTF_SUFFIXES = (".glb", ".gltf")
SUFFIXES = (*GLTF_SUFFIXES, ".obj", ".ply", ".stl")
BROKEN_BODY = {
    **dict.fromkeys(GLTF_SUFFIXES, "its buffers do not hold what its accessors say"),
    ".obj": "a line is not OBJ, or a face refers to a vertex that is missing",
    ".ply": "it does not hold what its header says",
    ".stl": "it is neither text STL nor binary STL",
}

SPARE_BYTES = 1 << 20  # more than the allocator keeps of what was given back, and less than any library needs
# Farther from the origin, in extents of the model, single precision would tear it: 1e-7 of the distance are visible.
FAR = 1000.0


def load_model_file(path: Path, up: str | None = None) -> Model:
    """The model in `path`, its scene graph flattened, z up, in the file's unit.

    `up`: which axis of the file is (one of UPS); None: y for glTF, as it says, and for others a guess. A model that is
    far from its origin, as at a map's coordinates, is brought there. Raises UserError when the file is missing, too
    large, malformed or empty, or names a file that is missing or outside its folder; MemoryError where that is limited.
    """
    try:
        return _read(path, up)
    except (UserError, MemoryError):
        raise
    except ImportError as error:  # a parser is loaded when it is needed, and the memory's limit has no room for it
        raise MemoryError(str(error)) from error
    except Exception as error:  # a third-party parser of untrusted files raises anything, or its values do when used
        if _is_out_of_memory():
            raise MemoryError(str(error)) from error
        said = error if isinstance(error, MalformedError) else BROKEN_BODY[path.suffix.lower()]
        raise UserError(f"the model file {path} is malformed ({said})", "export it again") from error


def _is_out_of_memory() -> bool:
    """Whether nothing more is to be had, which libraries report by errors of their own too."""
    try:
        bytearray(SPARE_BYTES)
    except MemoryError:
        return True
    return False


def _read(path: Path, up: str | None) -> Model:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        opened(path, may_be_empty=True).close()  # of a folder, or what may not be read, that is said
        raise UserError(f"{path} is not a supported kind of model file", f"give one of {', '.join(SUFFIXES)}")
    content = read_bytes(path, MAX_FILE_BYTES)
    check_kind(path, content)
    folder, notes = Folder(path, MAX_FILE_BYTES), Notes()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # What Pillow and NumPy have to say about a damaged file is said by our errors.
        warnings.simplefilter("ignore")
        meshes: list[tuple[Float, RawMesh]]
        if suffix in GLTF_SUFFIXES:
            meshes = read_gltf(path, content, folder, notes)
            chosen = up or Y_UP
        else:
            content = in_utf8(content)
            check_text(path, content)
            read = {".obj": read_obj, ".ply": read_ply, ".stl": read_stl}[suffix]
            meshes = [(np.eye(4), mesh) for mesh in read(content, folder, notes)]
            chosen = up or guessed_up(suffix, [mesh for _, mesh in meshes])
        model = _model(path, [(z_up_from(chosen) @ T, mesh) for T, mesh in meshes], notes)
        is_guessed = up is None and suffix not in GLTF_SUFFIXES
        return replace(model, up=chosen, is_up_guessed=is_guessed, read_beside=tuple(folder.read))


def _model(path: Path, meshes: list[tuple[Float, RawMesh]], notes: Notes) -> Model:
    check_triangles(path, sum(len(mesh.triangles) for _, mesh in meshes))
    to_origin = np.eye(4)
    to_origin[:3, 3] = _offset([_extremes(T, mesh) for T, mesh in meshes if len(mesh.triangles)])
    parts = merged(part for T, mesh in meshes if (part := placed_mesh(mesh, to_origin @ T)) is not None)
    if not parts:
        triangles = "triangle that has an area" if any(len(mesh.triangles) for _, mesh in meshes) else "triangles"
        left_out = f": {'; '.join(notes.lines)}" if notes.lines else ""
        raise UserError(f"the model file {path} holds no {triangles}{left_out}", "export it as a mesh")
    check_surfaces(path, len(parts))
    if any(mesh.uvs is None and mesh.material.maps for _, mesh in meshes):
        notes.add(WITHOUT_COORDINATES)
    model = Model(path.stem, parts)
    lower, upper = model.bounds
    if not (np.isfinite(upper - lower).all() and (upper - lower).max() > 0):
        raise UserError(f"the model file {path} has no extent", "export a model that is larger than a point")
    if overlaps.overlap_visibly(parts):
        notes.add(overlaps.WORDS)
    if (words := words_on_mirrors(parts)) is not None:
        notes.add(words)
    before_all = (invisible.WORDS,) if invisible.nothing_is_seen(parts) else ()
    return replace(model, notes=(*before_all, *notes.lines))


def _extremes(T: Float, mesh: RawMesh) -> Float:
    """(2, 3) smallest and largest coordinates of the box around a mesh's triangles, where T (4, 4) brings it."""
    is_used = used_vertices(mesh)
    vertices = mesh.vertices if is_used.all() else mesh.vertices[is_used]
    of_file = [(column.min(), column.max()) for column in vertices.T]
    corners = np.array(list(itertools.product(*of_file))) @ T[:3, :3].T + T[:3, 3]
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def _offset(extremes: list[Float]) -> Float:
    """(3,) that brings what is far from the origin there; nothing for anything else."""
    if not extremes:
        return np.zeros(3)
    lower = np.min([least for least, _ in extremes], axis=0)
    upper = np.max([most for _, most in extremes], axis=0)
    centre = (lower + upper) / 2
    is_far = np.isfinite(centre).all() and np.abs(centre).max() > FAR * (upper - lower).max()
    return -centre if is_far else np.zeros(3)
