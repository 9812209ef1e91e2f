"""The capture thread as the main thread sees it: what can be asked of it, and what it reports."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ashe_live.capture.sources import Seekable, Source
from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.key_views import KeyViews
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.tracking.preset import TrackingPreset
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.sources.capture_loop import FIRST_FRAME, CaptureLoop, Jump, Place, Wish

# A disk that must wake up or a camera that adjusts itself takes less.
STALLED_AFTER_S = 2.0


class Pipeline:
    """Runs a source and a tracker in a thread of their own; a clip at its own pace, a camera as fast as it comes.

    The mailbox holds the latest tracked frame. It is closed when nothing more can come: in order by `close`, with
    the error when the source fails for good. A lost camera is no end: `status` says so until it is back. From `start`
    on source and tracker belong to that thread. For use by one other thread at a time.
    """

    def __init__(
        self,
        source: Source,
        tracker: MarkerTracker,
        loop: bool,
        tracker_for: Callable[[str | None, float | None], MarkerTracker] | None = None,
    ) -> None:
        """`tracker_for` makes one for another marker, named by its spec, or for a camera with another field of view, in
        degrees; it is called in that thread.
        """
        self.frames = LatestMailbox[TrackedFrame]()
        self.key_views = KeyViews()  # of what is shown; none from before a jump
        self._source = source
        self._first_marker = tracker.marker.spec
        self._wish = Wish(loop)
        self._wishes = LatestMailbox[Wish]()
        self._capture = CaptureLoop(source, tracker, self._wish, self._wishes, self.frames, self.key_views, tracker_for)
        self.may_follow_others = tracker_for is not None
        self._thread = threading.Thread(target=self._capture.run, name="capture", daemon=True)

    @property
    def name(self) -> str:
        """Of the source, for a person."""
        return self._source.name

    @property
    def marker(self) -> str:
        """The spec of what is followed, or will be from the next frame on."""
        return self._wish.marker or self._first_marker

    @property
    def fps(self) -> float:
        """Nominal frames a second; 30 for a photo."""
        return self._source.fps or 30.0

    @property
    def is_clip(self) -> bool:
        """Whether it can be sought in."""
        return isinstance(self._source, Seekable)

    @property
    def clip_path(self) -> Path | None:
        """As it was named; None of what is no clip."""
        return self._source.path if isinstance(self._source, Seekable) else None

    @property
    def is_camera(self) -> bool:
        """Whether somebody may move it."""
        return self._source.is_live

    @property
    def is_photo(self) -> bool:
        return self._source.is_photo

    @property
    def duration_s(self) -> float | None:
        """From a clip's first frame to its last; None where that is not known, and for anything but a clip."""
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
        """A message when a read has hung for long, in a driver or a network; else None."""
        asked_s = self._capture.state.asked_s
        if asked_s is None or time.monotonic() - asked_s < STALLED_AFTER_S:
            return None
        return f"{self._source.name} has given no picture for {time.monotonic() - asked_s:.0f} s: waiting for it"

    def start(self) -> None:
        self._thread.start()

    def pause(self, paused: bool) -> None:
        self._ask(paused=paused)

    def restart(self) -> None:
        """Plays from the first frame, also from the clip's end; while paused it shows that frame and stays paused."""
        self._ask(jump=Jump(FIRST_FRAME, rewinds=True))

    def play(self, speed: float, loop: bool) -> None:
        """Plays at `speed` times the clip's own rate, in a loop or once."""
        self._ask(speed=speed, loop=loop)

    def track_with(self, preset: TrackingPreset) -> None:
        """Has the tracker use `preset` from the next frame on."""
        self._ask(tracking=preset)

    def follow(self, spec: str) -> None:
        """Has another marker tracked from the next frame on; on a photo, or at the end, the last frame comes again."""
        self._track_otherwise(marker=spec)

    def see_by(self, hfov_deg: float | None) -> None:
        """Takes the camera's picture for so many degrees wide, as `follow`; None: as at the start."""
        self._track_otherwise(hfov_deg=hfov_deg)

    def seek(self, time_s: float) -> None:
        """Continues from what a clip shows at `time_s`; while paused it shows that frame. For clips only."""
        if self.is_clip:
            last_s = self.duration_s
            self._ask(jump=Jump(Place(max(0.0, time_s if last_s is None else min(time_s, last_s)))))

    def seek_by(self, seconds: float) -> None:
        """Seeks by an amount of time, counted from a jump that is pending if there is one."""
        self.seek(self._bound_for.time_s + seconds)

    def step(self, frames: int) -> None:
        """Pauses `frames` after the frame that is shown (before it if negative), and not beyond the clip's ends."""
        if not self.is_clip:
            return
        place, jump = self._bound_for, self._wish.jump
        if place.index is not None:
            jump = Jump(Place(place.time_s + frames / self.fps, max(0, place.index + frames)))
        self._ask(paused=True, jump=jump)

    def close(self, timeout_s: float = 0.7) -> None:
        """Ends the thread; one that hangs in a driver is left behind (it is a daemon)."""
        self._wishes.close()
        self.frames.close()
        if self._thread.is_alive():
            self._thread.join(timeout_s)

    @property
    def _bound_for(self) -> Place:
        """Where a pending jump leads, else where the capture thread is."""
        state, jump = self._capture.state, self._wish.jump
        return state.at if jump is None or jump is state.obeyed else jump.place

    def _track_otherwise(self, **changes: Any) -> None:
        if self.may_follow_others:
            self._ask(**changes)
            if self.is_photo or self.has_ended:
                self.restart()

    def _ask(self, **changes: Any) -> None:
        self._wish = replace(self._wish, **changes)
        if not self._wishes.is_closed:  # only `close` closes it, in this thread
            self._wishes.put(self._wish)
