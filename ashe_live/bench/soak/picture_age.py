"""The age of pictures on the screen, and whether it stays within the bound that the design guarantees.

As there are no queues, a picture on the screen is never older than one display interval plus the time for its own
tracking and drawing. When the display starts the next picture it takes the newest tracked frame; that one was handed
over after the display had last checked, hence at most one interval ago.
"""

import numpy as np

from ashe_live.bench.soak.offscreen_window import OffscreenWindow, ShownPicture
from ashe_live.bench.soak.time_code import TimeCodeCamera, read_number
from ashe_live.core.contract import Json
from ashe_live.viewer.output.report import frame_time_percentiles
from ashe_live.viewer.session import Session

# Hand-over between threads: a thread must be woken and get Python's lock, which its holder releases within 5 ms.
HAND_OVER_MS = 5.0


class PictureAges:
    """Reads the number of each picture from the screen. Repeated pictures count once."""

    def __init__(self, camera: TimeCodeCamera, window: OffscreenWindow, session: Session) -> None:
        self._camera = camera
        self._window = window
        self._session = session
        self._age_ms: list[float] = []
        self._over_ms: list[float] = []
        self._unread = self._backwards = 0
        self._last_begun_s: float | None = None
        self._last_number = -1

    def add(self, picture: ShownPicture) -> None:
        number = read_number(self._window.read_bgr())
        tracked, last_begun_s, self._last_begun_s = self._session.tracked, self._last_begun_s, picture.begun_s
        if tracked is None or last_begun_s is None or number == self._last_number:
            return
        if number is None:
            self._unread += 1
            return
        self._backwards += number < self._last_number
        self._last_number = number
        age_s = picture.shown_s - self._camera.taken_s(number)
        own_s = tracked.detect_ms * 1e-3 + picture.shown_s - picture.begun_s
        self._age_ms.append(age_s * 1e3)
        self._over_ms.append((age_s - own_s - (picture.begun_s - last_begun_s)) * 1e3)

    def to_json(self) -> Json:
        """Percentiles of the age, and of `over_bound_ms`: the age less tracking, drawing and interval."""
        over_ms = np.array(self._over_ms)
        return {
            "pictures": len(self._age_ms),
            "unread": self._unread,
            "backwards": int(self._backwards),
            "age_ms": frame_time_percentiles(self._age_ms),
            "over_bound_ms": frame_time_percentiles(self._over_ms),
            "longest_over_bound_ms": float(over_ms.max()) if len(over_ms) else None,
            "within_bound_share": float(np.mean(over_ms <= 0)) if len(over_ms) else None,
            "within_hand_over_share": float(np.mean(over_ms <= HAND_OVER_MS)) if len(over_ms) else None,
        }
