"""Where cameras stand."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import rigid


def looking_at(aim: Sequence[float] | Float, eye: Sequence[float] | Float) -> Float:
    """(4, 4) T_cam_marker of an upright camera at `eye` that looks at `aim`, metres in the marker's frame."""
    forward = np.asarray(aim, dtype=float) - np.asarray(eye, dtype=float)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    R = np.array([right, np.cross(forward, right), forward])
    return rigid(R, -R @ np.asarray(eye))
