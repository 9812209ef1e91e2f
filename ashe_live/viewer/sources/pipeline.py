"""The capture thread as seen from the main thread: the requests that it takes, and the state that it reports."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ashe_live.capture.sources import Seekable, Source
from ashe_live.light.live.key_views import KeyViews
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.sources.capture_loop import PHOTO_FPS, CaptureLoop
from ashe_live.viewer.sources.exchange import FIRST_FRAME, ClipPosition, Exchange, Jump, Wish
from ashe_live.viewer.sources.tracked_frames import TrackedFrames

# Longer than a disk takes to wake up, or a camera to adjust itself.
STALLED_AFTER_S = 2.0


class Pipeline:
    """Runs a source and a tracker in a thread of their own: a clip at its own pace, a camera as fast as frames arrive.

    The mailbox `frames` holds the latest tracked frame. It is closed when no more frames can come: by `close`, or with
    the error when the source fails for good. A lost camera does not close it; `status` reports the loss until
    the camera is back. After `start`, source and tracker belong to the capture thread. For use by one other thread at a
    time.
    """

    def __init__(
        self,
        source: Source,
        tracker: MarkerTracker,
        loop: bool,
        tracker_for: Callable[[str | None, float | None], MarkerTracker] | None = None,
    ) -> None:
        """`tracker_for` makes a tracker for another marker (its spec) or for a camera with another field of view
        (degrees); it is called in the capture thread.
        """
        self.frames = TrackedFrames()
        self.key_views = KeyViews()  # of the scene that is shown; emptied by a jump
        self._source = source
        self._first_marker = tracker.marker.spec
        self._wish = Wish(loop)
        self._wishes = LatestMailbox[Wish]()
        exchange = Exchange(self._wishes, self.frames, self.key_views)
        self._capture = CaptureLoop(source, tracker, self._wish, exchange, tracker_for)
        self.may_follow_others = tracker_for is not None
        self._thread = threading.Thread(target=self._capture.run, name="capture", daemon=True)

    @property
    def name(self) -> str:
        """The source's name, as shown to the user."""
        return self._source.name

    @property
    def marker(self) -> str:
        """The spec of the marker that is followed, or will be from the next frame on."""
        return self._wish.following.marker or self._first_marker

    @property
    def fps(self) -> float:
        """Nominal frames a second."""
        return self._source.fps or PHOTO_FPS

    @property
    def is_clip(self) -> bool:
        """Whether the source is a clip, in which one can seek."""
        return isinstance(self._source, Seekable)

    @property
    def clip_path(self) -> Path | None:
        """The clip's path as the user gave it; None if the source is no clip."""
        return self._source.path if isinstance(self._source, Seekable) else None

    @property
    def is_camera(self) -> bool:
        """Whether the source is a live camera, which may be moved."""
        return self._source.is_live

    @property
    def is_photo(self) -> bool:
        return self._source.is_photo

    @property
    def duration_s(self) -> float | None:
        """Seconds from a clip's first frame to its last; None if unknown, or if the source is no clip."""
        return self._source.duration_s if isinstance(self._source, Seekable) else None

    @property
    def status(self) -> str | None:
        """A message about the source: the end of the clip, a lost camera, a damaged file; None when there is none."""
        return self._capture.state.status

    @property
    def has_ended(self) -> bool:
        """Whether a clip has been played to its end."""
        return self._capture.state.has_ended

    @property
    def stall(self) -> str | None:
        """A message when a read has hung for more than STALLED_AFTER_S, e.g. in a driver; else None."""
        asked_s = self._capture.state.asked_s
        if asked_s is None or time.monotonic() - asked_s < STALLED_AFTER_S:
            return None
        return f"{self._source.name} has given no picture for {time.monotonic() - asked_s:.0f} s: waiting for it"

    def start(self) -> None:
        self._thread.start()

    def pause(self, paused: bool) -> None:
        self._ask(paused=paused)

    def restart(self) -> None:
        """Plays again from the first frame; while paused, shows that frame and stays paused."""
        self._ask(jump=Jump(FIRST_FRAME, rewinds=True))

    def play(self, speed: float, loop: bool) -> None:
        """Plays at `speed` times the clip's own rate, in a loop or once."""
        self._ask(speed=speed, loop=loop)

    def track_with(self, preset: TrackingPreset) -> None:
        """Makes the tracker use `preset` from the next frame on."""
        self._ask(tracking=preset)

    def follow(self, spec: str) -> None:
        """Tracks another marker from the next frame on; a photo, or a clip at its end, is started again for it."""
        self._track_otherwise(marker=spec)

    def see_by(self, hfov_deg: float | None) -> None:
        """Assumes another horizontal field of view, in degrees, from the next frame on; None: as at the start."""
        self._track_otherwise(hfov_deg=hfov_deg)

    def seek(self, time_s: float) -> None:
        """Continues from the frame at `time_s`; while paused, shows that frame. Ignored if the source is no clip."""
        if self.is_clip:
            last_s = self.duration_s
            self._ask(jump=Jump(ClipPosition(max(0.0, time_s if last_s is None else min(time_s, last_s)))))

    def seek_by(self, seconds: float) -> None:
        """Seeks by an amount of time, relative to the target of a pending jump if there is one."""
        self.seek(self._bound_for.time_s + seconds)

    def step(self, frames: int) -> None:
        """Pauses, and moves by `frames` frames (backwards if negative), within the clip."""
        if not self.is_clip:
            return
        at, jump = self._bound_for, self._wish.jump
        if at.index is not None:
            jump = Jump(ClipPosition(at.time_s + frames / self.fps, max(0, at.index + frames)))
        self._ask(paused=True, jump=jump)

    def close(self, timeout_s: float = 0.7) -> None:
        """Ends the thread. If it hangs in a driver, it is left behind (it is a daemon thread)."""
        self._wishes.close()
        self.frames.close()
        if self._thread.is_alive():
            self._thread.join(timeout_s)

    @property
    def _bound_for(self) -> ClipPosition:
        """The target of a pending jump, else the place where the capture thread is."""
        state, jump = self._capture.state, self._wish.jump
        return state.at if jump is None or jump is state.obeyed else jump.position

    def _track_otherwise(self, **changes: Any) -> None:
        if self.may_follow_others:
            following = replace(self._wish.following, **changes)
            self.frames.ask_for(following)  # first, as the capture thread may be quicker than this one
            self._ask(following=following)
            if self.is_photo or self.has_ended:
                self.restart()

    def _ask(self, **changes: Any) -> None:
        self._wish = replace(self._wish, **changes)
        if not self._wishes.is_closed:  # only `close` closes it, in this thread
            self._wishes.put(self._wish)
