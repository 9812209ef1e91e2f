"""Follows where the marker lies in the room, so that a marker that is moved is told from a camera that is.

Light belongs to the room: where somebody turns the marker's sheet, it turns the other way in the marker's frame.
"""

import math
from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, frozen_floats
from ashe_live.core.camera import scaled_pixels
from ashe_live.core.transforms import rigid
from ashe_live.core.types import TrackedFrame
from ashe_live.tracking.still_frame import UNMOVED, StillFrame

LEAST_MOTION_PX = 2.5  # of the marker in the compared picture, from which on it is asked what has moved
AT_REST_PX = 0.3  # what counts as no motion of the marker from frame to frame, in the same picture
COMPARED_EVERY_S = 0.1  # while the marker is not moved
# A frame is taken for the next ones to be compared with after this long, if the camera has moved since.
RENEWED_S = 0.4
FLAT, FLAT_SIDES = math.sin(math.radians(2.5)), 0.08  # tilt, and height in sides, that count as those of the table
MOST_REMEMBERED = 10_000  # frames from which on the marker lay elsewhere, for steps back in a clip: 4 MB
LOST_S = 2.0  # after which a frame that cannot be compared begins anew, and the marker counts as unmoved since


class MarkerPlace:
    """Where the marker lies in the room, frame by frame. For use by one thread."""

    def __init__(self) -> None:
        self.rewind()

    def rewind(self) -> None:
        """The next frame is the first one again."""
        self._T_room_marker: Float = UNMOVED
        self._places: dict[int, Float] = {}  # by the index of the frame from which on it lay there
        self.forget()

    def forget(self) -> None:
        """The next frame cannot be compared with the ones before, as after a cut or a step back in a clip.

        The marker lies where it lay when that frame was seen, or else where it was seen last.
        """
        self._before: StillFrame | None = None
        self._last_px: Float | None = None
        self._known_s = self._compared_s = -math.inf
        self._is_moving = False

    def add(self, tracked: TrackedFrame) -> TrackedFrame:
        """The frame with `T_room_marker`; frames must come in the order of time."""
        before = self._T_room_marker
        if tracked.marker is None:
            self._last_px = None
        elif self._before is None or not self._before.is_comparable(tracked):
            self._T_room_marker = self._remembered(tracked.frame.index)
            self._begin(tracked)
        elif not tracked.marker.bridged:
            self._compare(tracked, self._before)
        if self._T_room_marker is not before:
            self._places[tracked.frame.index] = self._T_room_marker
            if len(self._places) > MOST_REMEMBERED:
                del self._places[next(iter(self._places))]
        return replace(tracked, T_room_marker=self._T_room_marker)

    def _compare(self, tracked: TrackedFrame, before: StillFrame) -> None:
        """Where the marker lies in the frame, by the ground around it in one from `before`, when it lay still."""
        corners_px, time_s = scaled_pixels(tracked.pose.corners_px, before.scale), tracked.frame.time_s
        is_at_rest = self._last_px is not None and np.abs(corners_px - self._last_px).max() < AT_REST_PX
        self._last_px = corners_px
        if np.abs(corners_px - before.corners_px).max() < LEAST_MOTION_PX:
            # Where it was, and if it was moved in between, it is back.
            self._known_s, self._is_moving, self._T_room_marker = time_s, False, before.T_room_marker
            return
        if not (self._is_moving or time_s - self._compared_s >= COMPARED_EVERY_S):
            return
        self._compared_s = time_s
        T_old_new = before.motion(tracked)
        self._is_moving = T_old_new is not UNMOVED
        if T_old_new is None:
            is_over = time_s - self._known_s > LOST_S
        elif self._is_moving:
            self._known_s, is_over = time_s, is_at_rest
            lies = _laid_flat(before.T_room_marker @ T_old_new, before.side_m)
            self._T_room_marker = frozen_floats(lies, (4, 4), "T_room_marker")
        else:
            self._known_s, is_over = time_s, time_s - before.time_s > RENEWED_S
            self._T_room_marker = before.T_room_marker
        if is_over:
            self._begin(tracked)

    def _remembered(self, index: int) -> Float:
        """(4, 4) where the marker lay in a frame, by the frames before it that were seen."""
        return self._places.get(max((each for each in self._places if each <= index), default=-1), UNMOVED)

    def _begin(self, tracked: TrackedFrame) -> None:
        self._before = StillFrame.of(tracked, self._T_room_marker)
        self._known_s, self._is_moving = tracked.frame.time_s, False


def _laid_flat(T_room_marker: Float, side_m: float) -> Float:
    """The same (4, 4), without a tilt or height that is as small as the pose's errors, as of a sheet on a table."""
    tilt, height = T_room_marker[2, :2], T_room_marker[2, 3]
    if np.linalg.norm(tilt) > FLAT or abs(height) > FLAT_SIDES * side_m or T_room_marker[2, 2] < 0:
        return T_room_marker
    turn = math.atan2(T_room_marker[1, 0] - T_room_marker[0, 1], T_room_marker[0, 0] + T_room_marker[1, 1])
    return rigid(cv2.Rodrigues(np.array([0.0, 0.0, turn]))[0], [*T_room_marker[:2, 3], 0.0])
