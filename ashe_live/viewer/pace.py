"""When the frames of a clip are due, and which of them are not worth the work."""

import math
from typing import NamedTuple

FALLEN_BEHIND_S = 0.25
# Played faster, a clip has more frames than displays show.
FAST_HZ = 60.0


class Due(NamedTuple):
    """What is to become of a frame."""

    wait_s: float  # not positive: now
    is_shown: bool  # False: too late for it, or too soon after the one before


class Pace:
    """A clip's own pace, times `speed`. A frame's time is the clip's, `now_s` the clock's."""

    def __init__(self) -> None:
        self.speed = 1.0
        self._due_s: float | None = None  # when the last frame was to be shown; None: start counting anew
        self._time_s = 0.0
        self._next_fast_s = -math.inf  # no frame is shown before it when there are too many

    def begin_anew(self) -> None:
        """The next frame is due when it comes, and shown."""
        self._due_s, self._next_fast_s = None, -math.inf

    def go_round(self, period_s: float) -> None:
        """The first frame comes after the last, which is shown as long as any other."""
        if self._due_s is not None:
            self._due_s, self._time_s = self._due_s + period_s / self.speed, 0.0

    def next(self, time_s: float, period_s: float, now_s: float) -> Due:
        """Of the next frame, in a clip that shows a frame every `period_s`."""
        due_s = now_s if self._due_s is None else self._due_s + (time_s - self._time_s) / self.speed
        late_s, period_s = now_s - due_s, period_s / self.speed
        if late_s > FALLEN_BEHIND_S:  # too slow a machine for the clip's pace: go on from here
            due_s = now_s
        self._due_s, self._time_s = due_s, time_s
        if self.speed > 1 and due_s < self._next_fast_s:
            return Due(-late_s, False)
        # Half a period early, as the frames of most clips do not divide a display's pictures evenly.
        self._next_fast_s = due_s + 1 / FAST_HZ - period_s / 2
        return Due(-late_s, late_s <= period_s or late_s > FALLEN_BEHIND_S)
