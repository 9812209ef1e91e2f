"""An offscreen window that times its pictures."""

import time
from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.gl.offscreen import Context
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.requests import MouseEvent, Request
from ashe_live.viewer.windows.window import Presentable


class ShownPicture(NamedTuple):
    """When the viewer began work on a picture, and when it was shown."""

    begun_s: float  # monotonic clock
    shown_s: float
    cpu_s: float  # of the viewer's thread in between


class OffscreenWindow:
    """A Window without a screen; `on_picture` is called for each picture shown."""

    clipboard = ""
    is_closing = False

    def __init__(self, ctx: Context, size: Size, rate_hz: float, on_picture: Callable[[ShownPicture], None]) -> None:
        self.screen = Screen(size)
        self.refresh_rate_hz = rate_hz
        self.requests: list[Request] = []  # served with the next picture
        self._ctx = ctx
        self._on_picture = on_picture
        self._colour = ctx.renderbuffer(size)
        self._screen = ctx.framebuffer([self._colour])
        self._begun_s = self._begun_cpu_s = 0.0

    def take_requests(self, wait_s: float) -> list[Request]:
        if wait_s > 0:
            time.sleep(wait_s)
            return []
        self._begun_s, self._begun_cpu_s = time.monotonic(), time.thread_time()
        requests, self.requests = self.requests, []
        return requests

    def take_mouse(self) -> list[MouseEvent]:
        """None: there is no mouse."""
        return []

    def set_title(self, title: str) -> None:
        """Does nothing: there is no title."""

    @property
    def is_fullscreen(self) -> bool:
        return False

    def toggle_fullscreen(self) -> None:
        """Does nothing: there is no screen."""

    def present(self, picture: Presentable) -> None:
        picture.present(self._screen)

    def swap(self) -> None:
        """Waits until the picture is drawn, which counts as shown."""
        self._ctx.finish()
        self._on_picture(ShownPicture(self._begun_s, time.monotonic(), time.thread_time() - self._begun_cpu_s))

    def read_bgr(self) -> Image:
        """(h, w, 3) uint8 BGR: the picture shown last."""
        width, height = self.screen.size
        rgb = np.frombuffer(self._screen.read(components=3, alignment=1), np.uint8).reshape(height, width, 3)
        return np.asarray(cv2.cvtColor(rgb[::-1], cv2.COLOR_RGB2BGR), dtype=np.uint8)

    def release(self) -> None:
        self._screen.release()
        self._colour.release()
