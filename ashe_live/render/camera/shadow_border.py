"""How much softer the border of the real object's shadow is than lens and light make it."""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import along_sides
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.edges import (
    AROUND,
    BOX_VARIANCE_PX2,
    INTERPOLATION_VARIANCE_PX2,
    REACH_PX,
    STEP_PX,
    across,
    blur_of_step_px,
    edge_blur_px,
    profile_at,
)
from ashe_live.render.camera.in_frame import project_distorted
from ashe_live.render.camera.white import PAPER_ALBEDO, white_of
from ashe_live.render.lights.cast_shadows import cast_by_point
from ashe_live.render.lights.lighting import ShadingLight

MOST_PX = 1.5  # largest softness that is believed, in a picture 640 pixels wide
# The border is sought within this distance (over the picture's width) of where the proxy, which is convex, casts it.
OUTLINE_ERROR = 0.02
FOUND_OVER_PX = 1.0  # standard deviation of the smoothing before it is sought
PLACES = np.linspace(0.15, 0.85, AROUND)  # along each of the outline's edges
# Parts of the outline that are cast from below this share of the body's height are left out: there the border is that
# of the body itself, and of the sky that it hides.
FOOT = 0.1
LEAST_SINE = 0.1  # limit of the sine of a light's elevation
NEAREST = 0.1  # limit of a lamp's distance from the body, over that from the marker's centre


def unexplained_border_px(tracked: TrackedFrame, proxy: Proxy, light: ShadingLight) -> float:
    """Standard deviation (px) by which the real shadow's border is softer than lens and light make it; 0 if by none.

    A camera's sharpening makes the marker's strong edges steeper than the weak ones of shadows, its denoising makes
    those softer, and a light of unknown size counts as a bare one.
    """
    T_cam_marker = tracked.pose.T_cam_marker
    body = proxy.points_marker()
    cast = cast_by_point(body, light.homogeneous)
    outline = cv2.convexHull(cast.astype(np.float32), returnPoints=False).ravel()
    ground = np.column_stack([cast[outline], np.zeros(len(outline))])
    if len(outline) < 3 or (ground @ T_cam_marker[2, :3] + T_cam_marker[2, 3]).min() <= 1e-3:
        return 0.0
    corners = project_distorted(tracked.camera, T_cam_marker, ground)
    points, outwards = along_sides(corners, PLACES)
    above, below = _along(body[outline]), _along(ground)
    is_cast = above[:, 2] > FOOT * body[:, 2].max()
    if not is_cast.any():  # flat on the ground, or below it
        return 0.0
    above, below = above[is_cast], below[is_cast]
    points, outwards = points.reshape(-1, 2)[is_cast], np.repeat(outwards, AROUND, axis=0)[is_cast]
    grey = np.asarray(cv2.cvtColor(tracked.frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
    ratio = 1 - float(np.array(light.ground_share) @ REC709_LUMINANCE)
    profile = profile_at(grey, _on_border(grey, points, outwards), outwards, REACH_PX, ratio)
    if profile is None:
        return 0.0
    radii = _penumbra_px(tracked.camera, T_cam_marker, below, above, light, outwards)[profile.used]
    paper = PAPER_ALBEDO * float(np.array(white_of(tracked)) @ REC709_LUMINANCE)
    of_print = edge_blur_px(grey, tracked.pose.corners_px, paper)
    lens = math.sqrt(of_print**2 + BOX_VARIANCE_PX2 + INTERPOLATION_VARIANCE_PX2)
    explained = blur_of_step_px(_step_by(radii, lens, len(profile.step)))
    # The shadow maps' own texels blur about as much as a pixel does.
    rest = blur_of_step_px(profile.step) ** 2 - explained**2 - BOX_VARIANCE_PX2
    return min(math.sqrt(max(rest, 0.0)), MOST_PX * tracked.frame.size[0] / 640)


def _step_by(radii_px: Float, lens_px: float, count: int) -> Float:
    """(count,) the median of steps by penumbrae of such radii (n,), blurred by a Gaussian's standard deviation.

    Past a straight edge comes what that leaves free of a disc. Its slope at the middle is less steep than a Gaussian's
    of the same variance, by which a border would be 1.25 times as soft as its penumbra makes it.
    """
    at = (np.arange(count) - count // 2) * STEP_PX
    t = np.clip(at / np.maximum(radii_px, STEP_PX / 4)[:, None], -1, 1)
    steps = np.median(0.5 + (t * np.sqrt(1 - t**2) + np.arcsin(t)) / math.pi, axis=0)[None]
    width = 2 * math.ceil(3 * lens_px / STEP_PX) + 1
    return np.asarray(cv2.GaussianBlur(steps, (width, 1), lens_px / STEP_PX, borderType=cv2.BORDER_REPLICATE)[0])


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


def _penumbra_px(
    camera: Camera, T_cam_marker: Float, ground: Float, body: Float, light: ShadingLight, outwards: Float
) -> Float:
    """(n,) radii of the penumbra across borders at points (n, 3) of the ground, cast by points (n, 3)."""
    ray = body - ground
    length = np.maximum(np.linalg.norm(ray, axis=1), 1e-9)
    sine = np.maximum(ray[:, 2] / length, LEAST_SINE)
    # A lamp is as much larger seen from the body as that is nearer to it than the marker's centre.
    radius = light.tan_half_size * length / np.maximum(np.linalg.norm(light.towards(body), axis=1), NEAREST)
    azimuth = ray[:, :2] / np.maximum(np.hypot(*ray[:, :2].T), 1e-9)[:, None]
    level = np.column_stack([azimuth, np.zeros(len(ray))]), np.column_stack([azimuth[:, ::-1] * (-1, 1), 0 * sine])
    axes = (radius / sine)[:, None] * level[0], radius[:, None] * level[1]
    middle = project_distorted(camera, T_cam_marker, ground)
    ends = (project_distorted(camera, T_cam_marker, ground + axis) for axis in axes)
    return np.asarray(np.hypot(*(((end - middle) * outwards).sum(axis=1) for end in ends)))
