"""The noise of a picture by its brightness, and whether its colours are coarser than its brightness."""

import cv2
import numpy as np

from ashe_live.core.arrays import SIGMA_OVER_MAD, Image

NoiseLevels = tuple[float, float, float, float]
SILENT: NoiseLevels = (0.0, 0.0, 0.0, 0.0)
LEVELS = 4  # equal ranges of encoded brightness, as composite.frag interpolates between their middles
FEWEST_PX = 150  # of a range of brightness, to tell its noise by
STEEP = 4.0  # grey levels a pixel, of the smoothed picture: an edge and no noise
SMOOTHED_PX = 1.5
# Squared differences of colour within pairs of neighbours over those across pairs, the two taken in either order: 1
# where every pixel has its own colour; where pairs share one, 0 if it is repeated, 1/4 to 0.85 if it is interpolated.
COARSE_CHROMA = 0.88
LEAST_CHROMA_DETAIL = 0.01  # levels squared, that there is something to tell it by


def noise_levels(grey: Image) -> NoiseLevels:
    """Standard deviation of the noise of (h, w) uint8, as a fraction of 255, in each of four ranges of brightness.

    Immerkaer, "Fast noise variance estimation", CVIU 1996, with the median in the place of the mean, away from
    edges. A range that hardly occurs has the noise of the nearest that does; 0 where there are nothing but edges.
    """
    kernel = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
    response = np.abs(cv2.filter2D(grey, cv2.CV_32F, kernel)[1:-1, 1:-1])
    if not response.size:
        return SILENT
    smooth = cv2.GaussianBlur(grey, (0, 0), SMOOTHED_PX).astype(np.float32)
    slope = np.hypot(cv2.Sobel(smooth, -1, 1, 0, scale=1 / 8), cv2.Sobel(smooth, -1, 0, 1, scale=1 / 8))[1:-1, 1:-1]
    number = np.where(slope < STEEP, smooth[1:-1, 1:-1] * LEVELS / 256, -1.0).astype(int)
    ranges = [response[number == each] for each in range(LEVELS)]
    most = max(each.size for each in ranges)
    if not most:
        return SILENT
    populated = [each for each in range(LEVELS) if ranges[each].size >= min(FEWEST_PX, most)]
    sigmas = {each: SIGMA_OVER_MAD * float(np.median(ranges[each])) / (6 * 255) for each in populated}
    dark, dim, light, bright = (sigmas[min(populated, key=lambda each: abs(each - wanted))] for wanted in range(LEVELS))
    return dark, dim, light, bright


def has_coarse_chroma(image_bgr: Image) -> bool:
    """Whether (h, w, 3) uint8 has its colours at half the resolution in each row, as 4:2:0 and 4:2:2 encodings do.

    Pixels of a pair, which share a sample of colour, then differ less than neighbours of two pairs, whatever the
    content and however smooth it is.
    """
    colours = cv2.cvtColor(image_bgr, cv2.COLOR_BGR2YCrCb)[..., 1:].astype(np.float32)
    if min(colours.shape[:2]) < 4:
        return False
    beside = [np.square(np.diff(colours, axis=axis)).mean(axis=(1 - axis, 2)) for axis in (0, 1)]
    # Where pairs begin depends on where the picture was cut out.
    pairs = [sorted(float(each[first::2].mean()) for first in (0, 1)) for each in beside]
    within, across = (sum(pair[which] for pair in pairs) for which in (0, 1))
    return across > LEAST_CHROMA_DETAIL and within < COARSE_CHROMA * across
