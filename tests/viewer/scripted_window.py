"""A window that is worked by a script, and shows nothing."""

import threading
from collections.abc import Callable, Iterable

from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.requests import Command, MouseEvent, Request
from ashe_live.viewer.windows.window import Presentable

RATE_HZ = 500.0


class ScriptedWindow:
    """Calls the script's steps, one a picture, obeys what they return (a request, the mouse's event), and closes."""

    screen = Screen((64, 48))
    refresh_rate_hz = RATE_HZ
    clipboard = ""
    is_closing = False

    def __init__(self, steps: Iterable[Callable[[], object]]) -> None:
        self.steps = list(steps)
        self.fullscreen = 0
        self.title = ""
        self.presented: Presentable | None = None
        self.requests: list[Request] = []
        self.mouse: list[MouseEvent] = []

    def take_requests(self, wait_s: float) -> list[Request]:
        if wait_s > 0:
            threading.Event().wait(min(wait_s, 0.02))
            return []
        requests, self.requests = self.requests, []
        return requests

    def take_mouse(self) -> list[MouseEvent]:
        mouse, self.mouse = self.mouse, []
        return mouse

    def set_title(self, title: str) -> None:
        self.title = title

    @property
    def is_fullscreen(self) -> bool:
        return self.fullscreen % 2 == 1

    def toggle_fullscreen(self) -> None:
        self.fullscreen += 1

    def present(self, picture: Presentable) -> None:
        self.presented = picture

    def swap(self) -> None:
        if not self.steps:
            self.is_closing = True
            return
        wanted = self.steps.pop(0)()
        self.requests = [Request(wanted)] if isinstance(wanted, Command) else []
        if isinstance(wanted, Request):
            self.requests = [wanted]
        self.mouse = [wanted] if isinstance(wanted, MouseEvent) else []
