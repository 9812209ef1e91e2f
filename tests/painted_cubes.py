"""Cubes painted by the bench's painter, as seen and lit from given directions."""

import math

import numpy as np

from ashe_live.bench.cube.painter import CubeScene, Folds, PaintedLight, painted
from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import direction_from_angles
from ashe_live.core.types import Frame

__all__ = ["CAMERA", "EDGE_M", "CubeScene", "Folds", "PaintedLight", "frame_of", "looking", "painted", "sun"]

CAMERA = Camera.from_hfov((640, 480), 60)
EDGE_M = 0.06


def looking(distance_m: float, tilt_deg: float, azimuth_deg: float, aim_m: Float | None = None) -> Float:
    """(4, 4) T_cam_cube of a camera held upright, `tilt_deg` away from straight above; not straight above itself."""
    aim = np.array((0.0, 0.0, 0.02)) if aim_m is None else aim_m
    from_aim = direction_from_angles(math.radians(azimuth_deg), math.radians(90 - tilt_deg))
    right = np.cross(-from_aim, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = right, np.cross(-from_aim, right), -from_aim
    T[:3, 3] = -T[:3, :3] @ (aim + distance_m * from_aim)
    return T


def sun(azimuth_deg: float, elevation_deg: float, on_table: float = 0.7, size_deg: float = 0.53) -> PaintedLight:
    """Slightly yellow; `on_table` is what it gives the open table, over pi."""
    to_light = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
    across = np.array((1.0, 0.95, 0.88)) * on_table / to_light[2]
    return PaintedLight(np.append(to_light, 0.0), across, math.radians(size_deg))


def frame_of(scene: CubeScene, index: int = 0) -> Frame:
    return Frame(painted(scene), index, index / 30)
