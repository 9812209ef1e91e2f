"""Decides when the frames of a clip are due, and which of them are skipped."""

import math
from copy import copy
from typing import NamedTuple

FALLEN_BEHIND_S = 0.25
# So long at most no frame is shown, however late all are: a machine that hardly decodes in time shows these alone.
LONGEST_GAP_S = 0.25
# At a higher rate a clip would have more frames than displays show.
FAST_HZ = 60.0


class Due(NamedTuple):
    """When to show a frame, and whether to."""

    wait_s: float  # not positive: show it now
    is_shown: bool  # False: too late for it, or too soon after the one before


class Pace:
    """Schedules frames at `speed` times a clip's own rate. `time_s` is in the clip's time, `now_s` is the clock's."""

    def __init__(self) -> None:
        self.speed = 1.0
        self._due_s: float | None = None  # when the last frame was due; None: the next one starts the schedule
        self._time_s = 0.0
        self._from_s = -math.inf  # where in a clip's time the schedule starts, if later than its first frame
        self._shown_s = -math.inf  # when the last frame was shown
        self._next_fast_s = -math.inf  # at high speeds no frame is shown before this

    def begin_anew(self, from_s: float = -math.inf) -> None:
        """Starts the schedule with the next frame, which is shown as soon as it comes.

        `from_s`: a time in the clip at which that frame is shown still, as in a pause of a screen recording.
        """
        self._due_s, self._next_fast_s, self._from_s = None, -math.inf, from_s

    def go_round(self, period_s: float) -> None:
        """Continues with the first frame after the last, which is shown as long as any other."""
        if self._due_s is not None:
            self._due_s, self._time_s = self._due_s + period_s / self.speed, 0.0

    def shows(self, time_s: float, period_s: float, now_s: float) -> bool:
        """Whether `next` would have the frame shown; nothing is scheduled."""
        return copy(self).next(time_s, period_s, now_s).is_shown

    def next(self, time_s: float, period_s: float, now_s: float) -> Due:
        """Schedules the next frame of a clip that has one every `period_s`."""
        if self._due_s is None:
            time_s = max(time_s, self._from_s)
        due_s = now_s if self._due_s is None else self._due_s + (time_s - self._time_s) / self.speed
        late_s, period_s = now_s - due_s, period_s / self.speed
        if late_s > FALLEN_BEHIND_S:  # the machine is too slow for this rate: continue from here
            due_s = now_s
        self._due_s, self._time_s = due_s, time_s
        if self.speed > 1 and due_s < self._next_fast_s:
            return Due(-late_s, False)
        # Half a period early, because the frame rates of most clips do not divide the display's evenly.
        self._next_fast_s = due_s + 1 / FAST_HZ - period_s / 2
        is_shown = late_s <= period_s or late_s > FALLEN_BEHIND_S or now_s - self._shown_s > LONGEST_GAP_S
        if is_shown:
            self._shown_s = now_s + max(0.0, -late_s)
        return Due(-late_s, is_shown)
