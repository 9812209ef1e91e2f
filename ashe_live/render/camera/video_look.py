"""Measures the video's exposure, blur and noise, so that the model can look as if the same camera had filmed it.

All are measured in one frame at the printed marker: a black square with sharp edges on white paper.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.colour import REC709_LUMINANCE
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.chroma_blur import chroma_blur_px
from ashe_live.render.camera.edges import blur_and_sharpening
from ashe_live.render.camera.grain import SILENT, NoiseLevels, has_coarse_chroma, noise_levels
from ashe_live.render.camera.white import OVEREXPOSED, PAPER_ALBEDO, print_corners_px
from ashe_live.render.lights.lighting import RGB

HALF_RESOLUTION_PX = 1.0  # sigma of colours that are means of two pixels, interpolated: variances of 1/4 and 3/4
# Encoders round off weak colours more than strong ones. This is the variance of the blur of colours on the ground, less
# that due to denoising and half resolution: the median of 824 photos whose cameras are known (quartiles 1.7 and 4.7),
# printed by assets/sources/scenes/weak_colours.py for the set `training --every 4`; that of `development` is 2.9.
WEAK_COLOURS_PX2 = 3.1
WINDOW_PX = 160  # side of the part of the picture whose noise and colours stand for the whole


@dataclass(frozen=True, slots=True)
class VideoLook:
    """The look of one frame."""

    white_rgb: RGB  # linear RGB in the picture of a fully lit, level, perfectly white surface
    # Blur of lens and processing, without that of a pixel's own area; pixels of the video. None: not asked for.
    blur_sigma_px: float | None
    noise_sigmas: NoiseLevels  # standard deviations of the encoded values in [0, 1], as `noise_levels` has them
    sharpening: float = 0.0  # amount of unsharp masking by the camera, with a blur of a pixel
    chroma_blur_px: float = 0.0  # sigma of the blur that colours have beyond brightness, pixels of the video

    @property
    def paper_rgb(self) -> Float:
        """(3,) linear RGB of its fully lit paper, over 1 where the picture cannot show it."""
        return PAPER_ALBEDO * np.array(self.white_rgb)

    @property
    def is_overexposed(self) -> bool:
        """Whether its paper is brighter than the picture can show."""
        return float(self.paper_rgb @ REC709_LUMINANCE) > OVEREXPOSED[1]


UNSEEN = VideoLook((1.0, 1.0, 1.0), None, SILENT)


def sharpness_of(tracked: TrackedFrame, white_rgb: RGB) -> tuple[float, float]:
    """Sigma of the blur, in pixels, and amount of sharpening at the marker of a frame, as `VideoLook` has them.

    `white_rgb`: of that frame. An edge to paper that is overexposed is steeper, for the part of it that is shown, than
    the lens made it.
    """
    paper = PAPER_ALBEDO * float(np.array(white_rgb) @ REC709_LUMINANCE)
    return blur_and_sharpening(_grey(tracked.frame.image_bgr), print_corners_px(tracked), paper)


def noise_of(tracked: TrackedFrame) -> NoiseLevels:
    """The noise around the marker of a frame."""
    return noise_levels(_grey(around_print(tracked)))


def chroma_blur_of(tracked: TrackedFrame) -> float:
    """Sigma in pixels by which strong colours, as a model's are, would be blurred in a frame with a marker."""
    image = around_print(tracked)
    found = chroma_blur_px(image) or 0.0
    least = HALF_RESOLUTION_PX if has_coarse_chroma(image) else 0.0
    return max(least, math.sqrt(max(found**2 - WEAK_COLOURS_PX2, 0.0)))


def around_print(tracked: TrackedFrame) -> Image:
    """The part of a frame with a marker in which the blur of colours is looked for, (h, w, 3) BGR."""
    return _window(tracked.frame.image_bgr, print_corners_px(tracked).mean(axis=0))


def _grey(image_bgr: Image) -> Image:
    return np.asarray(cv2.cvtColor(image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)


def _window(image: Image, centre: Float) -> Image:
    """The part around `centre` that stands for the whole; all of a small picture."""
    half = WINDOW_PX // 2
    column, row = (
        int(np.clip(at, half, max(half, limit - half))) for at, limit in zip(centre, image.shape[1::-1], strict=True)
    )
    return image[max(0, row - half) : row + half, max(0, column - half) : column + half]
