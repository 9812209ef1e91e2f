"""The capture thread: reads a frame, tracks the marker in it, and hands both over as one value."""

import threading
import time
from collections.abc import Callable

from ashe_live.capture.sources import Source, SourceLost
from ashe_live.core.mailbox import Closed, LatestMailbox
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.tracking.tracker import Tracker

RECONNECT_EVERY_S = 0.5
FALLEN_BEHIND_S = 0.25


class Pipeline:
    """Runs a source and a tracker in a thread of their own; a clip at its own pace, a camera as fast as it comes.

    The mailbox holds the latest tracked frame. It is closed when nothing more can come: in order by `close`, with
    the error when the source fails for good. A lost camera is no end: `status` says so until it is back.
    """

    def __init__(self, source: Source, tracker: Tracker, loop: bool) -> None:
        self.frames = LatestMailbox[TrackedFrame]()
        self.status: str | None = None
        self._source = source
        self._tracker = tracker
        self._loop = loop
        self._flaw: str | None = None  # of a clip that goes round: what its end has told
        self._changed = threading.Condition()
        self._paused = False
        self._restart = False
        self._stopping = False
        self._due_s: float | None = None  # when the last frame was to be shown; None: start counting anew
        self._last_time_s = 0.0
        self._thread = threading.Thread(target=self._run, name="capture", daemon=True)

    @property
    def fps(self) -> float:
        """Nominal frames a second; 30 for a photo."""
        return self._source.fps or 30.0

    def start(self) -> None:
        self._thread.start()

    def pause(self, paused: bool) -> None:
        with self._changed:
            self._paused = paused
            self._changed.notify_all()

    def restart(self) -> None:
        """From the first frame; also at the end of the clip, and while paused (which it stays)."""
        with self._changed:
            self._restart = True
            self._changed.notify_all()

    def close(self, timeout_s: float = 0.7) -> None:
        """Ends the thread; one that hangs in a driver is left behind (it is a daemon)."""
        with self._changed:
            self._stopping = True
            self._changed.notify_all()
        self.frames.close()
        if self._thread.is_alive():
            self._thread.join(timeout_s)

    def _run(self) -> None:
        try:
            while not self._stopping:
                self._step()
        except Closed:
            pass
        except BaseException as error:  # whatever it is, the main thread must hear of it
            self.frames.close(error)
        finally:
            self._source.close()

    def _step(self) -> None:
        if self._paused:
            self._wait(lambda: not self._paused)
            self._due_s = None
        if self._take_restart():
            self._rewind()
        frame = self._read()
        if frame is None:
            if not self._source.is_live:
                self._end_of_clip()
            return
        self.status = self._flaw
        if self._source.is_live or self._is_on_time(frame):
            self.frames.put(self._tracker.track(frame))

    def _end_of_clip(self) -> None:
        if self._loop and not self._source.is_photo:
            self._flaw = self._source.note
            last_due_s = self._due_s
            self._rewind()
            if last_due_s is not None:  # the last frame is shown as long as any other
                self._due_s, self._last_time_s = last_due_s + 1 / self.fps, 0.0
            return
        if not self._source.is_photo:
            self.status = self._source.note or "end of the clip: R starts it again"
        self._wait(lambda: False)

    def _read(self) -> Frame | None:
        try:
            return self._source.read()
        except SourceLost as lost:
            self.status = f"{lost.message}: waiting for it to come back"
            while not self._stopping and not self._source.reopen():
                self._take_restart()  # a camera has no start, and the wait must not end for it at once
                self._wait(lambda: False, RECONNECT_EVERY_S)
            self._tracker.reset()
            return None

    def _is_on_time(self, frame: Frame) -> bool:
        """Waits until the frame is due. False for one that comes too late to be worth tracking."""
        now = time.monotonic()
        due = now if self._due_s is None else self._due_s + frame.time_s - self._last_time_s
        late_s = now - due
        if late_s > FALLEN_BEHIND_S:  # too slow a machine for the clip's pace: go on from here
            due = now
        elif late_s < 0:
            self._wait(lambda: self._paused, -late_s)
        self._due_s, self._last_time_s = due, frame.time_s
        return late_s * (self._source.fps or 0) <= 1 or late_s > FALLEN_BEHIND_S

    def _take_restart(self) -> bool:
        with self._changed:
            restart, self._restart = self._restart, False
            return restart

    def _rewind(self) -> None:
        self._source.rewind()
        self._tracker.reset()
        self._due_s = None

    def _wait(self, until: Callable[[], bool], timeout_s: float | None = None) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._stopping or self._restart or until(), timeout_s)
