"""Playback controls by keys and on the time bar: pause, step, seek, speed and loop; clips only."""

import math

from ashe_live.core.types import TrackedFrame
from ashe_live.render.screen import Screen
from ashe_live.viewer.drawn.time_bar import Moment, bar_at
from ashe_live.viewer.hands.requests import Command, MouseAction, MouseEvent, Request
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources.pipeline import Pipeline

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
# How long the bar stays after the pointer was near it, or after a key has sought or stepped.
BAR_SHOWN_S = 2.0
A_PHOTO = "a photo is one moment: keys that go through time are for clips"
A_CAMERA = "a camera shows what is there now: keys that go through time are for clips (V records one)"


class Playback:
    """Passes playback requests on to the pipeline. Used by the main thread only."""

    def __init__(self, pipeline: Pipeline, session: Session, loop: bool = False) -> None:
        self._pipeline = pipeline
        self._session = session
        self._paused = False
        self._speed = 1.0
        self._loop = loop
        self._dragged_to_s: float | None = None
        self._bar_until_s = -math.inf

    def handle(self, request: Request, now_s: float) -> bool:
        """Handles a playback request; returns False for any other."""
        match request.command:
            case Command.PAUSE if not self._pipeline.is_photo:
                self._pause(now_s)
            case Command.PAUSE | Command.RESTART | Command.STEP | Command.SEEK | Command.SPEED | Command.LOOP if (
                not self._pipeline.is_clip
            ):
                self._session.say(A_PHOTO if self._pipeline.is_photo else A_CAMERA, now_s)
            case Command.RESTART:
                self._pipeline.restart()
            case Command.STEP:
                self._paused = True
                self._pipeline.step(request.number)
            case Command.SEEK:
                self._pipeline.seek_by(request.number)
                self._bar_until_s = now_s + BAR_SHOWN_S
            case Command.SPEED:
                place = SPEEDS.index(self._speed) + request.number
                self._speed = SPEEDS[min(max(place, 0), len(SPEEDS) - 1)]
                self._play(f"speed {self._speed:g}x", now_s)
            case Command.LOOP:
                self._loop = not self._loop
                self._play("played again and again: O ends it" if self._loop else "played once", now_s)
            case _:
                return False
        return True

    def take_mouse(self, event: MouseEvent, screen: Screen, now_s: float) -> bool:
        """Shows the bar when the pointer is near, and seeks where it is dragged; False for events beside the bar."""
        duration_s = self._pipeline.duration_s
        is_dragged = self._dragged_to_s is not None  # to its end, even if the bar is hidden meanwhile
        if duration_s is None or not (self._session.view.has_time_bar or is_dragged):
            return False
        bar = bar_at(screen, duration_s)
        is_over = bar.is_near(event.y_px)
        if is_over:
            self._bar_until_s = now_s + BAR_SHOWN_S
        match event.action:
            case MouseAction.PRESSED if is_over:
                self._pipeline.pause(True)
            case MouseAction.RELEASED if is_dragged:
                self._dragged_to_s = None
                self._pipeline.pause(self._paused)
                return True
            case MouseAction.MOVED if is_dragged:
                self._bar_until_s = now_s + BAR_SHOWN_S
            case _:
                return False
        self._dragged_to_s = duration_s * bar.share_at(event.x_px)
        self._pipeline.seek(self._dragged_to_s)
        return True

    def moment(self, shown: TrackedFrame | None, now_s: float) -> Moment | None:
        """The content of the time bar now; None while it is hidden."""
        duration_s = self._pipeline.duration_s
        if duration_s is None or shown is None:
            return None
        if self._dragged_to_s is not None:
            return Moment(self._dragged_to_s, duration_s, None, self._speed, self._loop)
        stands_still = self._paused or self._pipeline.has_ended
        if not stands_still and now_s >= self._bar_until_s:
            return None
        frame = shown.frame.index if stands_still else None
        return Moment(shown.frame.time_s, duration_s, frame, self._speed, self._loop)

    @property
    def pace_shown(self) -> str:
        """ "paused" or the speed; empty at a clip's own rate."""
        if self._paused:
            return "paused"
        return "" if self._speed == 1 else f"{self._speed:g}x"

    def _pause(self, now_s: float) -> None:
        if self._pipeline.has_ended and not self._paused:
            self._pipeline.restart()
            return
        self._paused = not self._paused
        self._pipeline.pause(self._paused)
        self._session.say("paused: P goes on" if self._paused else "playing", now_s)

    def _play(self, said: str, now_s: float) -> None:
        self._pipeline.play(self._speed, self._loop)
        self._session.say(said, now_s)
        self._bar_until_s = now_s + BAR_SHOWN_S
