"""The borders of virtual shadows in a picture, whose widths are compared."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import project

APART_PX = 1.0  # distance of two profiles along a border


def shadow_border(points: Float, to_light: Float, camera: Camera, T_cam_marker: Float) -> tuple[Float, Float]:
    """(n, 2) pixels along the border of the shadow that the hull of (m, 3) points casts, and (n, 2) normals out of it.

    points: metres, marker frame. The outline is that of the convex hull, without the edges that have an end behind the
    camera.
    """
    cast = points[:, :2] - points[:, 2:] * (to_light[:2] / to_light[2])
    hull = cv2.convexHull(cast.astype(np.float32)).reshape(-1, 2).astype(np.float64)
    corners = project(camera, T_cam_marker, np.column_stack([hull, np.zeros(len(hull))]))
    along = np.roll(corners, -1, axis=0) - corners
    is_seen = np.isfinite(along).all(axis=1)
    if not is_seen.any():
        return np.zeros((0, 2)), np.zeros((0, 2))
    middle = np.nanmean(corners, axis=0)
    corners, along = corners[is_seen], along[is_seen]
    length = np.linalg.norm(along, axis=1)
    counts = np.maximum((length / APART_PX).astype(int), 1)
    edge = np.repeat(np.arange(len(corners)), counts)
    part = np.concatenate([(np.arange(count) + 0.5) / count for count in counts])
    places = corners[edge] + part[:, None] * along[edge]
    unit = along / np.maximum(length, 1e-9)[:, None]
    outward = np.column_stack([unit[:, 1], -unit[:, 0]])
    outward[((corners + 0.5 * along - middle) * outward).sum(axis=1) < 0] *= -1
    return places, outward[edge]
