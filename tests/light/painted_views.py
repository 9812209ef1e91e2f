"""Painted scenes from several sides, and what explains two views of one together."""

from functools import cache
from typing import Any

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.views.joint.aligned import JointExplanation, in_each_view
from tests.light.painted_scenes import BOX, Caster, Painted, paint
from tests.light.synthetic_masks import camera_towards

SIZE = (480, 360)


def pose_from(heading_deg: float) -> Float:
    """T_cam_marker of a camera 45 degrees above the ground, that looks between the marker and the casters."""
    return camera_towards((0.06, 0.0), 0.5, 45.0, heading_deg)


def painted_from(heading_deg: float, *casters: Caster, size: Size = SIZE, **how: Any) -> Painted:
    """As `paint`, from that side."""
    return paint(*casters, T_cam_marker=pose_from(heading_deg), size=size, **how)


def true_box() -> Proxy:
    """BOX as a body."""
    corners = np.concatenate([BOX.base(), BOX.top()])
    return Proxy("box", np.column_stack([corners, np.zeros((len(corners), 2))]))


@cache
def two_views() -> tuple[TrackedFrame, TrackedFrame]:
    """Of BOX, 30 degrees apart around it."""
    first, other = (painted_from(heading, BOX, size=(640, 480)).tracked for heading in (90, 60))
    return first, other


@cache
def explained_in_two_views() -> JointExplanation:
    """The likeliest explanation of them, by a family."""
    first, other = two_views()
    _, trace = ProxyEstimator(FAST).traced(first, [other])
    return in_each_view(trace.judged[int(np.argmax(trace.probabilities))])
