"""Which other views of a scene are of use beside one of them, and how far apart they are."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import inverse_rigid, normalised
from ashe_live.core.types import TrackedFrame

LEAST_HEIGHT = 0.02  # of a camera above the plane, over its distance from the marker


def usable(tracked: TrackedFrame, others: Sequence[TrackedFrame], most: int) -> list[TrackedFrame]:
    """The `most` others of the greatest use beside `tracked`: those with a marker, by how much their directions differ.

    Each is the one whose direction of view is farthest from the nearest of those chosen before, so that fewer are a
    subset of more. Frames from the same place as one chosen before are left out.
    """
    directions = [view_direction(tracked)]
    left = [(other, view_direction(other)) for other in others if _is_usable(other)]
    chosen: list[TrackedFrame] = []
    while left and len(chosen) < most:
        nearest = [max(float(towards @ one) for one in directions) for _, towards in left]
        best = int(np.argmin(nearest))
        if nearest[best] > 1 - 1e-12:
            break
        other, towards = left.pop(best)
        chosen.append(other)
        directions.append(towards)
    return chosen


def span_rad(directions: Sequence[Float]) -> float | None:
    """The largest angle between directions of view (3,), unit vectors; None for fewer than two."""
    if len(directions) < 2:
        return None
    several = np.array(directions)
    return math.acos(float(np.clip((several @ several.T).min(), -1, 1)))


def view_direction(tracked: TrackedFrame) -> Float:
    """(3,) unit vector from the marker's centre to the camera, marker frame. The frame must have a marker."""
    assert tracked.marker is not None
    return towards_camera(tracked.marker.T_cam_marker)


def towards_camera(T_cam_marker: Float) -> Float:
    """(3,) unit vector from the marker's centre to the camera, marker frame."""
    return normalised(inverse_rigid(T_cam_marker)[:3, 3])


def _is_usable(tracked: TrackedFrame) -> bool:
    return tracked.marker is not None and bool(view_direction(tracked)[2] > LEAST_HEIGHT)
