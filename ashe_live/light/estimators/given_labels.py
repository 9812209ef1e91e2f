"""What the estimator makes of labels that are given: all that follows them, and nothing of what finds them.

With true labels it tells how much of an error is the geometry's, and how much the segmentation's.
"""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.steps import ProxySteps
from ashe_live.light.explanation.explain import Proposal, explained, sharpened
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground
from ashe_live.light.ground.regions import Region, region_of
from ashe_live.light.ground.shadow_shift import shift_within
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import Materials, materials_of
from ashe_live.light.labels.two_lights import are_two, materials_of_two
from ashe_live.light.pixels.view import View


def directions_from_labels(
    tracked: TrackedFrame,
    object_mask: Mask,
    shadow_masks: Sequence[Mask],
    steps: ProxySteps,
    not_ground: Mask | None = None,
) -> list[Float] | None:
    """The lights (3,), unit vectors in the marker frame, that follow from the labels, one for each of their shadows.

    Masks are (h, w) of the frame, which must have a marker and no distortion: the object, what of the ground lies in
    each light's shadow (of one light or two), and what else is no ground. None where the estimator finds no light: the
    ground is too small, no shadow is darker than it, or no body explains the outlines.
    """
    fine = View.of(tracked, steps.fine_width_px)
    coarse = fine.scaled(steps.coarse_width_px)
    ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, steps.ground)
    if ground is None:
        return None
    area = _resized(np.logical_or.reduce([object_mask, *shadow_masks]), coarse.size)
    region = region_of(fine, area & coarse.is_ground, ground, steps.region_px)

    def here(mask: Mask) -> Mask:
        return _resized(mask, (region.frame_shape[1], region.frame_shape[0]))[region.window]

    if not_ground is not None:
        region = replace(region, view=replace(region.view, is_ground=region.is_ground & ~here(not_ground)))
    body = here(object_mask)
    shadows = tuple(here(mask) & ~body for mask in shadow_masks)
    shifts = []
    for i, shadow in enumerate(shadows):
        alone = np.logical_and.reduce(
            [shadow & region.is_ground, *(~other for other in shadows[:i] + shadows[i + 1 :])]
        )
        shift = shift_within(region.colours[alone], ground)
        if shift is None:
            return None
        shifts.append(shift)
    # As everywhere, the deeper shadow's light comes first.
    order = sorted(range(len(shadows)), key=lambda i: shifts[i][0])
    parts = tuple(shadows[i] for i in order)
    materials = _materials(region, ground, [shifts[i] for i in order])
    if materials is None or (materials.lights == 2 and not are_two(parts)):
        return None
    split = Split(body, np.logical_or.reduce(parts), None, parts if len(parts) > 1 else ())
    (found,) = explained([Proposal(region, materials, split)], steps.fine_fit)
    if found is None:
        return None
    lights = sharpened(found).lights
    return [lights[order.index(i)].to_light_marker for i in range(len(order))]


def _materials(region: Region, ground: LitGround, shifts: Sequence[Float]) -> Materials | None:
    """Of one light, or of two; None where both together would leave no light."""
    first, *others = (materials_of(region, ground, shift) for shift in shifts)
    return materials_of_two(region, ground, first, others[0]) if others else first


def _resized(mask: Mask, size: tuple[int, int]) -> Mask:
    return np.asarray(cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)) > 0.5
