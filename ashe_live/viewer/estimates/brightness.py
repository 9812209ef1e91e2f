"""Notices that a picture has become brighter or darker, as when somebody switches a lamp on or off."""

import math

from ashe_live.core.types import Frame

STEP_PX = 16  # every so many rows and columns are looked at
# Log of the mean value's ratio that is no noise, nor the slow drift of a camera's exposure between two estimates.
JUMP = math.log(1.1)


class Brightness:
    """That of the frame that was estimated last, with which others are compared."""

    def __init__(self) -> None:
        self._level: float | None = None

    def note(self, frame: Frame) -> None:
        """The light of this frame is being estimated."""
        self._level = _level(frame)

    def has_jumped(self, frame: Frame) -> bool:
        """Whether this frame is so much brighter or darker that the light may have changed."""
        return self._level is not None and abs(_level(frame) - self._level) > JUMP


def _level(frame: Frame) -> float:
    return math.log(float(frame.image_bgr[::STEP_PX, ::STEP_PX].mean()) + 1.0)
