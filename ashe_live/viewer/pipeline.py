"""The capture thread: reads a frame, tracks the marker in it, and hands both over as one value."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from ashe_live.capture.sources import Seekable, Source, SourceLost
from ashe_live.core.mailbox import Closed, LatestMailbox
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.tracker import Tracker
from ashe_live.viewer.pace import Pace

RECONNECT_EVERY_S = 0.5
# A disk that must wake up or a camera that adjusts itself takes less.
STALLED_AFTER_S = 2.0


@dataclass(frozen=True, slots=True)
class _Place:
    """A frame of a clip."""

    time_s: float
    index: int | None = None  # None: what is shown at `time_s`


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
        self._clip = source if isinstance(source, Seekable) else None
        self._loop = loop
        self._pace = Pace()
        self._flaw: str | None = None  # of a clip that goes round: what its end has told
        self._changed = threading.Condition()
        self._paused = False
        self._restart = False
        self._wanted: _Place | None = None  # where to go on; the latest wish only, so that none queues
        self._shown = self._at = _Place(0.0, 0)  # handed over last; the same, or what is on its way
        self._has_ended = False
        self._stopping = False
        self._left_out: Frame | None = None  # the last frame, if it came too late
        self._asked_s: float | None = None  # since when the source has been asked for a frame; None: it is not
        self._thread = threading.Thread(target=self._run, name="capture", daemon=True)

    @property
    def fps(self) -> float:
        """Nominal frames a second; 30 for a photo."""
        return self._source.fps or 30.0

    @property
    def is_clip(self) -> bool:
        """Whether one can go to and fro in it."""
        return self._clip is not None

    @property
    def is_photo(self) -> bool:
        return self._source.is_photo

    @property
    def duration_s(self) -> float | None:
        """Of a clip from its first frame to its last, where it is known."""
        return None if self._clip is None else self._clip.duration_s

    @property
    def has_ended(self) -> bool:
        """Whether a clip stands at its end."""
        return self._has_ended

    @property
    def stall(self) -> str | None:
        """What to say of a source that neither gives a frame nor fails: a network that hangs, a driver."""
        asked_s = self._asked_s
        if asked_s is None or time.monotonic() - asked_s < STALLED_AFTER_S:
            return None
        return f"{self._source.name} has given no picture for {time.monotonic() - asked_s:.0f} s: waiting for it"

    def start(self) -> None:
        self._thread.start()

    def pause(self, paused: bool) -> None:
        with self._changed:
            self._paused = paused
            self._changed.notify_all()

    def restart(self) -> None:
        """From the first frame; also at the end of the clip, and while paused (which it stays)."""
        with self._changed:
            self._restart, self._wanted = True, None
            self._changed.notify_all()

    def play(self, speed: float, loop: bool) -> None:
        """From now on at `speed` times a clip's own pace, and again and again or once."""
        with self._changed:
            self._pace.speed, self._loop = speed, loop
            self._changed.notify_all()

    def seek(self, time_s: float) -> None:
        """Goes on from what a clip shows then; while paused it shows that frame."""
        if self._clip is None:
            return
        with self._changed:
            self._wanted = _Place(max(0.0, time_s if self.duration_s is None else min(time_s, self.duration_s)))
            self._changed.notify_all()

    def seek_by(self, seconds: float) -> None:
        """From where it is, or will be once it has gone where it was sent last."""
        with self._changed:
            place = self._wanted or self._at
        self.seek(place.time_s + seconds)

    def step(self, frames: int) -> None:
        """Pauses at the frame that comes so many after the one that is shown, or before it; at the ends it stays."""
        if self._clip is None:
            return
        with self._changed:
            self._paused = True
            place = self._wanted or self._at
            if place.index is not None:
                self._wanted = _Place(place.time_s + frames / self.fps, max(0, place.index + frames))
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
            self._pace.begin_anew()
        if self._take_restart():
            self._rewind()
            self._pace.begin_anew()
        self._go_where_sent()
        frame = self._read()
        if frame is None:
            if not self._source.is_live:
                self._end_of_clip()
            return
        self.status = self._flaw
        is_on_time = self._source.is_live or self._is_on_time(frame)
        if self._wanted is not None:
            return
        self._left_out = None if is_on_time else frame
        if is_on_time:
            self._hand_over(frame)

    def _hand_over(self, frame: Frame) -> None:
        with self._changed:
            self._shown = self._at = _Place(frame.time_s, frame.index)
        self.frames.put(self._tracker.track(frame))

    def _end_of_clip(self) -> None:
        self._at = self._shown
        if self._paused and self._clip is not None:  # stepped off the end
            return
        if self._loop and not self._source.is_photo:
            self._flaw = self._source.note
            self._rewind()
            self._pace.go_round(1 / self.fps)
            return
        if self._left_out is not None:  # it stays on screen, so it counts
            self._hand_over(self._left_out)
            self._left_out = None
        if not self._source.is_photo:
            self.status = self._source.note or "end of the clip: R starts it again"
        self._has_ended = self._clip is not None
        self._wait(lambda: self._loop and self._has_ended)
        self._has_ended = False

    def _read(self) -> Frame | None:
        self._asked_s = time.monotonic()
        try:
            frame = self._source.read()
            if frame is not None and frame.size != self._source.size:
                given, wanted = (f"{width}x{height}" for width, height in (frame.size, self._source.size))
                raise UserError(f"{self._source.name} gives a picture of {given} and not {wanted}", "start again")
            return frame
        except SourceLost as lost:
            self._asked_s = None
            self.status = f"{lost.message}: waiting for it to come back"
            while not self._stopping and not self._source.reopen():
                self._take_restart()  # a camera has no start, and the wait must not end for it at once
                self._wait(lambda: False, RECONNECT_EVERY_S)
            self._tracker.reset()
            return None
        finally:
            self._asked_s = None

    def _is_on_time(self, frame: Frame) -> bool:
        """Waits until the frame is due. False for one that is too late, or too soon after another, to be tracked."""
        due = self._pace.next(frame.time_s, 1 / self.fps, time.monotonic())
        if due.wait_s > 0:
            self._wait(lambda: self._paused, due.wait_s)
        return due.is_shown

    def _go_where_sent(self) -> None:
        """The next frame in a row is tracked from the one before; anything else is a cut."""
        with self._changed:
            wanted, self._wanted = self._wanted, None
            before, self._at = self._at, wanted or self._at
        if wanted is None or self._clip is None:
            return
        if wanted.index is None:
            self._clip.seek(wanted.time_s)
        else:
            self._clip.seek_frame(wanted.index)
        if wanted.index is None or before.index is None or wanted.index != before.index + 1:
            self._tracker.jump()
        self._pace.begin_anew()

    def _take_restart(self) -> bool:
        with self._changed:
            restart, self._restart = self._restart, False
            return restart

    def _rewind(self) -> None:
        self._source.rewind()
        self._tracker.reset()

    def _wait(self, until: Callable[[], bool], timeout_s: float | None = None) -> None:
        with self._changed:
            self._changed.wait_for(
                lambda: self._stopping or self._restart or self._wanted is not None or until(), timeout_s
            )
