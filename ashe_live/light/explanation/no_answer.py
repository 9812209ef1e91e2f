"""Why there is no answer, in words for the user: the likeliest cause that can be seen, and what to change."""

import cv2
import numpy as np

from ashe_live.core.arrays import Mask
from ashe_live.core.transforms import project
from ashe_live.light.explanation.explain import END_IN_VIEW
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.pixels.sheet import Sheet
from ashe_live.light.pixels.view import View

TOO_LITTLE_GROUND = "too little lit ground around the marker"
NOTHING_THERE = "nothing stands on the ground: put something that casts a shadow beside the marker"
NO_SHADOW = "no shadow found: the light may be diffuse, or the shadow out of view"
HARDLY_A_SHADOW = "hardly any shadow is seen: the light may be behind you, or diffuse: look from another side"
SKY_ALONE = "the ground is darker only where the object hides the sky: the light is diffuse, as from clouds"
DOES_NOT_FIT = "what stands out from the ground does not fit an object and its shadow in one light"
OTHER_SIZE = "the object does not look like the given caster: measure it again, stand it upright, or give none"
NEAR_OR_FAR = "how far away the light is stays open, and so its direction at the marker: move the object to the marker"
ROUGH_POSE = "how the marker lies stays open, and so the light's direction: show it larger, or from another side"
LOW_LAMP = "a lamp seems to stand lower than the object's top, whose shadow then has no end: raise the lamp"
CUT_OFF = "the shadow seems to leave the picture: show its far end"
TOO_DARK = "the picture is too dark to tell shadow from light: more light, or a longer exposure"
BLACK_GROUND = "the ground is too dark to show a shadow: a lighter table, or less print around the marker"
TOO_BRIGHT = "the picture is overexposed, the table is plain white in it: a shorter exposure"
PAGE_TOO_BRIGHT = (
    "the marker's page is overexposed, plain white in the picture: a shorter exposure, or cut the marker out"
)

# Values of the brightest channel, 0 to 255. Below DARK, quantisation steps are as large as a pale shadow's contrast;
# from CLIPPED on, the camera's response curve is saturated.
DARK, CLIPPED = 28, 250
MOST_DARK, MOST_CLIPPED = 0.5, 0.5  # fractions of the ground, beyond which the picture is too dark or too bright
# Paper that is at least this light shows that the exposure is right. The marker's margin is white, but may be no more
# than the lightest twentieth of its sheet.
PAPER, PAPER_PERCENTILE = 4 * DARK, 95
STANDS_OUT = 0.3  # of an overexposed page, more than a thing and its shadow cover: else something else is at fault
MARGIN_PERCENTILE = 75  # of the marker's sheet, half of which is black: a value of its white margin
HARDLY = 0.1  # of its object's area: a shadow that is smaller is hidden behind the object, or none
LEAST_GOOD_BY_POSE = 0.5  # probability below which the marker's pose is blamed
LEAST_CUT_OFF = 0.1  # least confidence of an explanation whose shadow is said to leave the picture


def fault_of_exposure(view: View, unlit: Mask | None = None) -> str | None:
    """What is wrong with the picture's brightness, as the ground shows it; None if nothing is.

    unlit: (h, w) what stands out from the lit ground.
    """
    view = view.taken or view
    blue, green, red = cv2.split(view.image_bgr)
    brightest = cv2.max(cv2.max(blue, green), red)
    counts = cv2.calcHist([brightest], [0], view.is_ground.view(np.uint8), [256], [0, 256])
    total = float(counts.sum())
    if counts[:DARK].sum() > MOST_DARK * total:
        # The exposure is right if paper is as light as it should be: it is the ground that is black.
        return BLACK_GROUND if _sheet_at(view, PAPER_PERCENTILE) >= PAPER else TOO_DARK
    if counts[CLIPPED:].sum() > MOST_CLIPPED * total:
        return TOO_BRIGHT
    # A page is given the ground's colour by the ratio of both at its rim, which overexposed paper may not show.
    if view.page is None or unlit is None or _sheet_at(view, MARGIN_PERCENTILE) < CLIPPED:
        return None
    on_page = _covered_by(Sheet(*view.page.ends), view) & ~_covered_by(view.sheet, view)
    return PAGE_TOO_BRIGHT if on_page.any() and unlit[on_page].mean() > STANDS_OUT else None


def _sheet_at(view: View, percentile: float) -> float:
    """This percentile of the brightest channel of the marker's own sheet, 0 to 255; 0 where none of it is seen."""
    on_sheet = view.image_bgr[_covered_by(view.sheet, view)].max(axis=-1)
    return float(np.percentile(on_sheet, percentile)) if len(on_sheet) else 0.0


def _covered_by(sheet: Sheet, view: View) -> Mask:
    """(h, w) the pixels that a sheet around the marker covers; none where a part of it is behind the camera."""
    inside = np.zeros(view.is_ground.shape, np.uint8)
    outline = project(view.camera, view.T_cam_marker, sheet.corners(view.side_m))
    if np.isfinite(outline).all():
        cv2.fillConvexPoly(inside, np.round(outline.clip(-1e4, 1e4)).astype(np.int32), 1)
    return inside > 0


def fault_of_scene(explanation: Explanation, confidence: float) -> str:
    """Why the likeliest explanation of a scene, of some `confidence`, is not likely enough, for the user."""
    if confidence >= LEAST_CUT_OFF and _is_cut_off(explanation):
        return CUT_OFF
    predicted = explanation.predicted
    hidden = np.count_nonzero(predicted.shadow) < HARDLY * np.count_nonzero(predicted.body)
    return HARDLY_A_SHADOW if hidden else DOES_NOT_FIT


def fault_of_place(explanation: Explanation, good_by_pose: float) -> str:
    """Why the direction from the marker to an explanation's light stays open, for the user.

    good_by_pose: the probability that the marker's pose does not put it off.
    """
    if good_by_pose < LEAST_GOOD_BY_POSE:
        return ROUGH_POSE
    return CUT_OFF if _is_cut_off(explanation) else NEAR_OR_FAR


def _is_cut_off(explanation: Explanation) -> bool:
    """Whether the shadow goes on beyond the picture's border."""
    out_of_view = min(explanation.alignment.ends_in_view) < END_IN_VIEW
    shadow = explanation.region.in_frame(explanation.predicted.shadow)
    return bool(out_of_view and (shadow[[0, -1]].any() or shadow[:, [0, -1]].any()))
