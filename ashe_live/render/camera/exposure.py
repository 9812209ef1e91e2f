"""How what is drawn follows the video's exposure: at once where it changes, and still where only its measurement does.

A camera that adapts to the light changes its exposure by several per cent a frame, and what lags behind it shows: a
covered sheet as a rectangle that is brighter or darker than the ground beside it.
"""

import numpy as np

from ashe_live.core.arrays import Float

# Standard deviation, of a logarithm, of an exposure that is measured in one frame by the paper or by ground beside it:
# 0.002 to 0.005 in green, over a rendered clip and one by a phone (by second differences over the frames; a study
# without a command).
NOISE = 0.004


def followed(shown: Float, measured: Float) -> Float:
    """(n,) logarithms of the exposure to show next, by those shown now and those measured in a new frame.

    They move by the share of the change that is likely to be one and not noise (Wiener's filter, the mean square of the
    change itself standing for its expectation).
    """
    change = measured - shown
    square = float(np.square(change).mean())
    return np.asarray(shown + square / (square + NOISE**2) * change)
