"""Decides whether the marker has been still for long enough for a frame to be estimated."""

import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.square import side_lengths_px
from ashe_live.core.types import MarkerPose

MOST_MOTION = 0.06  # of a corner from one frame to the next, over the shortest side


class Steadiness:
    """Counts the frames in a row in which the marker was read and its corners hardly moved."""

    def __init__(self, frames: int = 5) -> None:
        """`frames`: how many in a row."""
        if frames < 1:
            raise ValueError(f"{frames} frames are none")
        self._frames = frames
        self._last_px: Float | None = None
        self._in_a_row = 0

    @staticmethod
    def of(is_photo: bool) -> "Steadiness":
        """For a photo, whose only frame has to do, or for what moves."""
        return Steadiness(1) if is_photo else Steadiness()

    def add(self, marker: MarkerPose | None) -> bool:
        """Takes in the next frame's marker; returns `is_steady`."""
        if marker is None or marker.bridged:
            self.reset()
            return False
        self._in_a_row = self._in_a_row + 1 if self._is_near(marker.corners_px) else 1
        self._last_px = marker.corners_px
        return self.is_steady

    @property
    def is_steady(self) -> bool:
        return self._in_a_row >= self._frames

    def reset(self) -> None:
        """Starts anew, as after a rewind."""
        self._last_px = None
        self._in_a_row = 0

    def _is_near(self, corners_px: Float) -> bool:
        if self._last_px is None:
            return False
        motion = np.linalg.norm(corners_px - self._last_px, axis=1).max()
        return bool(motion <= MOST_MOTION * side_lengths_px(self._last_px).min())
