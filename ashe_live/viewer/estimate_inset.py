"""An estimate, shown at the bottom right: the frozen frame with masks and fitted body, the light rose, the trace."""

from typing import TYPE_CHECKING

import cv2
import numpy as np

from ashe_live.capture.contact_sheet import contact_sheet
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.core.transforms import inverse_rigid
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.drawing.light_rose import light_rose
from ashe_live.drawing.overlays import with_body, with_masks
from ashe_live.light.pixels.view import View
from ashe_live.render.scene import Overlay

if TYPE_CHECKING:
    from ashe_live.light.estimators.trace import Trace

WIDTH = 0.32  # of the window's
STEPS_WIDTH = 0.45  # of the window's, at most
STEP_COLUMNS = 2
STEP_WIDTH_PX = 320  # before the sheet is fitted into the window: its titles have room
MARGIN_PX = 8
# Sets the inset apart from the video around it.
BORDER_PX = 2
BORDER_BGR = (242, 246, 246)
ROSE_HEIGHT = 0.8  # of the frozen frame's
LEAST_ROSE_PX = 64


def inset_overlays(
    estimate: LightEstimate, frozen: TrackedFrame, size: Size, trace: "Trace | None" = None
) -> tuple[Overlay, ...]:
    """For a framebuffer of `size`; `frozen` is the frame, with a marker, that `estimate` and its trace were made from.

    With a trace, one sheet of the steps that led to the answer; without, the answer alone, and the light rose over it.
    """
    if trace is not None:
        return (_at_bottom_right(_steps(estimate, frozen, trace, size), size, 0),)
    picture = _answer(estimate, frozen, max(1, round(WIDTH * size[0])))
    inset = _at_bottom_right(picture, size, 0)
    if not estimate.lights:
        return (inset,)
    rose = _rose(estimate, frozen, picture.shape[0])
    return inset, _at_bottom_right(rose, size, inset.shown_size[1] + MARGIN_PX)


def _steps(estimate: LightEstimate, frozen: TrackedFrame, trace: "Trace", size: Size) -> Image:
    """The trace and what came of it as one sheet, as large as there is room for."""
    # Only here, as whoever does not look at traces need not wait for the estimator's modules.
    from ashe_live.drawing.steps import DebugPicture, centred, traced_pictures

    pictures = traced_pictures(View.of(frozen, STEP_WIDTH_PX), trace)
    answer = _answer(estimate, frozen, STEP_WIDTH_PX)
    pictures.append(DebugPicture("answer", answer))
    if estimate.lights:
        rose = _rose(estimate, frozen, answer.shape[0])
        height = max(answer.shape[0], rose.shape[0])
        pictures.append(DebugPicture("light", centred(rose, (height, STEP_WIDTH_PX, 3))))
    sheet = contact_sheet(
        [picture.image_bgr for picture in pictures],
        [picture.title for picture in pictures],
        STEP_COLUMNS,
        STEP_WIDTH_PX,
    )
    height, width = sheet.shape[:2]
    around = 2 * (MARGIN_PX + BORDER_PX)
    scale = max(0.0, min(STEPS_WIDTH * size[0] / width, (size[1] - around) / height))
    fitted = max(1, round(scale * width)), max(1, round(scale * height))
    return np.asarray(cv2.resize(sheet, fitted, interpolation=cv2.INTER_AREA), np.uint8)


def _answer(estimate: LightEstimate, frozen: TrackedFrame, width: int) -> Image:
    """The frozen frame, that wide, with masks and fitted body."""
    # Masks and body belong to the picture without the lens's distortion.
    view = View.of(frozen, width)
    camera = view.camera.resized((width, max(1, round(width * view.size[1] / view.size[0]))))
    picture = with_masks(np.asarray(cv2.resize(view.image_bgr, camera.size), np.uint8), estimate)
    if (body := estimate.illumination.real_object) is not None:
        picture = with_body(picture, camera, view.T_cam_marker, body, estimate.lights)
    return picture


def _rose(estimate: LightEstimate, frozen: TrackedFrame, height: int) -> Image:
    """To stand beside the frozen frame of that height."""
    assert frozen.marker is not None
    rose_px = max(LEAST_ROSE_PX, round(ROSE_HEIGHT * height))
    return light_rose(estimate.lights, rose_px, inverse_rigid(frozen.marker.T_cam_marker)[:3, 3])


def _at_bottom_right(picture_bgr: Image, size: Size, above_px: int) -> Overlay:
    """Framed, `above_px` higher than the corner's margin."""
    edge = BORDER_PX
    framed = cv2.copyMakeBorder(picture_bgr, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=BORDER_BGR)
    rgba = np.asarray(cv2.cvtColor(framed, cv2.COLOR_BGR2RGBA), np.uint8)
    height, width = rgba.shape[:2]
    return Overlay(rgba, size[0] - width - MARGIN_PX, size[1] - height - MARGIN_PX - above_px)
