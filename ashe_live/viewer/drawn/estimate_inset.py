"""An estimate, shown at the bottom right: the frozen frame with masks and fitted body, the light rose; or its steps."""

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.drawing.answer import answer_picture, rose_picture
from ashe_live.render.scene import Overlay

WIDTH = 0.32  # of the window's
STEPS_WIDTH = 0.45  # of the window's, at most
MARGIN_PX = 8
# Sets the inset apart from the video around it.
BORDER_PX = 2
BORDER_BGR = (242, 246, 246)


def inset_overlays(
    estimate: LightEstimate, frozen: TrackedFrame, size: Size, steps_bgr: Image | None = None
) -> tuple[Overlay, ...]:
    """For a framebuffer of `size`; `frozen` is the frame, with a marker, that `estimate` was made from.

    With the sheet of the steps that led to the answer, this sheet; else the answer alone, and the light rose over it.
    """
    if steps_bgr is not None:
        return (_at_bottom_right(_fitted(steps_bgr, size), size, 0),)
    picture = answer_picture(estimate, frozen, max(1, round(WIDTH * size[0])))
    inset = _at_bottom_right(picture, size, 0)
    if not estimate.lights:
        return (inset,)
    rose = rose_picture(estimate, frozen, picture.shape[0])
    above = _at_bottom_right(rose, size, inset.shown_size[1] + MARGIN_PX)
    return (inset, above) if above.top_px >= MARGIN_PX else (inset,)  # a flat window has no room for it


def _fitted(sheet_bgr: Image, size: Size) -> Image:
    """The sheet as large as there is room for."""
    height, width = sheet_bgr.shape[:2]
    around = 2 * (MARGIN_PX + BORDER_PX)
    scale = max(0.0, min(STEPS_WIDTH * size[0] / width, (size[1] - around) / height))
    fitted = max(1, round(scale * width)), max(1, round(scale * height))
    return np.asarray(cv2.resize(sheet_bgr, fitted, interpolation=cv2.INTER_AREA), np.uint8)


def _at_bottom_right(picture_bgr: Image, size: Size, above_px: int) -> Overlay:
    """Framed, `above_px` higher than the corner's margin."""
    edge = BORDER_PX
    framed = cv2.copyMakeBorder(picture_bgr, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=BORDER_BGR)
    rgba = np.asarray(cv2.cvtColor(framed, cv2.COLOR_BGR2RGBA), np.uint8)
    height, width = rgba.shape[:2]
    return Overlay(rgba, size[0] - width - MARGIN_PX, size[1] - height - MARGIN_PX - above_px)
