"""Whether what two frames show can be laid over each other: by one camera, with the marker in one place."""

import math

from ashe_live.core.transforms import lies_elsewhere
from ashe_live.core.types import TrackedFrame

SAME_FOCAL = 1e-6  # relative difference of focal lengths, by rounding where a picture is scaled


def lies_as_in(view: TrackedFrame, other: TrackedFrame) -> bool:
    """Whether the marker lies in the room of both where it lies in the other; both must have one."""
    return not lies_elsewhere(view.T_room_marker, other.T_room_marker, view.pose.side_m)


def fits(view: TrackedFrame, other: TrackedFrame) -> bool:
    """Whether both show one scene by one camera, of whatever size; both must have a marker."""
    return is_by_same_camera(view, other) and lies_as_in(view, other)


def is_by_same_camera(view: TrackedFrame, other: TrackedFrame) -> bool:
    """Whether both frames, of whatever size, have the same focal length: poses by two do not fit each other."""
    focal, other_focal = (each.camera.K[0, 0] / each.camera.size[0] for each in (view, other))
    return math.isclose(focal, other_focal, rel_tol=SAME_FOCAL)
