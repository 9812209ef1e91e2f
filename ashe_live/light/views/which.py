"""Which other views of a scene are of use beside one of them, and how far apart they are."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import view_direction
from ashe_live.core.types import TrackedFrame

LEAST_HEIGHT = 0.02  # of a camera above the plane, over its distance from the marker


def usable(tracked: TrackedFrame, others: Sequence[TrackedFrame], most: int) -> list[TrackedFrame]:
    """The `most` others of the greatest use beside `tracked`: those with a marker, by how much their directions differ.

    Each is the one whose direction of view is farthest from the nearest of those chosen before, so that fewer are a
    subset of more. Frames from the same place as one chosen before are left out. `tracked` must have a marker.
    """
    assert tracked.marker is not None
    directions = [view_direction(tracked.marker.T_cam_marker)]
    several = [(each, view_direction(each.marker.T_cam_marker)) for each in others if each.marker is not None]
    left = [(other, towards) for other, towards in several if towards[2] > LEAST_HEIGHT]
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
