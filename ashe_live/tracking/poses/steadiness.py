"""Decides whether the marker has been still for long enough for a frame to be estimated."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.square import side_lengths_px
from ashe_live.core.types import TrackedFrame

MOST_SPEED = 1.8  # of a corner, in shortest sides a second: 0.06 sides between two frames at 30 frames a second
MOST_MOTION = 0.15  # in sides, however far apart two frames are: in poor light they may be exposed for as long
LEAST_APART_S = 1 / 60  # assumed of two frames: cameras deliver some in bursts


class Steadiness:
    """Counts the frames in a row in which the marker was read and its corners hardly moved."""

    def __init__(self, frames: int = 5) -> None:
        """`frames`: how many in a row."""
        if frames < 1:
            raise ValueError(f"{frames} frames are none")
        self._frames = frames
        self._last_px: Float | None = None
        self._last_s = 0.0
        self._in_a_row = 0

    @staticmethod
    def of(is_photo: bool) -> "Steadiness":
        """For a photo, whose only frame has to do, or for what moves."""
        return Steadiness(1) if is_photo else Steadiness()

    def add(self, tracked: TrackedFrame) -> bool:
        """Takes in the next frame; returns `is_steady`."""
        marker, time_s = tracked.marker, tracked.frame.time_s
        if marker is None or marker.bridged:
            self.reset()
            return False
        self._in_a_row = self._in_a_row + 1 if self._is_near(marker.corners_px, time_s) else 1
        self._last_px, self._last_s = marker.corners_px, time_s
        return self.is_steady

    @property
    def is_steady(self) -> bool:
        return self._in_a_row >= self._frames

    def reset(self) -> None:
        """Starts anew, as after a rewind."""
        self._last_px = None
        self._in_a_row = 0

    def _is_near(self, corners_px: Float, time_s: float) -> bool:
        if self._last_px is None:
            return False
        motion = np.linalg.norm(corners_px - self._last_px, axis=1).max() / side_lengths_px(self._last_px).min()
        return bool(motion <= min(MOST_SPEED * max(time_s - self._last_s, LEAST_APART_S), MOST_MOTION))
