"""Surfaces of the ground: what no edge divides. A table's end, a mat and a tile each have an albedo of their own.

Light that falls over a surface changes smoothly, so that a step which stays when fine texture is taken out is paint,
another material, or another plane, as the floor behind a table. Joints and cracks are thinner than that.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float32, Image, Mask
from ashe_live.light.pixels.areas import labelled
from ashe_live.light.pixels.log_colour import log_opponent

TEXTURE_PX = 7  # side of the median that takes out what is, blurred, thinner than half of it
# Of the median's log colour, within two pixels. The steepest fall of a lamp's light is 1.5 times the nearness in log
# brightness per metre: a fifth of this per pixel of 5 mm, 20 cm below a lamp.
STEP = 0.2
CHROMA = 2.0  # weight beside brightness, which light changes as well
LEAST_SHARE = 0.03  # of the ground, of an area; smaller ones are texture
LEAST_COVERED = 0.5  # of the ground, by all of them: below that the ground is texture all over


def surfaces(image_bgr: Image, ground: Mask) -> NDArray[np.int32]:
    """(h, w) number of each pixel's surface, the largest one 1; 0 off `ground` (h, w), on edges and on small ones.

    A ground that is texture all over is one surface.
    """
    return areas_of(ground & (_steps(image_bgr) < STEP), ground)


def areas_of(part: Mask, ground: Mask) -> NDArray[np.int32]:
    """(h, w) number of the connected area of `part` (h, w) that a pixel is in, the largest one 1; 0 in none.

    Small ones are none. A `ground` (h, w) of which all of them cover too little is one area.
    """
    labels, sizes = labelled(part, connectivity=4)
    of_ground = np.count_nonzero(ground)
    large = [i for i in np.argsort(-sizes, kind="stable") if sizes[i] > LEAST_SHARE * of_ground]
    if sizes[large].sum() < LEAST_COVERED * of_ground:
        return ground.astype(np.int32)
    numbers = np.zeros(len(sizes), np.int32)
    numbers[large] = np.arange(1, len(large) + 1)
    return numbers[labels]


def _steps(image_bgr: Image) -> Float32:
    """(h, w) largest change of a channel of the log colour without texture, over two pixels."""
    colours = log_opponent(image_bgr) * np.array([1, CHROMA, CHROMA], np.float32)
    lowest, highest = colours.min(axis=(0, 1)), colours.max(axis=(0, 1))
    scale = np.maximum(highest - lowest, 1e-6) / 255
    levels = ((colours - lowest) / scale).astype(np.uint8)
    smooth = cv2.medianBlur(levels, TEXTURE_PX)
    square = np.ones((3, 3), np.uint8)
    return np.asarray(((cv2.dilate(smooth, square) - cv2.erode(smooth, square)) * scale).max(axis=2), dtype=np.float32)
