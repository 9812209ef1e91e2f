"""Triangle meshes as the renderer takes them: immutable arrays, z up, colours in linear light."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, frozen_view, set_frozen
from ashe_live.models.material import Material

Float32 = NDArray[np.float32]
Indices = NDArray[np.uint32]
PLAIN = Material()
# Steps of the plastic number's sequence in two dimensions, which fills a square evenly (Roberts 2018).
STEP_U, STEP_V = 0.7548776662, 0.5698402910


def face_normals(vertices: Float32, triangles: Indices) -> Float:
    """(m, 3) normals of twice the triangles' area in length, right-handed."""
    a, b, c = np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)
    return np.asarray(np.cross(b - a, c - a))


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Poses of a mesh, evenly spaced in time; after the last comes the first."""

    vertices: Float32  # (k, n, 3) metres, z up
    normals: Float32  # (k, n, 3) unit
    duration_s: float  # from the first pose to the last

    def __post_init__(self) -> None:
        shape = self.vertices.shape
        if len(shape) != 3 or shape[0] < 2 or shape[2] != 3:
            raise ValueError(f"poses have shape {shape}, not (two or more, vertices, 3)")
        if not 0 < self.duration_s < np.inf:
            raise ValueError(f"a motion cannot last {self.duration_s} s")
        set_frozen(
            self,
            vertices=_checked(self.vertices, np.float32, shape, "vertices of poses"),
            normals=_checked_normals(self.normals, shape, "normals of poses"),
        )

    def at(self, time_s: float) -> tuple[Float32, Float32]:
        """(n, 3) vertices and normals, these not quite of unit length, at a time since it began; it is looped."""
        last = len(self.vertices) - 1
        at = time_s % self.duration_s / self.duration_s * last
        before = min(int(at), last - 1)
        share = np.float32(at - before)
        vertices, normals = (
            (1 - share) * poses[before] + share * poses[before + 1] for poses in (self.vertices, self.normals)
        )
        return vertices, normals


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles of one material, counter-clockwise seen from the side that their normals point to."""

    vertices: Float32  # (n, 3) metres, z up
    normals: Float32  # (n, 3) unit
    triangles: Indices  # (m, 3) indices of vertices
    uvs: Float32 | None = None  # (n, 2) texture coordinates, origin at the picture's bottom left
    colours: Float32 | None = None  # (n, 4) linear RGBA, a factor
    material: Material = PLAIN
    more_uvs: Float32 | None = None  # (n, 2) a second set of texture coordinates, for the maps that are laid out by it
    motion: Motion | None = None  # of the same vertices; None: it stands still
    # Closed, single-sided and seen from within alone, as a hull or a room: light comes in as sight does.
    faces_inwards: bool = False

    def __post_init__(self) -> None:
        count = len(self.vertices)
        set_frozen(
            self,
            vertices=_checked(self.vertices, np.float32, (count, 3), "vertices"),
            normals=_checked_normals(self.normals, (count, 3), "normals"),
            triangles=_checked(self.triangles, np.uint32, (len(self.triangles), 3), "triangles"),
        )
        for name, width in (("uvs", 2), ("more_uvs", 2), ("colours", 4)):
            if (values := getattr(self, name)) is not None:
                set_frozen(self, **{name: _checked(values, np.float32, (count, width), name)})
        if self.motion is not None and self.motion.vertices.shape[1] != count:
            raise ValueError(f"poses are of {self.motion.vertices.shape[1]} vertices, not of {count}")
        if sum(uvs is not None for uvs in (self.uvs, self.more_uvs)) < self.material.uv_sets:
            raise ValueError("a material with maps on a mesh without texture coordinates")
        if len(self.triangles) == 0:
            raise ValueError("a mesh without triangles")
        if int(self.triangles.max()) >= count:
            raise ValueError(f"a triangle names vertex {self.triangles.max()} of {count}")

    def moved(self, scale: float, offset: Float) -> "Mesh":
        """The same mesh with vertices `scale * v + offset`."""
        motion = self.motion
        if motion is not None:
            places = motion.vertices * np.float32(scale) + offset.astype(np.float32)
            motion = replace(motion, vertices=places)
        return replace(self, vertices=(self.vertices * scale + offset).astype(np.float32), motion=motion)

    @property
    def greatest_opacity(self) -> float:
        """What no place exceeds if the material is not opaque: by the most opaque texel and the most opaque vertex."""
        opacity = self.material.base_colour[3]
        if self.material.base_map is not None:
            opacity *= float(self.material.base_map[..., 3].max()) / 255
        if self.colours is not None:
            opacity *= float(self.colours[:, 3].max())
        return opacity

    @property
    def areas(self) -> Float:
        """(m,) of the triangles, square metres, at rest."""
        return np.asarray(np.linalg.norm(face_normals(self.vertices, self.triangles), axis=1) / 2)

    @property
    def bounds(self) -> Float:
        """(2, 3) smallest and largest coordinates, in all of its poses."""
        places = self.vertices if self.motion is None else self.motion.vertices.reshape(-1, 3)
        return np.array([places.min(axis=0), places.max(axis=0)], dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A model that a person chooses by name: one or more meshes in one frame, z up."""

    name: str
    parts: tuple[Mesh, ...]  # at least one
    notes: tuple[str, ...] = ()  # what is drawn otherwise than the file says, each a part of a sentence about the model
    up: str = "z"  # which axis of the file is up here: one of UPS (models/assembly/up.py)
    is_up_guessed: bool = False  # nobody has said so
    read_beside: tuple[Path, ...] = ()  # the files that its file names, as pictures and libraries of materials

    def __post_init__(self) -> None:
        if not self.parts:
            raise ValueError("a model without parts")

    @property
    def triangle_count(self) -> int:
        return sum(len(part.triangles) for part in self.parts)

    @property
    def duration_s(self) -> float:
        """Duration of its motion, which is looped; 0 if it stands still."""
        return max(0.0 if part.motion is None else part.motion.duration_s for part in self.parts)

    @property
    def bounds(self) -> Float:
        """(2, 3) smallest and largest coordinates, in metres, in all of its poses."""
        lower, upper = zip(*(part.bounds for part in self.parts), strict=True)
        return np.array([np.min(lower, axis=0), np.max(upper, axis=0)])


def spread_over_triangle(numbers: NDArray[Any]) -> Float:
    """(n, 3) barycentric coordinates of the points with these `numbers` (n,) in a sequence that fills it evenly."""
    u, v = (1 / 3 + numbers * STEP_U) % 1.0, (1 / 3 + numbers * STEP_V) % 1.0
    is_beyond = u + v > 1  # in the other half of the square
    u, v = np.where(is_beyond, 1 - u, u), np.where(is_beyond, 1 - v, v)
    return np.column_stack([1 - u - v, u, v])


def _checked(array: NDArray[Any], dtype: type, shape: tuple[int, ...], name: str) -> NDArray[Any]:
    values: NDArray[Any] = np.ascontiguousarray(array, dtype=dtype)
    if values.shape != shape:
        raise ValueError(f"{name} has shape {values.shape}, not {shape}")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} holds a value that is not finite")
    return frozen_view(values)


def _checked_normals(array: NDArray[Any], shape: tuple[int, ...], name: str) -> NDArray[Any]:
    normals = _checked(array, np.float32, shape, name)
    if not normals.any(axis=-1).all():
        raise ValueError(f"{name} holds one of length zero, which has no direction")
    return normals
