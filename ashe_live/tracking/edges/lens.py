"""Between the picture's pixels and those of an ideal pinhole camera with the same K, where edges are straight."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import undistorted

MAX_MISS_PX = 0.01  # of an inverted distortion's result, mapped back


def ideal_from_source(camera: Camera, source_px: Float) -> Float:
    """(n, 2) ideal pixels of picture pixels (n, 2); NaN where the distortion cannot be inverted."""
    if not camera.is_distorted:
        return source_px
    ideal = undistorted(camera, source_px)
    miss = np.linalg.norm(source_from_ideal(camera, ideal) - source_px, axis=1)
    ideal[~(miss <= MAX_MISS_PX)] = np.nan
    return ideal


def source_from_ideal(camera: Camera, ideal_px: Float) -> Float:
    """(n, 2) picture pixels of ideal pixels (n, 2)."""
    if not camera.is_distorted:
        return ideal_px
    rays = np.column_stack([ideal_px, np.ones(len(ideal_px))]) @ np.linalg.inv(camera.K).T
    source, _ = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), camera.K, camera.dist)
    return np.asarray(source[:, 0], dtype=np.float64)
