"""What choosing the key views costs the capture thread, and what they take of memory."""

import time
from dataclasses import dataclass

from ashe_live.capture.sources import Source
from ashe_live.light.live.key_views import KeyViews
from ashe_live.tracking.tracker import MarkerTracker


@dataclass(frozen=True, slots=True)
class KeyViewTimes:
    """What choosing the key views costs."""

    add_ms: list[float]  # of the thread's processor time, for each frame
    mib: float  # at most, of all pictures kept


def time_key_views(source: Source, tracker: MarkerTracker, frames: int) -> KeyViewTimes:
    """Chooses views from `frames` of the clip, anew each time that it begins again."""
    key_views, most_bytes = KeyViews(), 0
    add_ms: list[float] = []
    source.rewind()
    tracker.reset()
    while len(add_ms) < frames:
        frame = source.read()
        if frame is None:
            source.rewind()
            tracker.reset()
            key_views.drop()
            continue
        tracked = tracker.track(frame)
        begun_s = time.thread_time()
        key_views.add(tracked)
        add_ms.append((time.thread_time() - begun_s) * 1e3)
        most_bytes = max(most_bytes, key_views.nbytes)
    return KeyViewTimes(add_ms, most_bytes / 2**20)
