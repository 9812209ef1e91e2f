"""The origin of errors: the overlap of masks with the true ones, and the error of the estimator from true labels."""

import cv2
import numpy as np

from ashe_live.bench.cases import Case
from ashe_live.bench.metrics import angular_error_deg, overlap
from ashe_live.core.arrays import Mask
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.given_labels import directions_from_labels
from ashe_live.light.estimators.preset import ProxyPreset


def mask_overlaps(estimate: LightEstimate, case: Case) -> tuple[float | None, float | None]:
    """Intersection over union of the object's and the shadow's masks with the true ones; None where a mask is missing.

    The true ones are those of the main object and all of its shadows, though an answer may come from another object.
    """
    return _overlap(estimate.object_mask, case.mask("object")), _overlap(estimate.shadow_mask, _all_shadows(case))


def error_on_true_labels_deg(case: Case, tracked: TrackedFrame, preset: ProxyPreset) -> float | None:
    """Error of the strongest light as estimated in `tracked`, the picture of `case`, from the true labels; degrees.

    None if the case has no masks or no light, or if no light is found.
    """
    body, shadows = case.mask("object"), _shadows(case)
    if body is None or not shadows or case.to_lights_marker is None or not len(case.to_lights_marker):
        return None
    found = directions_from_labels(tracked, body, shadows, preset, case.mask("clutter"))
    return None if found is None else angular_error_deg(found[0], case.to_lights_marker[0])


def _shadows(case: Case) -> list[Mask]:
    """The masks of the main object's shadows, light by light."""
    names = [f"{name}_caster" if f"{name}_caster" in case.mask_paths else name for name in ("shadow", "shadow2")]
    masks = [case.mask(name) for name in names]
    return [mask for mask in masks if mask is not None]


def _all_shadows(case: Case) -> Mask | None:
    shadows = _shadows(case)
    return np.logical_or.reduce(shadows) if shadows else None


def _overlap(found: Mask | None, true: Mask | None) -> float | None:
    """Intersection over union of a mask, of the estimator's working size, with the true one; None if one is missing."""
    if found is None or true is None:
        return None
    height, width = true.shape
    # INTER_NEAREST goes by corners of pixels, half a pixel of the smaller mask off at most sizes.
    enlarged = cv2.resize(found.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST_EXACT)
    return overlap(enlarged.astype(bool), true)
