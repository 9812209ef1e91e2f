"""Directions, poses, projections and shadows of points (NumPy alone)."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def direction(azimuth_deg: float, elevation_deg: float) -> Floats:
    """Unit vector, azimuth from +x towards +y, elevation from the ground."""
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def look_at(
    target: Any, azimuth_deg: float, pitch_deg: float, distance: float, roll_deg: float
) -> tuple[Floats, Floats]:
    """R (3, 3) and t (3,) with X_cam = R @ X_marker + t of a camera that looks down at `target` by `pitch_deg`."""
    forward = -direction(azimuth_deg, pitch_deg)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    c, s = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
    R = np.stack([c * right + s * down, c * down - s * right, forward])
    return R, -R @ (np.asarray(target, float) - distance * forward)


def intrinsics(size: Any, hfov_deg: float) -> Floats:
    """(3, 3) with pixel centres at integers and the principal point in the middle."""
    f = size[0] / 2 / math.tan(math.radians(hfov_deg) / 2)
    return np.array([[f, 0, (size[0] - 1) / 2], [0, f, (size[1] - 1) / 2], [0, 0, 1]])


def projected(camera: dict[str, Any], points: Any) -> tuple[Floats, Floats]:
    """(n, 2) pixels and (n,) depths of points in the marker's frame; behind the camera the pixels mean nothing."""
    seen = np.atleast_2d(points) @ np.asarray(camera["R"]).T + np.asarray(camera["t"])
    K = np.asarray(camera["K"])
    depth = np.where(np.abs(seen[:, 2]) < 1e-9, 1e-9, seen[:, 2])
    return seen[:, :2] / depth[:, None] * [K[0, 0], K[1, 1]] + K[:2, 2], seen[:, 2]


def square(side: float, z: float = 0.0) -> Floats:
    """(4, 3) corners in the detector's order: top-left, top-right, bottom-right, bottom-left as printed."""
    h = side / 2
    return np.array([(-h, h, z), (h, h, z), (h, -h, z), (-h, -h, z)])


def share_in_frame(camera: dict[str, Any], points: Any, size: Any, margin: float = 0.0) -> float:
    pixels, depth = projected(camera, points)
    inside = (pixels >= margin).all(axis=1) & (pixels <= np.asarray(size) - 1 - margin).all(axis=1) & (depth > 0)
    return float(inside.mean())


def cast(points: Any, light: dict[str, Any], ground_z: float) -> Floats:
    """(n, 3) where the shadows of points fall on the ground; points must lie below a lamp."""
    points = np.asarray(points, float)
    high = points[:, 2:] - ground_z
    if light.get("position_m") is not None:
        lamp = np.asarray(light["position_m"], float)
        return lamp + (points - lamp) * ((lamp[2] - ground_z) / np.maximum(lamp[2] - points[:, 2:], 1e-4))
    d = direction(light["azimuth_deg"], light["elevation_deg"])
    return points - d * (high / d[2])
