"""Between the picture's pixels and those of an ideal pinhole camera with the same K, where edges are straight."""

import cv2
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera

# Termination of the iteration that inverts OpenCV's distortion, and how exactly its result must map back.
CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-9)
MAX_MISS_PX = 0.01


def ideal_from_source(camera: Camera, source_px: Float) -> Float:
    """(n, 2) ideal pixels of picture pixels (n, 2); NaN where the distortion cannot be inverted."""
    if not camera.is_distorted:
        return source_px
    points = np.asarray(source_px, dtype=np.float64)[:, None]
    ideal = cv2.undistortPoints(points, camera.K, camera.dist, None, None, camera.K, CRITERIA)[:, 0].astype(np.float64)
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
