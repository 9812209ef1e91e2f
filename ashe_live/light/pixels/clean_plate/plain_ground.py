"""What stands in a picture, over plain ground: by a clean plate, a picture of the same view without it.

Film calls a picture of the empty set a clean plate. Light that reaches the ground multiplies its colour, so that in the
ratio of the two pictures its pattern, the marker's print and whatever else stood there before are gone. What is left is
the camera's exposure, the same everywhere, the shadows, by the share of light that they leave, and the object.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float32, Image
from ashe_live.core.colour import srgb_from_linear
from ashe_live.light.pixels.log_colour import DARKEST, is_exposed, log_linear

# Linear light of the plain ground: things may be five times as bright until they are saturated, and shadows of a
# fiftieth of it are still resolved by eight bits.
SHOWN_AS = 0.2
BIN, WIDEST = 0.02, 2.0  # of the histogram of log ratios: a bin is what eight bits resolve of mid grey
BLUR_BINS = 2.0  # standard deviation of the noise in the histogram
WITHIN = 0.06  # about the mode of log brightness: what the exposure is averaged over


def over_plain_ground(image_bgr: Image, plate_bgr: Image) -> Image:
    """The picture (h, w, 3) as it would be if all that `plate_bgr`, the same view without the object, shows were plain.

    Its colour is that of the plate's ground on average, its brightness the same for all pictures.
    """
    ratio = change_of_light(image_bgr, plate_bgr)
    exposed = is_exposed(plate_bgr)
    plain_bgr = np.median(log_linear(plate_bgr)[exposed], axis=0) if exposed.any() else np.zeros(3, np.float32)
    plain_bgr += np.float32(np.log(SHOWN_AS)) - plain_bgr.mean()
    encoded = srgb_from_linear(np.clip(np.exp(ratio + plain_bgr) - DARKEST, 0, 1))
    return np.asarray(np.round(255 * encoded), dtype=np.uint8)


def change_of_light(image_bgr: Image, plate_bgr: Image) -> Float32:
    """(h, w, 3) the log of a picture's linear light over the plate's, without the change of exposure.

    What a camera has saturated was at least as bright: it counts as changed only where that is known.
    """
    ratio = log_ratio(image_bgr, plate_bgr)
    is_known, is_known_of_plate = is_exposed(image_bgr), is_exposed(plate_bgr)
    ratio -= exposure(ratio[is_known & is_known_of_plate])
    ratio[~is_known] = np.maximum(ratio[~is_known], 0)
    ratio[~is_known_of_plate] = np.minimum(ratio[~is_known_of_plate], 0)
    return ratio


def log_ratio(image_bgr: Image, plate_bgr: Image) -> Float32:
    """(h, w, 3) the log of a picture's linear light over the plate's, channel by channel."""
    return log_linear(image_bgr) - log_linear(plate_bgr)


def exposure(ratio: Float32) -> Float32:
    """(3,) the log ratio of the exposures, by the pixels (n, 3) of two pictures' log ratio: their mode.

    Neither the object nor its shadows count, as long as more of the pixels show what is unchanged.
    """
    if not len(ratio):
        return np.zeros(3, np.float32)
    brightness = ratio.mean(axis=1)
    bins = round(2 * WIDEST / BIN)
    counts, edges = np.histogram(brightness, bins, (-WIDEST, WIDEST))
    smooth = cv2.GaussianBlur(counts.astype(np.float32)[:, None], (1, 0), 0, sigmaY=BLUR_BINS)
    mode = edges[int(smooth.argmax())] + BIN / 2
    near = np.abs(brightness - mode) < WITHIN
    return np.asarray(np.median(ratio[near] if near.any() else ratio, axis=0), dtype=np.float32)
