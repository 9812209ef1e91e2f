"""How much softer the border of the real object's shadow is than lens and sun make it."""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import along_sides
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.edges import (
    AROUND,
    BOX_VARIANCE_PX2,
    REACH_PX,
    STEP_PX,
    across,
    blur_of_step_px,
    edge_blur_px,
    profile_at,
)
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.lighting import Sun

MOST_PX = 1.5  # in a picture 640 pixels wide
# How far from where the proxy casts it the border is looked for, over the picture's width: proxies are convex.
OUTLINE_ERROR = 0.02
FOUND_OVER_PX = 1.0  # standard deviation of the smoothing by which a border is told from noise
PLACES = np.linspace(0.15, 0.85, AROUND)  # along each of the outline's edges
LEAST_SINE = 0.1  # of a light's elevation, for how long its shadows are


def unexplained_border_px(tracked: TrackedFrame, proxy: Proxy, sun: Sun) -> float:
    """Standard deviation (px) by which the real shadow's border is softer than lens and sun make it; 0 if by none.

    A camera's sharpening makes the marker's strong edges steeper than the weak ones of shadows, its denoising makes
    those softer, and a sun of unknown size counts as a bare one.
    """
    assert tracked.marker is not None
    T = tracked.marker.T_cam_marker
    body = proxy.points_marker()
    cast = cast_by_point(body, sun.homogeneous)
    outline = cv2.convexHull(cast.astype(np.float32), returnPoints=False).ravel()
    ground = np.column_stack([cast[outline], np.zeros(len(outline))])
    if len(outline) < 3 or (ground @ T[2, :3] + T[2, 3]).min() <= 1e-3:
        return 0.0
    corners = project(tracked.camera, T, ground)
    points, outwards = along_sides(corners, PLACES)
    points, outwards = points.reshape(-1, 2), np.repeat(outwards, AROUND, axis=0)
    grey = np.asarray(cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    ratio = 1 - float(np.array(sun.ground_share) @ REC709_LUMINANCE)
    profile = profile_at(grey, _on_border(grey, points, outwards), outwards, REACH_PX, ratio)
    if profile is None:
        return 0.0
    penumbra = _penumbra_px(tracked.camera, T, _along(ground), _along(body[outline, 2:]), sun, outwards)
    explained = edge_blur_px(grey, tracked.marker.corners_px) ** 2 + np.square(penumbra[profile.used]).mean()
    # The shadow maps' own texels blur about as much as a pixel does.
    rest = blur_of_step_px(profile.step) ** 2 - explained - BOX_VARIANCE_PX2
    return min(math.sqrt(max(rest, 0.0)), MOST_PX * tracked.frame.size[0] / 640)


def _along(corners: Float) -> Float:
    """(n, d) values at the places along a polygon's edges, of those at its corners (k, d)."""
    after = np.roll(corners, -1, axis=0)
    return np.asarray(corners[:, None] + PLACES[:, None] * (after - corners)[:, None]).reshape(-1, corners.shape[1])


def _on_border(grey: Image, points: Float, outwards: Float) -> Float:
    """Points (n, 2) moved along unit vectors (n, 2) to where brightness rises the most."""
    farthest = OUTLINE_ERROR * grey.shape[1]
    offsets = np.arange(-farthest, farthest + STEP_PX / 2, STEP_PX)
    rows = cv2.GaussianBlur(across(grey, points, outwards, offsets), (0, 0), FOUND_OVER_PX / STEP_PX, sigmaY=1e-3)
    return np.asarray(points + offsets[np.gradient(rows, axis=1).argmax(axis=1), None] * outwards)


def _penumbra_px(camera: Camera, T_cam_marker: Float, ground: Float, height: Float, sun: Sun, outwards: Float) -> Float:
    """(n,) standard deviations of the penumbra across borders at points (n, 3), of what is at heights (n, 1) above."""
    sine = max(float(sun.to_light[2]), LEAST_SINE)
    radius = sun.tan_half_size * height / sine
    azimuth = np.array([*sun.to_light[:2], 0.0]) / max(float(np.hypot(*sun.to_light[:2])), 1e-9)
    axes = (radius / sine * azimuth, radius * np.array([-azimuth[1], azimuth[0], 0.0]))
    middle = project(camera, T_cam_marker, ground)
    reach = [((project(camera, T_cam_marker, ground + axis) - middle) * outwards).sum(axis=1) for axis in axes]
    # A disc's standard deviation is half its radius.
    return np.asarray(0.5 * np.hypot(*reach))
