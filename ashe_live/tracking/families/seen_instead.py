"""What a picture shows in which the followed marker is not found, as far as it tells why."""

from dataclasses import dataclass

import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.tracking.families.in_view import markers_in_view, mirrored_in_view

ALL_BLACK = "nearly all of the picture is black: more light, a longer exposure, or the cover off the camera"
ALL_WHITE = "nearly all of the picture is plain white: a shorter exposure"

# Values of the brightest channel, 0 to 255. Darker than BLACK, a codec leaves little of a marker's edges; from WHITE
# on, the camera's response curve is saturated.
BLACK, WHITE = 16, 250
NEARLY_ALL = 0.9  # of the picture's pixels: what is left is smaller than a marker that a person would show
STEP_PX = 8  # every so many rows and columns are looked at


@dataclass(frozen=True, slots=True)
class SeenInstead:
    """What is seen instead of the followed marker: at most one of these is not empty."""

    in_view: tuple[str, ...] = ()  # specs of other markers, the largest first
    mirrored: tuple[str, ...] = ()  # specs of markers that are seen in mirror image
    fault: str | None = None  # what is wrong with the exposure, and what helps


def seen_instead(image_bgr: Image) -> SeenInstead:
    """What (h, w, 3) uint8 sRGB shows instead of the marker that was not found in it."""
    in_view = markers_in_view(image_bgr)
    mirrored = () if in_view else mirrored_in_view(image_bgr)
    return SeenInstead(in_view, mirrored, None if in_view or mirrored else extreme_exposure(image_bgr))


def extreme_exposure(image_bgr: Image) -> str | None:
    """ALL_BLACK or ALL_WHITE if (h, w, 3) uint8 sRGB is nearly that, so that it can show no marker; else None."""
    brightest = image_bgr[::STEP_PX, ::STEP_PX].max(axis=-1)
    if np.mean(brightest < BLACK) > NEARLY_ALL:
        return ALL_BLACK
    return ALL_WHITE if np.mean(brightest >= WHITE) > NEARLY_ALL else None
