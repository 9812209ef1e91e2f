"""Every window is one that the viewer's loop can work with: the screen's, the bench's without a screen, the tests' own.

mypy checks this file with the package: what stands in WINDOWS has the names and types of the protocol. That it also
behaves so is tried here.
"""

import contextlib
import ctypes
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

import pytest

from ashe_live.bench.soak.offscreen_window import OffscreenWindow
from ashe_live.render.gl.offscreen import Framebuffer, offscreen_context
from ashe_live.viewer.windows.glfw_library import variant
from ashe_live.viewer.windows.glfw_window import GlfwWindow
from ashe_live.viewer.windows.window import Window
from tests.checkout import CHECKOUT
from tests.e2e.conftest import Screen
from tests.patience import PATIENCE_S
from tests.viewer.scripted_window import ScriptedWindow

SIZE = (64, 48)


class Picture:
    """Counts how often it is presented, and draws nothing."""

    def __init__(self) -> None:
        self.targets: list[Framebuffer] = []

    def present(self, target: Framebuffer) -> None:
        self.targets.append(target)


@contextlib.contextmanager
def offscreen() -> Iterator[Window]:
    ctx = offscreen_context()
    window = OffscreenWindow(ctx, SIZE, 60.0, lambda _picture: None)
    yield window
    window.release()
    ctx.release()


WINDOWS: dict[str, Callable[[], AbstractContextManager[Window]]] = {
    "glfw": lambda: GlfwWindow("ashe-live: conformance", SIZE),
    "offscreen": offscreen,
    "scripted": lambda: contextlib.nullcontext(ScriptedWindow([lambda: None] * 9)),
}


def try_out(name: str) -> None:
    """All that the protocol names, as LiveViewer uses it."""
    with WINDOWS[name]() as window:
        assert not window.screen.is_minimised
        assert window.screen.content_scale > 0
        assert window.refresh_rate_hz > 0
        assert window.clipboard == "" or name == "glfw"
        window.set_title("ashe-live: another title, of a file whose name is not UTF-8: \udcff")
        for _ in range(2):
            window.toggle_fullscreen()
            assert window.take_requests(0.0) == []
            assert window.take_requests(0.001) == []
            assert all(event.notches == 0 for event in window.take_mouse())
            picture = Picture()
            window.present(picture)
            window.swap()
            assert len(picture.targets) <= 1
            assert not window.screen.is_minimised
        assert not window.is_closing


def try_density() -> None:
    """On a display of 192 dpi, which magnifies windows: of the size that the screen has room for, and no larger."""
    x11 = ctypes.CDLL("libX11.so.6")
    for function in (x11.XOpenDisplay, x11.XDefaultRootWindow):
        function.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    root, resource_manager, text = ctypes.c_void_p(x11.XDefaultRootWindow(display)), 23, 31  # X11/Xatom.h
    resources = b"Xft.dpi:\t192\n"
    x11.XChangeProperty(display, root, resource_manager, text, 8, 0, resources, len(resources))
    x11.XSync(display, 0)
    try:
        for size, shown in (((320, 240), (640, 480)), ((1280, 720), (1280, 720)), ((720, 720), (960, 960))):
            with GlfwWindow("ashe-live: density", size) as window:
                assert window.screen.content_scale == 2
                assert window.screen.size == shown
                for fullscreen in (True, False):
                    window.toggle_fullscreen()
                    window.take_requests(0.001)
                    assert window.is_fullscreen is fullscreen
                assert window.screen.size == shown
    finally:
        x11.XDeleteProperty(display, root, resource_manager)
        x11.XCloseDisplay(display)


@pytest.mark.parametrize("name", [pytest.param("glfw", marks=pytest.mark.window), "offscreen", "scripted"])
def test_a_window_conforms(name: str, request: pytest.FixtureRequest) -> None:
    if name != "glfw":
        try_out(name)
        return
    run_on(request.getfixturevalue("screen"), "try_out('glfw')")


@pytest.mark.window
def test_a_display_of_x11_is_used_also_from_a_session_of_wayland(screen: Screen) -> None:
    """As these tests themselves do there. pyGLFW goes by the session's type."""
    run_on(screen, "try_out('glfw')", XDG_SESSION_TYPE="wayland")


@pytest.mark.parametrize(
    ("displays", "only"),
    [
        ({}, None),
        ({"DISPLAY": "", "WAYLAND_DISPLAY": ""}, None),
        ({"DISPLAY": ":0"}, "x11"),
        ({"DISPLAY": "", "WAYLAND_DISPLAY": "wayland-0"}, "wayland"),
        ({"DISPLAY": ":0", "WAYLAND_DISPLAY": "wayland-0"}, None),
    ],
)
def test_glfws_library_is_that_of_the_only_display(displays: dict[str, str], only: str | None) -> None:
    assert variant(displays) == only


@pytest.mark.window
def test_a_window_fits_the_screen_where_that_magnifies(screen: Screen) -> None:
    """A clip of 1280x720 had a window of 2560x1440 on a laptop's screen of 200 %."""
    run_on(screen, "try_density()")


def run_on(screen: Screen, call: str, **environment: str) -> None:
    """In a process of its own, whose display is ours."""
    code = f"from tests.e2e import test_window_conformance as these; these.{call}"
    environment = {**screen.environment, "PYTHONPATH": str(CHECKOUT), **environment}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, cwd=CHECKOUT, capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert done.returncode == 0, done.stderr
