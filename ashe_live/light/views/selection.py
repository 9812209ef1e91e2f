"""Which other views of a scene are useful beside one of them, and how far apart they are."""

import math
from collections.abc import Sequence

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import view_direction
from ashe_live.core.types import TrackedFrame

# A frame that is given earlier is preferred if its angle to the views chosen before is this share of the largest.
AS_FAR = 0.7
LEAST_ANGLE_RAD = 1e-6  # between two places: less may be rounding
LEAST_HEIGHT = 0.02  # of a camera above the plane, over its distance from the marker


def usable(tracked: TrackedFrame, others: Sequence[TrackedFrame], most: int) -> list[TrackedFrame]:
    """The `most` most useful others beside `tracked`: frames with a marker whose directions of view differ the most.

    They are chosen one after the other, so that fewer are a subset of more: each time a frame that is farthest, or
    nearly so, from the nearest view chosen before. Among these the one given first is taken, so that frames which are
    added later do not displace the views that earlier answers rest on. Frames from the same place as
    one chosen before are left out. `tracked` must have a marker.
    """
    directions = [view_direction(tracked.pose.T_cam_marker)]
    several = [(each, view_direction(each.marker.T_cam_marker)) for each in others if each.marker is not None]
    left = [(other, towards) for other, towards in several if towards[2] > LEAST_HEIGHT]
    chosen: list[TrackedFrame] = []
    while left and len(chosen) < most:
        aside = [min(math.acos(max(-1.0, min(float(towards @ one), 1.0))) for one in directions) for _, towards in left]
        if max(aside) < LEAST_ANGLE_RAD:
            break
        other, towards = left.pop(int(np.argmax(np.array(aside) >= AS_FAR * max(aside))))
        chosen.append(other)
        directions.append(towards)
    return chosen


def span_rad(directions: Sequence[Float]) -> float:
    """The largest angle between directions of view (3,), unit vectors, in radians; 0 for fewer than two."""
    if len(directions) < 2:
        return 0.0
    several = np.array(directions)
    return math.acos(float(np.clip((several @ several.T).min(), -1, 1)))
