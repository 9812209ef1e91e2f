"""Which way a file's model stands: said, or guessed from the format and the shape."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.models.assembly.geometry import RawMesh

UPS = ("y", "z", "x", "-y", "-z", "-x")
Y_UP, Z_UP = UPS[:2]
# Log odds of y over z. Programs write OBJ with y up unless asked otherwise; STL is for printers, whose bed is z = 0;
# PLY comes from scanners of both kinds.
OF_FORMAT = {".obj": 1.5, ".ply": 0.3, ".stl": -1.5}
STANDS_ON_ZERO = 1.5  # the lowest point is at 0, as modellers put it
MOST_OF_BASE = 1.5  # how broad a base the model has either way
NEAR = 0.02  # of the extent
LEVEL = 0.99  # of a base's normals, along up
LEAST_BASE = 0.02  # of the box's floor: less may be an accident
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
    odds = OF_FORMAT[suffix]
    corners, step = _corners(meshes)
    if len(corners) and np.isfinite(corners).all():
        lower, upper = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        extents = np.maximum(upper - lower, 1e-9 * (upper - lower).max() + 1e-30)
        on_zero = np.abs(lower) < NEAR * extents
        odds += STANDS_ON_ZERO * (float(on_zero[1]) - float(on_zero[2]))
        of_y, of_z = (LEAST_BASE + _base(corners, step, axis, lower, extents) for axis in (1, 2))
        odds += min(max(math.log(of_y / of_z), -MOST_OF_BASE), MOST_OF_BASE)
    return Y_UP if odds > 0 else Z_UP


def _corners(meshes: Sequence[RawMesh]) -> tuple[Float, int]:
    """(m, 3, 3) of triangles from everywhere on the model, and of how many each is one."""
    total = sum(len(mesh.triangles) for mesh in meshes)
    step = -(-total // MOST_TRIANGLES) if total else 1
    some = [mesh.vertices[mesh.triangles[::step]] for mesh in meshes if _is_whole(mesh)]
    return (np.concatenate(some).astype(np.float64) if some else np.empty((0, 3, 3))), step


def _is_whole(mesh: RawMesh) -> bool:
    """What names vertices that are not there is refused later."""
    return bool(len(mesh.triangles) and mesh.triangles.min() >= 0 and mesh.triangles.max() < len(mesh.vertices))


def _base(corners: Float, step: int, axis: int, lower: Float, extents: Float) -> float:
    """The share of the box's floor that level triangles cover, were that axis up."""
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    sizes = np.linalg.norm(areas, axis=1)
    is_low = (corners[:, :, axis] < lower[axis] + NEAR * extents[axis]).all(axis=1)
    is_base = is_low & (np.abs(areas[:, axis]) > LEVEL * sizes)
    floor = np.prod(np.delete(extents, axis))
    return min(1.0, step * float(np.abs(areas[is_base, axis]).sum() / floor))
