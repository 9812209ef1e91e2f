"""Which way a file's model stands: said, or guessed from the format and the shape."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float, unit_circle
from ashe_live.models.assembly.geometry import RawMesh

UPS = ("y", "z", "x", "-y", "-z", "-x")
Y_UP, Z_UP = UPS[:2]
# Log odds of y over z. Programs write OBJ with y up unless asked otherwise; STL is for printers, whose bed is z = 0;
# PLY comes from scanners of both kinds.
OF_FORMAT = {".obj": 1.5, ".ply": 0.3, ".stl": -1.5}
# Log odds for each of the features of `evidence`, in its order: assets/sources/odd_models/compare_up.py --fit, seed 1.
WEIGHTS = (2.3, 1.0, 4.7, 1.4)
NEAR = 0.02  # of the extent
LEVEL = 0.99  # of a base's normals, along up
LEAST_BASE = 0.02  # of the box's floor: less may be an accident
LEAST_UNEVEN = 0.05
DIRECTIONS = 32  # around the model, in which it may topple
MOST_TRIANGLES = 200_000  # that are looked at


def z_up_from(up: str) -> Float:
    """(4, 4) rotation from a file in which that axis is up."""
    axis = "xyz".index(up[-1])
    rotation = np.eye(4)
    if axis == 0:
        rotation[:3, :3] = ((0, 1, 0), (0, 0, 1), (1, 0, 0)) if up == "x" else ((0, 1, 0), (0, 0, -1), (-1, 0, 0))
    elif axis == 1:
        # The model then faces -y, towards a person who reads the marker.
        rotation[:3, :3] = ((1, 0, 0), (0, 0, -1), (0, 1, 0)) if up == "y" else ((1, 0, 0), (0, 0, 1), (0, -1, 0))
    elif up == "-z":
        rotation[:3, :3] = ((1, 0, 0), (0, -1, 0), (0, 0, -1))
    return rotation


def guessed_up(suffix: str, meshes: Sequence[RawMesh]) -> str:
    """Y_UP or Z_UP, for a file of that format whose meshes these are."""
    odds = OF_FORMAT[suffix] + float(evidence(meshes) @ WEIGHTS)
    return Y_UP if odds > 0 else Z_UP


def evidence(meshes: Sequence[RawMesh]) -> Float:
    """(4,) of how much more it speaks for y than for z being up; nothing where there is no shape.

    That the lowest point is at 0, as modellers put it; how broad a flat base the model stands on; by how far it would
    have to be tilted to topple; and how alike it is to all sides, as what is turned on a wheel or stands free.
    """
    corners, step = _corners(meshes)
    if not len(corners) or not np.isfinite(corners).all():
        return np.zeros(4)
    lower, upper = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    extents = np.maximum(upper - lower, 1e-9 * (upper - lower).max() + 1e-30)
    of_y, of_z = (_standing(corners, step, axis, lower, extents) for axis in (1, 2))
    return of_y - of_z


def _standing(corners: Float, step: int, axis: int, lower: Float, extents: Float) -> Float:
    """(4,) of the model with that axis up."""
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    sizes = np.linalg.norm(areas, axis=1)
    flat = [other for other in range(3) if other != axis]
    bottom = lower[axis] + NEAR * extents[axis]
    is_base = (corners[:, :, axis] <= bottom).all(axis=1) & (np.abs(areas[:, axis]) > LEVEL * sizes)
    base = min(1.0, step * float(np.abs(areas[is_base, axis]).sum() / np.prod(extents[flat])))
    middles, share = corners.mean(axis=1), sizes / max(float(sizes.sum()), 1e-300)
    centre = share @ middles
    points = corners.reshape(-1, 3)
    support = points[points[:, axis] <= bottom][:, flat]
    margin = float(((support - centre[flat]) @ unit_circle(DIRECTIONS).T).max(axis=0).min())
    topples = math.atan2(margin, max(float(centre[axis] - lower[axis]), 1e-30))
    spread = ((middles - centre)[:, flat] * share[:, None]).T @ (middles - centre)[:, flat]
    least, most = np.linalg.eigvalsh(spread)
    uneven = float((most - least) / max(most + least, 1e-300))
    on_zero = float(abs(lower[axis]) < NEAR * extents[axis])
    return np.array([on_zero, math.log(LEAST_BASE + base), topples, -math.log(LEAST_UNEVEN + uneven)])


def _corners(meshes: Sequence[RawMesh]) -> tuple[Float, int]:
    """(m, 3, 3) of triangles from everywhere on the model, and of how many each is one."""
    total = sum(len(mesh.triangles) for mesh in meshes)
    step = -(-total // MOST_TRIANGLES) if total else 1
    some = [mesh.vertices[mesh.triangles[::step]] for mesh in meshes if _is_whole(mesh)]
    return (np.concatenate(some).astype(np.float64) if some else np.empty((0, 3, 3))), step


def _is_whole(mesh: RawMesh) -> bool:
    """Whether all vertices that the triangles name exist; else the mesh is refused later."""
    return bool(len(mesh.triangles) and mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.vertices))
