"""Pieces of meshes: bodies of revolution, boxes, ellipsoids, swept tubes (NumPy alone; metres, z up)."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from mesh_grids import grid_faces, tube
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
Params = dict[str, Any]
TURNS = 56


@dataclass(frozen=True)
class Part:
    """A piece of an object in one material."""

    points: Floats  # (n, 3)
    faces: Faces  # (m, 3)
    slot: int = 0  # 0: the object's material, 1: its second, 2: dark holes, 3: leaves
    smooth: bool = True
    bevel_m: float = 0.0  # edges are rounded by this much when rendered


def moved(part: Part, offset: Any, yaw_deg: float = 0.0) -> Part:
    """Turned about z, then moved."""
    return Part(turned_z(part.points, yaw_deg) + np.asarray(offset, float), part.faces, part.slot, part.smooth,
                part.bevel_m)  # fmt: skip


def turned_z(points: Floats, yaw_deg: float) -> Floats:
    a = math.radians(yaw_deg)
    return points @ np.array([(math.cos(a), math.sin(a), 0), (-math.sin(a), math.cos(a), 0), (0, 0, 1)])


def revolved(profile: Any, slot: int = 0, turns: int = TURNS) -> Part:
    """A body of revolution about z from (radius, height) pairs."""
    profile = np.asarray(profile, float)
    angle = np.linspace(0, 2 * math.pi, turns + 1)
    r, h = profile[:, :1], profile[:, 1:]
    points = np.stack([r * np.cos(angle), r * np.sin(angle), h + 0 * angle], -1).reshape(-1, 3)
    return Part(points, grid_faces(len(profile) - 1, turns)[:, ::-1], slot)


def box(size: Any, centre: Any = (0, 0, 0), slot: int = 0, bevel_m: float = 0.0, yaw_deg: float = 0.0) -> Part:
    """`centre` is that of its lower side."""
    x, y, z = np.asarray(size, float) / [2, 2, 1]
    points = np.array([(sx * x, sy * y, h) for h in (0, z) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    quads = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return moved(Part(points, faces, slot, False, bevel_m), centre, yaw_deg)


def ellipsoid(radii: Any, centre: Any, slot: int = 0, turns: int = 32) -> Part:
    angle = np.linspace(-math.pi / 2, math.pi / 2, 20)
    unit = revolved(np.column_stack([np.cos(angle), np.sin(angle)]), slot, turns)
    return Part(unit.points * np.asarray(radii, float) + np.asarray(centre, float), unit.faces, slot)


def cylinder(radius: float, height: float, centre: Any = (0, 0, 0), slot: int = 0, top: float | None = None) -> Part:
    top = radius if top is None else top
    part = revolved([(0, 0), (radius, 0), (top, height), (0, height)], slot)
    return Part(part.points + np.asarray(centre, float), part.faces, slot)


def swept(path: Any, radius: Any, slot: int = 0, sides: int = 12, flatten: float = 1.0) -> Part:
    points, faces = tube(np.asarray(path, float), radius, sides, flatten)
    return Part(points, faces, slot)


def vessel(below: float, above: float, height: float, wall: float, bulge: float = 0.0) -> list[tuple[float, float]]:
    """Profile of an open vessel with a wall."""
    up = np.linspace(0, 1, 9)
    outer = below + (above - below) * up + bulge * np.sin(math.pi * up)
    outside = [(0.0, 0.0), *((float(r), float(h * height)) for r, h in zip(outer, up, strict=True))]
    rim = [(above - wall / 2, height + wall / 2)]
    inside = [(max(float(r) - wall, 1e-3), float(max(h * height, 2 * wall))) for r, h in zip(outer, up, strict=True)]
    return [*outside, *rim, *inside[::-1], (0.0, 2 * wall)]
