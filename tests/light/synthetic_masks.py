"""Masks of simple bodies and of their shadows by plain projective geometry, independent of what is under test."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import direction_from_angles, rigid

SUPERSAMPLING = 4
Parts = list[Float]  # convex parts, each (n, 3) points in the marker frame, metres


def direction(azimuth_deg: float, elevation_deg: float) -> Float:
    return direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))


def camera_towards(target: tuple[float, float], distance: float, pitch_deg: float, heading_deg: float = 90.0) -> Float:
    """T_cam_marker of a camera that looks down at `pitch_deg` along `heading_deg` (from x towards y)."""
    forward = direction(heading_deg, -pitch_deg)
    right = direction(heading_deg - 90.0, 0.0)
    R = np.array([right, np.cross(forward, right), forward])
    eye = np.array([*target, 0.0]) - distance * forward
    return rigid(R, -R @ eye)


IMPOSSIBLE_POSES = {
    "below the ground": camera_towards((0.0, 0.0), 0.5, -20.0),
    "in the ground": camera_towards((0.0, 0.0), 0.5, 0.0),
    "looking away": camera_towards((0.0, 0.0), -0.5, 40.0),
    "in the marker": camera_towards((0.0, 0.0), 1e-6, 40.0),
    "a mile away": camera_towards((0.0, 0.0), 1600.0, 40.0),
}


def box(x: float, y: float, size: tuple[float, float, float], yaw_deg: float = 0.0) -> Parts:
    yaw, (length, depth, height) = math.radians(yaw_deg), size
    corners = []
    for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        a, b = u * length / 2, v * depth / 2
        corners.append((x + a * math.cos(yaw) - b * math.sin(yaw), y + a * math.sin(yaw) + b * math.cos(yaw)))
    return [np.array([(*corner, z) for z in (0.0, height) for corner in corners])]


def turned(x: float, y: float, profile: list[tuple[float, float]]) -> Parts:
    """A body of revolution from (radius, z) pairs."""
    angles = np.arange(180) * (2 * math.pi / 180)
    rings = [np.column_stack([x + r * np.cos(angles), y + r * np.sin(angles), np.full(180, z)]) for r, z in profile]
    return [np.concatenate(rings)]


def ball(x: float, y: float, radius: float) -> Parts:
    tilts = np.linspace(-math.pi / 2, math.pi / 2, 31)
    return turned(x, y, [(radius * math.cos(t), radius + radius * math.sin(t)) for t in tilts])


def ell(x: float, y: float, yaw_deg: float) -> Parts:
    yaw = math.radians(yaw_deg)
    aside = 0.045
    low = (x + aside * math.cos(yaw), y + aside * math.sin(yaw))
    return [*box(x, y, (0.03, 0.05, 0.09), yaw_deg), *box(*low, (0.06, 0.05, 0.03), yaw_deg)]


@dataclass(frozen=True)
class MaskedScene:
    camera: Camera
    T_cam_marker: Float
    body: Mask
    shadows: list[Mask]


def render(parts: Parts, lights: list[Float], T_cam_marker: Float, size: tuple[int, int] = (640, 480)) -> MaskedScene:
    """lights: directions (3,) or homogeneous points (4,)."""
    camera = Camera.from_hfov(size, 60.0)
    body = _filled(camera, T_cam_marker, parts)
    shadows = []
    for light in lights:
        x, y, z, w = light if len(light) == 4 else (*light, 0.0)
        flat = [(part - part[:, 2:] * np.array([x, y, z]) / z) / (1 - part[:, 2:] * w / z) for part in parts]
        shadows.append(_filled(camera, T_cam_marker, flat) & ~body)
    return MaskedScene(camera, T_cam_marker, body, shadows)


def _filled(camera: Camera, T_cam_marker: Float, parts: Parts) -> Mask:
    """The union of the parts' hulls, cut in the camera's near plane, drawn at four times the size and averaged."""
    width, height = camera.size
    fine: NDArray[np.uint8] = np.zeros((height * SUPERSAMPLING, width * SUPERSAMPLING), dtype=np.uint8)
    for part in parts:
        points = part @ T_cam_marker[:3, :3].T + T_cam_marker[:3, 3]
        pixels = _before_camera(points) @ camera.K.T
        pixels = (pixels[:, :2] / pixels[:, 2:] + 0.5) * SUPERSAMPLING - 0.5
        hull = cv2.convexHull(np.clip(pixels, -30000, 30000).astype(np.float32))
        cv2.fillConvexPoly(fine, np.rint(hull * 16).astype(np.int32), 1, shift=4)
    coarse = fine.reshape(height, SUPERSAMPLING, width, SUPERSAMPLING).mean(axis=(1, 3))
    return np.asarray(coarse > 0.5)


def _before_camera(points: Float, near: float = 0.1) -> Float:
    """A convex body's points before the near plane, with those where lines between its points pass it."""
    before, behind = points[points[:, 2] >= near], points[points[:, 2] < near]
    if not len(behind):
        return points
    a, b = before[:, None], behind[None]
    share = (a[..., 2:] - near) / (a[..., 2:] - b[..., 2:])
    return np.concatenate([before, (a + share * (b - a)).reshape(-1, 3)])
