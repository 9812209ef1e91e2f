"""Clips what reaches behind the camera from the ground: pages, sheets, bodies, shadows."""

import numpy as np

from ashe_live.core.arrays import Float

NEAREST_SHARE = 0.1  # depth of the near plane that cuts things off, as a fraction of the marker's distance


def before_camera(points_marker: Float, T_cam_marker: Float) -> Float:
    """(m, 3) points whose convex hull is the part of the points' (n, 3) hull beyond the near plane.

    They are the points themselves, in their order, where none lies behind that plane.
    """
    depth = points_marker @ T_cam_marker[2, :3] + T_cam_marker[2, 3]
    nearest = NEAREST_SHARE * float(np.linalg.norm(T_cam_marker[:3, 3]))
    before = depth > nearest
    if before.all() or not before.any():
        return np.asarray(points_marker[before])
    front, back = points_marker[before][:, None], points_marker[~before][None]
    way = (nearest - depth[before][:, None]) / (depth[~before][None] - depth[before][:, None])
    return np.concatenate([points_marker[before], (front + way[..., None] * (back - front)).reshape(-1, 3)])
