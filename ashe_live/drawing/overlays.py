"""Overlays of an estimate on its picture: masks, and the outlines of the fitted body and of its shadows."""

from collections.abc import Sequence

import cv2
import numpy as np

from ashe_live.core.arrays import FRACTION_BITS, Float, Image, Mask, fixed_point
from ashe_live.core.camera import Camera
from ashe_live.core.light import Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.drawing.colours import OBJECT_BGR, PAPER_BGR, SHADOW_BGR
from ashe_live.light.pixels.areas import resized
from ashe_live.light.shape.predicted import outline, shadow_outline

TINT = 0.6


def with_masks(picture_bgr: Image, estimate: LightEstimate) -> Image:
    """The picture (h, w, 3), tinted where the estimate's masks, scaled to its size, are set."""
    for mask, colour in ((estimate.shadow_mask, SHADOW_BGR), (estimate.object_mask, OBJECT_BGR)):
        if mask is not None:
            picture_bgr = tinted(picture_bgr, resized(mask, picture_bgr.shape[1::-1]), colour)
    return picture_bgr


def with_body(picture_bgr: Image, camera: Camera, T_cam_marker: Float, body: Proxy, lights: Sequence[Light]) -> Image:
    """A copy of the picture (h, w, 3) with the outlines of a body and of its shadows.

    camera: of the picture's size, without distortion. T_cam_marker: (4, 4).
    """
    picture, points = picture_bgr.copy(), body.points_marker()
    for light in lights:
        shadow = shadow_outline(camera, T_cam_marker, points, light.homogeneous)
        draw_outline(picture, shadow, SHADOW_BGR)
    draw_outline(picture, outline(camera, T_cam_marker, points), OBJECT_BGR)
    return picture


def draw_outline(picture_bgr: Image, points: Float | None, colour: tuple[int, int, int]) -> None:
    """Draws a closed line through points (m, 2) into the picture, with a dark rim for contrast; nothing for None."""
    if points is not None:
        line = max(1, picture_bgr.shape[1] // 320)
        for width, ink in ((line + 2, PAPER_BGR), (line, colour)):
            cv2.polylines(picture_bgr, [fixed_point(points)], True, ink, width, cv2.LINE_AA, FRACTION_BITS)


def tinted(picture_bgr: Image, inside: Mask, colour: tuple[int, int, int]) -> Image:
    """A copy of the picture, blended with `colour` (BGR) where the mask `inside` (h, w) is set."""
    blended = cv2.addWeighted(picture_bgr, 1 - TINT, np.full_like(picture_bgr, colour), TINT, 0)
    return np.where(inside[:, :, None], blended, picture_bgr).astype(np.uint8)
