"""Detects that the pictures no longer change: an unchanged screen need not be drawn, and has no frame rate."""

import math
import time
from collections import deque

from ashe_live.core.camera import Size
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.scene import Scene

# After this many equal pictures, or after this time, nothing more is drawn. The time is for slow machines, whose cores
# that number of pictures would keep busy for several seconds.
UNCHANGED_PICTURES, UNCHANGED_S = 30, 0.5
# After this many equal pictures the frame rate shown is held, as its digits would keep the picture changing.
HELD_AFTER_PICTURES = 3
FPS_OVER_FRAMES = 30


class Stillness:
    """Compares every picture with the one before, and counts equal ones in a row."""

    def __init__(self, display_hz: float = math.inf) -> None:
        """`display_hz`: more pictures a second than that are not seen, though two may come sooner after a slow one."""
        self._display_hz = display_hz
        self._last: tuple[Scene, Size, RenderPreset] | None = None
        self._unchanged = 0  # number of pictures in a row that were equal to the one before
        self._changed_s = time.monotonic()  # when the first of these was drawn
        self._fps: float | None = None
        self._shown_s: deque[float] = deque(maxlen=FPS_OVER_FRAMES)

    @property
    def is_still(self) -> bool:
        """Whether nothing has changed for so long that the next picture need not be drawn."""
        is_slow = self._unchanged > HELD_AFTER_PICTURES and time.monotonic() - self._changed_s >= UNCHANGED_S
        return is_slow or self._unchanged >= UNCHANGED_PICTURES

    def add(self, scene: Scene, size: Size, preset: RenderPreset, is_settled: bool) -> None:
        """Adds the next picture, which is compared by the identity of what is in it.

        `is_settled`: whether the same scene would give the same picture again.
        """
        now = scene, size, preset
        is_same = is_settled and now == self._last
        self._unchanged = self._unchanged + 1 if is_same else 0
        if not is_same:
            self._changed_s = time.monotonic()
        self._last = now

    def shown(self) -> None:
        """Notes the time at which the picture appeared on the screen."""
        self._shown_s.append(time.monotonic())

    def fps(self, is_idle: bool) -> float | None:
        """The display's frame rate; None until two pictures were shown. `is_idle`: whether no pictures are drawn."""
        if is_idle:
            self._shown_s.clear()  # the gap until the next picture says nothing about the display
        if self._unchanged < HELD_AFTER_PICTURES and self._shown_s:
            took_s = self._shown_s[-1] - self._shown_s[0]
            if took_s > 0:  # Windows' clock, up to Python 3.12, goes on every 16 ms only
                self._fps = min((len(self._shown_s) - 1) / took_s, self._display_hz)
        return self._fps
