"""Whether a frame shows what a known light was found by."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import project
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.light.shape.light_points import cast_on_ground

LEAST_SEEN = 0.5  # of a body's points, and of those of one of its shadows


def is_shown(estimate: LightEstimate, tracked: TrackedFrame) -> bool:
    """Whether the real object of `estimate` and a shadow of it are in the picture for the most part.

    Both by the frame of the marker in `tracked`, which must have one. True where no object is known. Whoever leans in
    to look at a model has neither in view, and what is seen then says nothing of the light.
    """
    body = estimate.illumination.real_object
    if body is None or not estimate.lights:
        return True
    points = body.points_marker()
    shadows = [cast_on_ground(points, light.homogeneous) for light in estimate.lights]
    is_in_view = max((_share_in(tracked, shadow) for shadow in shadows if shadow is not None), default=0.0)
    return min(_share_in(tracked, points), is_in_view) >= LEAST_SEEN


def _share_in(tracked: TrackedFrame, points: Float) -> float:
    """Of points (n, 3), marker frame, the share in the picture."""
    assert tracked.marker is not None
    seen = project(tracked.camera, tracked.marker.T_cam_marker, points)
    inside = (seen >= -0.5) & (seen <= np.array(tracked.frame.size) - 0.5)  # never NaN, of what is behind the camera
    return float(inside.all(axis=1).mean())
