"""The views of one scene that an answer rests on, and which of them show another."""

from collections.abc import Sequence

import numpy as np

from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import FAST, ProxyPreset
from ashe_live.light.explanation.scene_view import SceneView
from ashe_live.light.lamps.lit_by_lamp import lit_ground_beside, lit_ground_of
from ashe_live.light.pixels.view import View
from ashe_live.light.views.agreeing_views import WIDTH_PX, agreeing
from ashe_live.light.views.plane import with_plane
from ashe_live.light.views.selection import usable


def fine_and_coarse(tracked: TrackedFrame, preset: ProxyPreset) -> tuple[View, View]:
    """The picture at the two sizes that the estimator works at; it must have a marker."""
    fine = View.of(tracked, preset.fine_width_px).with_paper_as_ground()
    return fine, fine.scaled(preset.coarse_width_px)


def scene_views(
    tracked: TrackedFrame, fine: View, coarse: View, others: Sequence[TrackedFrame], preset: ProxyPreset
) -> list[SceneView]:
    """`tracked`, which must have a marker, and the others that are used with it: all that an answer rests on.

    fine, coarse: views of `tracked`. Another view with too little lit ground is left out; if there is too little in
    `tracked`, there are no views.
    """
    ground = lit_ground_of(coarse, preset.ground, preset.light)
    if ground is None:
        return []
    views = [SceneView(tracked.frame.index, fine, coarse, ground)]
    for number, other in enumerate(usable(tracked, others, preset.views - 1)):
        fine, coarse = fine_and_coarse(other, preset)
        # A view in which nothing is searched for needs only a coarse model of the ground.
        finely = preset.ground if number < preset.companions else FAST.ground
        seen = lit_ground_beside(ground, coarse, finely, preset.light)
        if seen is not None:
            views.append(SceneView(other.frame.index, fine, coarse, seen))
    return views if len(views) == 1 else with_plane(views)


def contradicting(
    estimate: LightEstimate, tracked: TrackedFrame, others: Sequence[TrackedFrame], preset: ProxyPreset
) -> list[TrackedFrame]:
    """Those of the others used with `tracked` that do not show the scene which `estimate` explains in it.

    The object or the print was moved, or another light is on. None are, where the estimate has no light or no body.
    """
    body, used = estimate.illumination.real_object, usable(tracked, others, preset.views - 1)
    if body is None or not estimate.lights or not used:
        return []
    lights = np.array([light.homogeneous for light in estimate.lights])
    ratio = estimate.lights[0].shadow_rgb_ratio
    depth = 0.0 if ratio is None else -float(np.log(np.maximum(ratio, 1e-3)).mean())
    agree = agreeing([View.of(each, WIDTH_PX) for each in (tracked, *used)], body, lights, depth)
    return [other for other, does in zip(used, agree, strict=True) if not does]
