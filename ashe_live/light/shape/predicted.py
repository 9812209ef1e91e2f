"""Where a fitted body and its shadow are seen, and what remains unexplained by them."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.light.pixels.view import View

AROUND = 32  # points on a body's rings: of 16, the chords lie 2 % of a radius within, which an alignment notices
FARTHEST_PX = 1e5
NEAREST_SHARE = 0.1  # of the marker's distance: what is nearer to the camera's plane is cut off
SUBPIXEL_BITS = 4
LOWEST_Z = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Predicted:
    """What a body in a light would look like."""

    body: Mask  # (h, w)
    shadow: Mask  # (h, w) on the ground, as far as the body does not hide it
    parts: tuple[Mask, ...] = ()  # (h, w) each light's shadow, where there are several

    @property
    def whole(self) -> Mask:
        return self.body | self.shadow


def predicted(proxy: Proxy, to_lights_marker: Sequence[Float], view: View) -> Predicted:
    """The silhouettes in `view` of a convex body and of its shadows on the marker plane."""
    return painted(outlines(proxy, to_lights_marker, view), view.is_ground.shape)


def outlines(proxy: Proxy, to_lights_marker: Sequence[Float], view: View) -> list[Float | None]:
    """(m, 2) pixels each: the outline of a convex body, and of its shadow in each light; None of what is not seen."""
    points = proxy.points_marker(AROUND)
    shadows = [shadow_outline(view.camera, view.T_cam_marker, points, to_light) for to_light in to_lights_marker]
    return [outline(view.camera, view.T_cam_marker, points), *shadows]


def painted(hulls_px: Sequence[Float | None], shape: tuple[int, ...]) -> Predicted:
    """What lies within the outlines of a body and of its shadows."""
    body, *shadows = (_filled(hull, shape) for hull in hulls_px)
    shadows = [shadow & ~body for shadow in shadows]
    shadow = np.logical_or.reduce([np.zeros_like(body), *shadows])
    return Predicted(body, shadow, tuple(shadows) if len(shadows) > 1 else ())


def outline(camera: Camera, T_cam_marker: Float, points_marker: Float) -> Float | None:
    """(m, 2) pixels: the hull of what lies before the camera of the hull of points (n, 3); None where nothing does."""
    points = _before_camera(points_marker, T_cam_marker)
    pixels = project(camera, T_cam_marker, points) if len(points) else np.empty((0, 2))
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    if len(pixels) < 3:
        return None
    hull = cv2.convexHull(np.clip(pixels, -FARTHEST_PX, FARTHEST_PX).astype(np.float32))
    return np.asarray(hull[:, 0], dtype=np.float64)


def shadow_outline(camera: Camera, T_cam_marker: Float, points_marker: Float, to_light_marker: Float) -> Float | None:
    """(m, 2) pixels: the outline of the points' shadow on the marker plane; None in a light from below or along it."""
    if to_light_marker[2] <= LOWEST_Z:
        return None
    cast = points_marker - points_marker[:, 2:] * (to_light_marker / to_light_marker[2])
    return outline(camera, T_cam_marker, cast)


def _filled(hull_px: Float | None, shape: tuple[int, ...]) -> Mask:
    mask = np.zeros(shape, np.uint8)
    if hull_px is not None:
        cv2.fillConvexPoly(mask, np.round(hull_px * 2**SUBPIXEL_BITS).astype(np.int32), 1, shift=SUBPIXEL_BITS)
    return mask.astype(bool)


def _before_camera(points_marker: Float, T_cam_marker: Float) -> Float:
    """(m, 3) points whose hull is the part of the points' hull that lies before the camera."""
    depth = points_marker @ T_cam_marker[2, :3] + T_cam_marker[2, 3]
    nearest = NEAREST_SHARE * float(np.linalg.norm(T_cam_marker[:3, 3]))
    before = depth > nearest
    if before.all() or not before.any():
        return np.asarray(points_marker[before])
    front, back = points_marker[before][:, None], points_marker[~before][None]
    way = (nearest - depth[before][:, None]) / (depth[~before][None] - depth[before][:, None])
    return np.concatenate([points_marker[before], (front + way[..., None] * (back - front)).reshape(-1, 3)])
