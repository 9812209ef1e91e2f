"""`--quality auto`: the best preset that holds the display's rate on this machine."""

from collections import deque
from statistics import median

from ashe_live.quality import QUALITIES, Quality

LADDER = tuple(QUALITIES.values())
WINDOW_FRAMES = 60
# Where frames take long, so many of them that took this long together suffice to step down: 60 may take a minute.
SLOW_FRAMES, SLOW_MS = 9, 4000.0
TOO_SLOW = 0.9  # of the display's interval: step down before frames are dropped
AMPLE = 0.35  # of the display's interval: the next preset, at about twice the cost, would still fit
CALM_WINDOWS = 3  # windows in a row below AMPLE before a step up


class AutoQuality:
    """Chooses a preset by the median time of the last frames: steps up slowly and down at once.

    A step up that had to be taken back is not tried again, so that the quality does not oscillate.
    """

    def __init__(self, interval_ms: float, start: Quality) -> None:
        self.quality = start
        self._interval_ms = interval_ms
        self._times_ms: deque[float] = deque(maxlen=WINDOW_FRAMES)
        self._ample_windows = 0
        self._highest = len(LADDER) - 1

    def add(self, work_ms: float) -> bool:
        """Adds how long one frame took to track or draw, in milliseconds; returns whether `quality` has changed."""
        self._times_ms.append(work_ms)
        typical_ms = median(self._times_ms)
        are_slow = len(self._times_ms) >= SLOW_FRAMES and sum(self._times_ms) >= SLOW_MS
        is_early = are_slow and typical_ms > TOO_SLOW * self._interval_ms
        if len(self._times_ms) < WINDOW_FRAMES and not is_early:
            return False
        self._times_ms.clear()
        place = LADDER.index(self.quality)
        if typical_ms > TOO_SLOW * self._interval_ms:
            self._ample_windows = 0
            if place > 0:
                self._highest = place - 1
                self.quality = LADDER[place - 1]
                return True
            return False
        self._ample_windows = self._ample_windows + 1 if typical_ms < AMPLE * self._interval_ms else 0
        if self._ample_windows >= CALM_WINDOWS and place < self._highest:
            self._ample_windows = 0
            self.quality = LADDER[place + 1]
            return True
        return False
