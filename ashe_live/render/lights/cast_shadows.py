"""Where shadows lie on the ground, as polygons, for callers that need this before or without drawing them."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, cross_2d
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import light_view
from ashe_live.render.lights.lighting import ShadingLight

MAX_SHADOW_HEIGHTS = 30.0  # a shadow is drawn this many heights of the model long at most
RIM_POINTS = 8  # number of points that stand for a light's disc
LEAST_DISTANCE = 1e-9  # of a lamp from what it shines on, over that from the marker's centre


def shadow_hull(points: Float, light: ShadingLight) -> Float:
    """(n, 2) convex: the shadow on the ground, penumbra and all, of a body whose hull is that of points (m, 3)."""
    return _hull(_cast(points, _around(light)))


def shadow_hull_of_point(points: Float, light: Float) -> Float:
    """(n, 2) convex: the shadow on the ground, of a body whose hull is that of points (m, 3), in a light without size.

    light: (4,) homogeneous, above the horizon. For a light with a size, the outline lies in the middle of the penumbra.
    """
    return _hull(_cast(points, light[None]))


def cast_by_point(points: Float, light: Float) -> Float:
    """(n, 2) where a light without size, (4,) homogeneous above the horizon, casts the shadows of points (n, 3)."""
    return np.asarray(_cast(points, light[None])[0])


def lit_past(body: Proxy, light: ShadingLight, ground: Float) -> Float:
    """(n,) 1 where all of a light reaches points (n, 2) of the ground past a body, 0 where none does, NaN between."""
    points = body.points_marker()
    inside = np.array([is_inside(_hull(shadow), ground) for shadow in _cast(points, _around(light))])
    shaded, lit = inside.all(axis=0), ~is_inside(shadow_hull(points, light), ground)
    return np.where(lit, 1.0, np.where(shaded, 0.0, np.nan))


def _hull(points: Float) -> Float:
    """(n, 2) corners of the convex hull of points (..., 2)."""
    return np.asarray(cv2.convexHull(points.reshape(-1, 2).astype(np.float32)).reshape(-1, 2), dtype=np.float64)


def is_inside(hull: Float, points: Float) -> NDArray[np.bool_]:
    """(n,) whether points (n, 2) are within a convex polygon (m, 2)."""
    edges = np.roll(hull, -1, axis=0) - hull
    sides = cross_2d(edges, points[:, None] - hull)
    return np.asarray((sides >= 0).all(axis=1) | (sides <= 0).all(axis=1))


def _around(light: ShadingLight) -> Float:
    """(RIM_POINTS, 4) homogeneous points around the light, between which it lies."""
    across, along = light_view(light.to_light)[:2, :3]
    angles = np.arange(RIM_POINTS) * (math.tau / RIM_POINTS)
    radius = light.tan_half_size / math.cos(math.pi / RIM_POINTS)
    rim = light.to_light + radius * (np.outer(np.cos(angles), across) + np.outer(np.sin(angles), along))
    return np.column_stack([rim, np.full(RIM_POINTS, light.inverse_distance)])


def _cast(points: Float, lights: Float) -> Float:
    """(k, n, 2) where lights (k, 4) cast the shadows of points (n, 3), or that way as far as they are drawn."""
    height = points[:, 2]
    towards, inverse = lights[:, None, :3], lights[:, None, 3:]
    away = inverse * points[:, :2] - towards[..., :2]  # from the light, divided by its distance
    length = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    above = towards[..., 2] - inverse[..., 0] * height
    cast = np.divide(height * length, above, out=np.full_like(above, np.inf), where=above > 0)
    farthest = MAX_SHADOW_HEIGHTS * np.maximum(height, 0.0)
    stretch = np.minimum(cast, farthest) / np.maximum(length, LEAST_DISTANCE)
    return np.asarray(points[:, :2] + stretch[..., None] * away)
