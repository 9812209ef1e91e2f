"""What an estimate found, over the frame that it was made from, and its light rose."""

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.light import LightEstimate
from ashe_live.core.transforms import camera_centre
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.light_rose import light_rose
from ashe_live.drawing.overlays import with_body, with_masks
from ashe_live.light.pixels.view import View

ROSE_HEIGHT = 0.8  # height of the rose over that of the frame
LEAST_ROSE_PX = 64


def answer_picture(estimate: LightEstimate, frozen: TrackedFrame, width_px: int) -> Image:
    """(h, w, 3) BGR: the frame that the estimate was made from, that wide, with its masks and the fitted body.

    The frame must have a marker.
    """
    # Masks and body belong to the picture without the lens's distortion.
    view = View.of(frozen, width_px)
    camera = view.camera.resized((width_px, max(1, round(width_px * view.size[1] / view.size[0]))))
    picture = with_masks(np.asarray(cv2.resize(view.image_bgr, camera.size), np.uint8), estimate)
    if (body := estimate.illumination.real_object) is not None:
        picture = with_body(picture, camera, view.T_cam_marker, body, estimate.lights)
    return picture


def rose_picture(estimate: LightEstimate, frozen: TrackedFrame, height_px: int) -> Image:
    """(r, r, 3) BGR: the light rose for a picture of that height. The frame must have a marker."""
    rose_px = max(LEAST_ROSE_PX, round(ROSE_HEIGHT * height_px))
    return light_rose(estimate.lights, rose_px, camera_centre(frozen.pose.T_cam_marker))
