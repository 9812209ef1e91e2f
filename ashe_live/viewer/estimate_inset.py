"""An estimate, shown at the bottom right: the frozen frame with masks and fitted body, and the light rose."""

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.core.transforms import inverse_rigid
from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.drawing.light_rose import light_rose
from ashe_live.drawing.overlays import with_body, with_masks
from ashe_live.light.pixels.view import View
from ashe_live.render.scene import Overlay

WIDTH = 0.32  # of the window's
MARGIN_PX = 8
# Sets the inset apart from the video around it.
BORDER_PX = 2
BORDER_BGR = (242, 246, 246)
ROSE_HEIGHT = 0.8  # of the frozen frame's
LEAST_ROSE_PX = 64


def inset_overlays(estimate: LightEstimate, frozen: TrackedFrame, size: Size) -> tuple[Overlay, ...]:
    """For a framebuffer of `size`; `frozen` is the frame, with a marker, that `estimate` was made from."""
    assert frozen.marker is not None
    T_cam_marker = frozen.marker.T_cam_marker
    # Masks and body belong to the picture without the lens's distortion.
    width = max(1, round(WIDTH * size[0]))
    view = View.of(frozen, width)
    camera = view.camera.resized((width, max(1, round(width * view.size[1] / view.size[0]))))
    picture = with_masks(np.asarray(cv2.resize(view.image_bgr, camera.size), np.uint8), estimate)
    if (body := estimate.illumination.real_object) is not None:
        picture = with_body(picture, camera, T_cam_marker, body, estimate.lights)
    inset = _at_bottom_right(picture, size, 0)
    if not estimate.lights:
        return (inset,)
    rose_px = max(LEAST_ROSE_PX, round(ROSE_HEIGHT * picture.shape[0]))
    rose = light_rose(estimate.lights, rose_px, inverse_rigid(T_cam_marker)[:3, 3])
    return inset, _at_bottom_right(rose, size, inset.shown_size[1] + MARGIN_PX)


def _at_bottom_right(picture_bgr: Image, size: Size, above_px: int) -> Overlay:
    """Framed, `above_px` higher than the corner's margin."""
    edge = BORDER_PX
    framed = cv2.copyMakeBorder(picture_bgr, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=BORDER_BGR)
    rgba = np.asarray(cv2.cvtColor(framed, cv2.COLOR_BGR2RGBA), np.uint8)
    height, width = rgba.shape[:2]
    return Overlay(rgba, size[0] - width - MARGIN_PX, size[1] - height - MARGIN_PX - above_px)
