"""The silhouettes that a body and its shadows have in a picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Float32, Mask, fixed_point
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import project
from ashe_live.light.pixels.near_plane import before_camera
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.body import LitBody, members_of
from ashe_live.light.shape.light_points import cast_on_ground
from ashe_live.light.shape.sight import Sight
from ashe_live.light.shape.supports import outline_points

AROUND = 32  # points on a body's rings: with 16, chords lie 2 % of the radius inside, which biases an alignment
FARTHEST_PX = 1e5  # of an outline from the picture's corner: beyond, it is drawn as if it were there
LARGE_PX = 5e3  # of an outline, from which on it may extend behind the camera


@dataclass(frozen=True, slots=True, eq=False)
class Predicted:
    """The silhouettes of a body and its shadows."""

    body: Mask  # (h, w)
    shadow: Mask  # (h, w) the visible shadow of all lights: what the body does not hide
    parts: tuple[Mask, ...] = ()  # (h, w) each light's visible shadow, if there are two lights; empty for one

    @property
    def whole(self) -> Mask:
        return self.body | self.shadow


def predicted(proxy: Proxy, lights: Float, view: View) -> Predicted:
    """The silhouettes in `view` of a convex body and of its shadows on the marker plane.

    lights: (l, 4) homogeneous points, marker frame.
    """
    return painted(outlines(proxy, lights, view), view.is_ground.shape)


def predicted_of(lit: LitBody, view: View) -> Predicted:
    """The silhouettes of a body and of its shadows in its lights."""
    return predicted(lit.body.proxy, lit.lights, view)


def outlines(proxy: Proxy, lights: Float, view: View) -> list[Float | None]:
    """The outlines (m, 2) in pixels of a convex body, then of its shadow in each light (l, 4); None if not in view."""
    points = proxy.points_marker(AROUND)
    shadows = [shadow_outline(view.camera, view.T_cam_marker, points, light) for light in lights]
    return [outline(view.camera, view.T_cam_marker, points), *shadows]


def painted(hulls_px: Sequence[Float | None], shape: tuple[int, ...]) -> Predicted:
    """The masks, of `shape` (h, w), of the insides of a body's outline and of its shadows'."""
    body, *shadows = (_filled(hull, shape) for hull in hulls_px)
    shadows = [shadow & ~body for shadow in shadows]
    shadow = np.logical_or.reduce([np.zeros_like(body), *shadows])
    return Predicted(body, shadow, tuple(shadows) if len(shadows) > 1 else ())


def outline(camera: Camera, T_cam_marker: Float, points_marker: Float) -> Float | None:
    """(m, 2) pixels: the outline of the convex hull of points (n, 3), clipped at the near plane; None if nothing is
    left.
    """
    points = before_camera(points_marker, T_cam_marker)
    pixels = project(camera, T_cam_marker, points) if len(points) else np.empty((0, 2))
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    if len(pixels) < 3:
        return None
    hull = cv2.convexHull(np.clip(pixels, -FARTHEST_PX, FARTHEST_PX).astype(np.float32))
    return np.asarray(hull[:, 0], dtype=np.float64)


def shadow_outline(camera: Camera, T_cam_marker: Float, points_marker: Float, light: Float) -> Float | None:
    """(m, 2) pixels: the outline of the points' shadow on the marker plane in a light (4,); None if it is infinite."""
    cast = cast_on_ground(points_marker, light)
    return None if cast is None else outline(camera, T_cam_marker, cast)


def lit_outlines(several: Sequence[LitBody], sights: Sequence[Sight]) -> list[list[Float | None]]:
    """As `outlines`, for each body in its sight, computed as one batch for speed.

    All have the same number of lights, and the sights' pixels are counted from the picture's corner.
    """
    P = np.array([sight.P(lit.body.frame) for lit, sight in zip(several, sights, strict=True)])
    lights = np.array([lit.lights_in_body_frame for lit in several])
    found: dict[int, list[Float | None]] = {}
    for batch in members_of([lit.body for lit in several]).batches():
        clouds = outline_points(P[batch.rows], batch.parts, lights[batch.rows], AROUND).astype(np.float32)
        # What seems very large may extend behind the camera, and needs the slower projection with clipping.
        are_large = ~(np.abs(clouds).max(axis=(1, 2, 3, 4)) < LARGE_PX)
        for i, is_large, of_one in zip(batch.rows.tolist(), are_large, clouds, strict=True):
            found[i] = _clipped(several[i], sights[i]) if is_large else [_hull(cloud) for cloud in of_one]
    return [found[i] for i in range(len(several))]


def _clipped(lit: LitBody, sight: Sight) -> list[Float | None]:
    camera, pose, points = sight.camera, sight.T_cam_marker, lit.body.proxy.points_marker(AROUND)
    return [outline(camera, pose, points), *(shadow_outline(camera, pose, points, light) for light in lit.lights)]


def _hull(cloud: Float32) -> Float:
    """(m, 2) convex hull of (k, around, 2) points."""
    return np.asarray(cv2.convexHull(cloud.reshape(-1, 2))[:, 0], dtype=np.float64)


def _filled(hull_px: Float | None, shape: tuple[int, ...]) -> Mask:
    mask = np.zeros(shape, np.uint8)
    if hull_px is not None:
        cv2.fillConvexPoly(mask, fixed_point(hull_px), 1, shift=FRACTION_BITS)
    return mask.view(np.bool_)
