"""The window as the viewer's loop uses it: GLFW's on the screen, the bench's without a screen, and the tests'."""

from typing import Protocol

from ashe_live.render.gl.offscreen import Framebuffer
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.requests import MouseEvent, Request


class Presentable(Protocol):
    """A renderer that has drawn a picture of the window's size."""

    def present(self, target: Framebuffer) -> None:
        """Copies the picture to `target`."""
        ...


class Window(Protocol):
    """Used by the main thread only."""

    @property
    def screen(self) -> Screen:
        """Its pixels now."""
        ...

    @property
    def refresh_rate_hz(self) -> float:
        """The display's refresh rate."""
        ...

    @property
    def clipboard(self) -> str:
        """The text that was copied last; empty if there is none."""
        ...

    @property
    def is_closing(self) -> bool:
        """Whether the user has closed the window."""
        ...

    def take_requests(self, wait_s: float) -> list[Request]:
        """The requests made by keys; waits up to `wait_s` for a first event."""
        ...

    def take_mouse(self) -> list[MouseEvent]:
        """The mouse events between the last two `take_requests`; of several moves in a row only the last."""
        ...

    def set_title(self, title: str) -> None:
        """Shows `title` wherever the window's name is shown."""
        ...

    @property
    def is_fullscreen(self) -> bool:
        """Whether the window fills the screen."""
        ...

    def toggle_fullscreen(self) -> None:
        """Switches between the whole screen and the former size; `screen` follows."""
        ...

    def present(self, picture: Presentable) -> None:
        """Makes `picture` what the next `swap` shows."""
        ...

    def swap(self) -> None:
        """Shows what was presented last; may wait for the display."""
        ...
