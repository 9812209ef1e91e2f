"""The loop of the capture thread: reads a frame, tracks the marker in it, and hands both over as one value.

The main thread requests everything by one immutable value, a Wish, and reads one immutable value, the State. So neither
is ever seen half changed, and no lock is held while a frame is read or tracked.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ashe_live.capture.sources import Seekable, Source, SourceLost
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.process.mailbox import Closed
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.sources.exchange import ClipPosition, Exchange, State, Wish
from ashe_live.viewer.sources.pace import Pace
from ashe_live.viewer.sources.scene_tracker import SceneTracker

PHOTO_FPS = 30.0  # nominal: a photo has no rate of its own
RECONNECT_EVERY_S = 0.5
# Every wait has a timeout; a new wish, or the end, interrupts it at once.
LONGEST_WAIT_S = 1.0


class _OtherSizeError(UserError):
    """A picture of another size than the first one."""


class CaptureLoop:
    """Used by the capture thread only, except for `state`, which any thread may read."""

    def __init__(
        self,
        source: Source,
        tracker: MarkerTracker,
        wish: Wish,
        exchange: Exchange,
        tracker_for: Callable[[str | None, float | None], MarkerTracker] | None = None,
    ) -> None:
        self.state = State()
        self._source, self._size = source, source.size
        self._scene = SceneTracker(tracker, exchange.key_views)
        self._clip = source if isinstance(source, Seekable) else None
        self._wish = wish
        self._wishes = exchange.wishes
        self._tracker_for = tracker_for
        self._frames = exchange.frames
        self._period_s = 1 / (source.fps or PHOTO_FPS)
        self._pace = Pace()
        self._has_failed = False  # a clip, which is read from its start before anything else
        self._flaw: str | None = None  # of a looped clip: its source's note at the end, e.g. that it is truncated
        self._sought_s = -math.inf  # where the next frame was jumped to, if that may be long after its own time
        self._left_out: Frame | None = None  # the last frame, if it was skipped for being late
        self._shown: Frame | None = None  # the last frame that was handed over
        self._shown_by = wish.following  # how it was tracked

    def run(self) -> None:
        """Runs until `wishes` is closed, or the source fails for good; then `frames` is closed with the error."""
        try:
            while True:
                try:
                    self.step()
                except UserError as error:
                    if self._clip is None or self._shown is None:
                        raise
                    self._wait_for_another_try(error)
        except Closed:
            pass
        except BaseException as error:  # whatever it is, the main thread must hear of it
            self._frames.close(error)
        finally:
            self._source.close()

    def step(self) -> None:
        """Reads one frame and hands it over when it is due, or handles the source's end or loss. Raises Closed."""
        self._take_wish(0.0)
        if self._wish.paused:
            self._wait(lambda: not self._wish.paused)
            self._pace.begin_anew()
        self._go_where_sent()
        if self._is_passed_over():
            return
        frame = self._read()
        if frame is None:
            if not self._source.is_live:
                self._end_of_clip()
            return
        self._publish(status=self._flaw)
        is_on_time = self._source.is_live or self._is_on_time(frame)
        if self._is_sent:
            return
        self._left_out = None if is_on_time else frame
        if is_on_time:
            self._hand_over(frame)

    @property
    def _is_sent(self) -> bool:
        """Whether a requested jump has not been carried out yet."""
        return self._wish.jump is not self.state.obeyed

    def _publish(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)

    def _take_wish(self, timeout_s: float) -> None:
        wish = self._wishes.take(timeout_s)
        if wish is None:
            return
        is_other = wish.following != self._wish.following
        if is_other and self._tracker_for is not None:
            self._scene.follow(self._tracker_for(wish.following.marker, wish.following.hfov_deg))
        self._wish = wish
        self._pace.speed = wish.speed
        if wish.tracking is not None:
            self._scene.track_with(wish.tracking)
        if (wish.paused or self.state.has_ended) and not self._is_sent:
            self._show_as_asked()

    def _wait(self, until: Callable[[], bool], timeout_s: float | None = None) -> None:
        """Waits until the condition holds, a jump is requested, or the time is over. Raises Closed if asked to end."""
        end_s = None if timeout_s is None else time.monotonic() + timeout_s
        while not (self._is_sent or until()):
            left_s = LONGEST_WAIT_S if end_s is None else end_s - time.monotonic()
            if left_s <= 0:
                return
            self._take_wish(min(left_s, LONGEST_WAIT_S))

    def _hand_over(self, frame: Frame) -> None:
        position = ClipPosition(frame.time_s, frame.index)
        # In a clip's pause seconds forwards lead on from where the last ones led, and not to the same frame again.
        at, self._sought_s = replace(position, time_s=max(frame.time_s, self._sought_s)), -math.inf
        self._publish(shown=position, at=at)
        self._shown, self._shown_by = frame, self._wish.following
        tracked = self._scene.track(frame)
        self._frames.put(tracked, self._wish.following)
        # After handing over, so that the display does not wait for it.
        self._scene.keep_view(tracked)

    def _show_as_asked(self) -> None:
        """Hands over the last frame again if it was tracked for another marker: no other frame comes by itself."""
        if self._shown is not None and self._shown_by != self._wish.following:
            self._hand_over(self._shown)

    def _end_of_clip(self) -> None:
        self._publish(at=self.state.shown)
        if self._wish.paused:  # stepped beyond the end
            return
        if self._wish.loop and not self._source.is_photo:
            self._flaw = self._source.note
            self._rewind()
            self._pace.go_round(self._period_s)
            return
        if self._left_out is not None:  # it stays on the screen, so it must be shown
            self._hand_over(self._left_out)
            self._left_out = None
        end = None if self._source.is_photo else "end of the clip: R starts it again"
        self._publish(status=self._source.note or end)
        self._publish(has_ended=self._clip is not None)
        self._show_as_asked()
        self._wait(lambda: self._wish.loop and self._clip is not None)
        self._publish(has_ended=False)

    def _wait_for_another_try(self, error: UserError) -> None:
        """The last picture of a clip stays whose file has gone, or is another one: it may come back."""
        self._has_failed = True
        remedy = "drop the file here to play it as it is now" if isinstance(error, _OtherSizeError) else "R tries again"
        self._publish(at=self.state.shown, has_ended=True, status=f"{error.message}: {remedy}")
        self._wait(lambda: False)
        self._publish(has_ended=False)

    def _is_passed_over(self) -> bool:
        """Whether the next frame is late already, or comes too soon: then no picture is made of it."""
        if self._clip is None:
            return False
        self._publish(asked_s=time.monotonic())
        try:
            return self._clip.pass_over(lambda time_s: self._pace.shows(time_s, self._period_s, time.monotonic()))
        finally:
            self._publish(asked_s=None)

    def _read(self) -> Frame | None:
        self._publish(asked_s=time.monotonic())
        try:
            frame = self._source.read()
            if frame is not None and frame.size != self._size:
                given, wanted = (f"{width}x{height}" for width, height in (frame.size, self._size))
                raise _OtherSizeError(f"{self._source.name} gives a picture of {given} and not {wanted}", "start again")
            return frame
        except SourceLost as lost:
            self._publish(asked_s=None, status=f"{lost.message}: waiting for it to come back")
            while not self._source.reopen():
                # A camera cannot jump, and a pending jump would end the wait at once.
                self._publish(obeyed=self._wish.jump)
                self._wait(lambda: False, RECONNECT_EVERY_S)
            self._scene.lose()
            return None
        finally:
            self._publish(asked_s=None)

    def _is_on_time(self, frame: Frame) -> bool:
        """Waits until the frame is due. False if it is too late, or too soon after the last one, to be tracked."""
        due = self._pace.next(frame.time_s, self._period_s, time.monotonic())
        if due.wait_s > 0:
            self._wait(lambda: self._wish.paused, due.wait_s)
        return due.is_shown

    def _go_where_sent(self) -> None:
        """Carries out a pending jump. Unless it leads to the next frame, the tracker starts again, as after a cut."""
        jump, before = self._wish.jump, self.state.at
        if jump is None or not self._is_sent:
            return
        self._publish(obeyed=jump, at=jump.position)
        index = jump.position.index
        if jump.rewinds or self._has_failed:
            self._rewind()
            self._has_failed, self._flaw = False, None  # it may have been mended: the end will tell
        if self._clip is not None and not jump.rewinds:
            if index is None:
                self._clip.seek(jump.position.time_s)
            else:
                self._clip.seek_frame(index)
            if before.index is None or index != before.index + 1:
                self._scene.jump()
        # Beyond the end, where that is not known, the last frame's own time is where it stands.
        is_within = index is None and self._clip is not None and self._clip.duration_s is not None
        self._sought_s = jump.position.time_s if is_within else -math.inf
        self._pace.begin_anew(self._sought_s)

    def _rewind(self) -> None:
        self._source.rewind()
        self._scene.rewind()
