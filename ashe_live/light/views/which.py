"""Which other views of a scene are of use beside one of them, and how far apart they are."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import view_direction
from ashe_live.core.types import TrackedFrame

# Of the largest angle from the views chosen before, at which a frame given earlier is as good.
AS_FAR = 0.7
LEAST_ANGLE_RAD = 1e-6  # between two places: rounding makes as much of one
LEAST_HEIGHT = 0.02  # of a camera above the plane, over its distance from the marker


def usable(tracked: TrackedFrame, others: Sequence[TrackedFrame], most: int) -> list[TrackedFrame]:
    """The `most` others of the greatest use beside `tracked`: those with a marker, by how much their directions differ.

    Each is one whose direction of view is farthest, or nearly so, from the nearest of those chosen before, so that
    fewer are a subset of more. Of several the one given first is taken: frames that are added to those given do not
    displace the views that answers began with, and more views find the same explanations. Frames from the same place as
    one chosen before are left out. `tracked` must have a marker.
    """
    assert tracked.marker is not None
    directions = [view_direction(tracked.marker.T_cam_marker)]
    several = [(each, view_direction(each.marker.T_cam_marker)) for each in others if each.marker is not None]
    left = [(other, towards) for other, towards in several if towards[2] > LEAST_HEIGHT]
    chosen: list[TrackedFrame] = []
    while left and len(chosen) < most:
        aside = [min(math.acos(min(float(towards @ one), 1.0)) for one in directions) for _, towards in left]
        if max(aside) < LEAST_ANGLE_RAD:
            break
        other, towards = left.pop(int(np.argmax(np.array(aside) >= AS_FAR * max(aside))))
        chosen.append(other)
        directions.append(towards)
    return chosen


def span_rad(directions: Sequence[Float]) -> float | None:
    """The largest angle between directions of view (3,), unit vectors; None for fewer than two."""
    if len(directions) < 2:
        return None
    several = np.array(directions)
    return math.acos(float(np.clip((several @ several.T).min(), -1, 1)))
