"""The marker's plane as a picture shows it, seen from straight above, and the real object's shade on it."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import FRACTION_BITS, Float, Float32, Image, Mask, fixed_point
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import transform_points
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.lights.cast_shadows import shadow_hull_of_point
from ashe_live.render.lights.lighting import measured_ratio

BORDER_SIDES = 0.115  # of the marker: ground that close to the real shadow's border is neither lit nor shaded
SOFT_PX = 0.8  # standard deviation of that border
LEAST_RATIO = 0.02  # of the light that a shadow may leave
BESIDE_PX = 5  # of the object, in the picture: whose rim is no ground


@dataclass(frozen=True, slots=True, eq=False)
class Rectified:
    """A square of the plane around the marker's centre; first row at the largest y."""

    linear: Float32  # (n, n, 3) RGB
    is_seen: Mask  # (n, n) in the picture, and not behind the real object
    shade: Float32  # (n, n, 3) fraction of the light that the real object's shadows leave
    border: Mask  # (n, n) too near to such a shadow's border to tell


def rectified(tracked: TrackedFrame, illumination: Illumination, half_m: float, size: int) -> Rectified:
    """From -half_m to half_m in x and y, `size` pixels a side. The frame must have a marker."""
    T_cam_marker, picture = tracked.pose.T_cam_marker, tracked.frame.image_bgr
    at = _pixels(tracked.camera, T_cam_marker, half_m, size)
    width, height = tracked.frame.size
    is_seen = np.asarray(((at > 1) & (at < (width - 2, height - 2))).all(axis=2))
    image = cv2.remap(picture, at[..., 0], at[..., 1], cv2.INTER_CUBIC)
    linear = LINEAR_FROM_SRGB_8BIT[image[..., ::-1]].astype(np.float32)
    shade, border = np.ones_like(linear), np.zeros(is_seen.shape, np.uint8)
    body = tracked.pose.body or illumination.real_object
    if body is not None:
        hidden = _silhouette(body, tracked.camera, T_cam_marker)
        is_seen &= cv2.remap(hidden, at[..., 0], at[..., 1], cv2.INTER_NEAREST) == 0
        for light in illumination.lights:
            ratio = measured_ratio(light)
            if ratio is None or light.to_light_marker[2] <= 0:
                continue
            dark = _shadow(body, light, half_m, size)
            soft = (cv2.GaussianBlur(dark, (0, 0), SOFT_PX) / 255.0)[..., None]
            shade *= (1 - soft * (1 - np.clip(ratio, LEAST_RATIO, 1))).astype(np.float32)
            border |= np.asarray(cv2.morphologyEx(dark, cv2.MORPH_GRADIENT, np.ones((3, 3))), np.uint8)
        side_px = tracked.pose.side_m / (2 * half_m) * size
        border = np.asarray(cv2.dilate(border, np.ones((2 * round(BORDER_SIDES * side_px) + 1,) * 2)), np.uint8)
    return Rectified(linear, is_seen, shade, border > 0)


def _pixels(camera: Camera, T_cam_marker: Float, half_m: float, size: int) -> Float32:
    """(n, n, 2) the picture's pixel of each of the square's; outside of it for what is not in front of the camera."""
    steps = ((np.arange(size) + 0.5) / size * 2 - 1) * half_m
    x, y = np.meshgrid(steps, -steps)
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    ahead = transform_points(T_cam_marker, points)[:, 2] > 1e-3 * half_m
    pixels = np.full((len(points), 2), -10.0)
    pixels[ahead] = project_distorted(camera, T_cam_marker, points[ahead])
    return pixels.reshape(size, size, 2).astype(np.float32)


def _silhouette(body: Proxy, camera: Camera, T_cam_marker: Float) -> Image:
    """(h, w) 1 where the body, or its rim, is in the picture; nothing where some of it is behind the camera."""
    width, height = camera.size
    silhouette = np.zeros((height, width), np.uint8)
    pixels = project_distorted(camera, T_cam_marker, body.surface()[0])
    if np.isfinite(pixels).all():
        outline = cv2.convexHull(pixels.astype(np.float32))
        cv2.fillConvexPoly(silhouette, np.round(outline).astype(np.int32), 1)
    return np.asarray(cv2.dilate(silhouette, np.ones((BESIDE_PX, BESIDE_PX))), np.uint8)


def _shadow(body: Proxy, light: Light, half_m: float, size: int) -> Image:
    """(n, n) 255 where the body's shadow lies: from the middle of its penumbra inwards."""
    outline = in_square(shadow_hull_of_point(body.surface()[0], light.homogeneous), half_m, size)
    shadow = np.zeros((size, size), np.uint8)
    return np.asarray(cv2.fillConvexPoly(shadow, outline, 255, cv2.LINE_AA, FRACTION_BITS), np.uint8)


def in_square(corners: Float, half_m: float, size: int) -> NDArray[np.int32]:
    """(n, 2) in 2 ** -FRACTION_BITS pixels of the square: a polygon's corners (n, 2) on the plane, metres."""
    pixels = (corners * (1, -1) / half_m + 1) * (size / 2) - 0.5
    return fixed_point(pixels.clip(-4 * size, 5 * size))
