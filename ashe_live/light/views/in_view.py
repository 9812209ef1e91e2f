"""How much a frame shows of what a known light was found by."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import project
from ashe_live.core.types import TrackedFrame
from ashe_live.light.shape.light_points import cast_on_ground

HEIGHTS = (0.125, 0.375, 0.625, 0.875)  # over the body's


def share_shown(estimate: LightEstimate, tracked: TrackedFrame) -> float:
    """The share in the picture of the real object of `estimate`, or of its shadow that is seen best, if that is less.

    Both in the frame of the marker as it lies in `tracked`, which must have one. 1 where no object is known. Whoever
    leans in to look at a model has neither in view, and what is seen then says nothing of the light.
    """
    body = estimate.illumination.real_object
    if body is None or not estimate.lights:
        return 1.0
    points = body.points_marker()
    # At several heights below its upper part, so that the shadow's length counts, and not its two ends.
    upper = points[points[:, 2] >= points[:, 2].mean()]
    upright = np.concatenate([upper * (1.0, 1.0, part) for part in HEIGHTS])
    shadows = [cast_on_ground(upright, light.homogeneous) for light in estimate.lights]
    in_view = max((_share_in(tracked, shadow) for shadow in shadows if shadow is not None), default=0.0)
    return min(_share_in(tracked, points), in_view)


def _share_in(tracked: TrackedFrame, points: Float) -> float:
    """Of points (n, 3), marker frame, the share in the picture."""
    seen = project(tracked.camera, tracked.pose.T_cam_marker, points)
    inside = (seen >= -0.5) & (seen <= np.array(tracked.frame.size) - 0.5)  # never NaN, of what is behind the camera
    return float(inside.all(axis=1).mean())
