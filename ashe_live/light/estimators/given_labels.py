"""The estimator run from given labels: all stages after segmentation and association, without those two.

With true labels, its error is that of the geometry alone, the rest of an estimate's error that of the segmentation.
"""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.explanation.explain import Proposal, explained, refined_by_tangents
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground
from ashe_live.light.ground.regions import Region, region_of
from ashe_live.light.ground.shadow_shift import shift_within
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.two_lights import are_two_shadows, materials_of_each
from ashe_live.light.pixels.view import View


def directions_from_labels(
    tracked: TrackedFrame,
    object_mask: Mask,
    shadow_masks: Sequence[Mask],
    preset: ProxyPreset,
    not_ground: Mask | None = None,
) -> list[Float] | None:
    """The lights that follow from the labels: unit vectors (3,) in the marker frame, one for each shadow mask.

    Masks are (h, w) of the frame, which must have a marker and no distortion: the object, the ground in each light's
    shadow (one light or two), and other pixels that are not ground. None where no light is found: too little ground is
    visible, no label lies on it, a shadow is too small to measure its colours, or no body fits the outlines.
    """
    fine = View.of(tracked, preset.fine_width_px).with_paper_as_ground()
    coarse = fine.scaled(preset.coarse_width_px)
    ground = fit_lit_ground(coarse.image_bgr, coarse.is_ground, preset.ground)
    area = _resized(np.logical_or.reduce([object_mask, *shadow_masks]), coarse.size) & coarse.is_ground
    if ground is None or not area.any():
        return None
    region = region_of(fine, area, ground, preset.region_px)

    def here(mask: Mask) -> Mask:
        return _resized(mask, (region.frame_shape[1], region.frame_shape[0]))[region.window]

    if not_ground is not None:
        region = replace(region, view=replace(region.view, is_ground=region.is_ground & ~here(not_ground)))
    body = here(object_mask)
    shadows = tuple(here(mask) & ~body for mask in shadow_masks)
    shifts = _shifts_alone(shadows, region, ground)
    if shifts is None:
        return None
    # As everywhere, the deeper shadow's light comes first.
    order = sorted(range(len(shadows)), key=lambda i: shifts[i][0])
    parts = tuple(shadows[i] for i in order)
    materials = materials_of_each(region, ground, [shifts[i] for i in order])
    if materials is None or (materials.lights == 2 and not are_two_shadows(parts)):
        return None
    split = Split(body, np.logical_or.reduce(parts), None, parts if len(parts) > 1 else ())
    (found,) = explained([Proposal(region, materials, split)], preset.fine_fit)
    if found is None:
        return None
    (sharp,) = Sharpener.of([fine]).sharpened([refined_by_tangents(found)])
    return [sharp.lights[order.index(i)].to_light_marker for i in range(len(order))]


def _shifts_alone(shadows: Sequence[Mask], region: Region, ground: LitGround) -> list[Float] | None:
    """(3,) the shift of the ground's colours in each of the shadows (h, w) alone; None where one shows too little."""
    shifts = []
    for shadow in shadows:
        others = [~other for other in shadows if other is not shadow]
        alone = np.logical_and.reduce([shadow & region.is_ground, *others])
        shifts.append(shift_within(region.colours[alone], ground))
    known = [shift for shift in shifts if shift is not None]
    return known if len(known) == len(shadows) else None


def _resized(mask: Mask, size: tuple[int, int]) -> Mask:
    return np.asarray(cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)) > 0.5
