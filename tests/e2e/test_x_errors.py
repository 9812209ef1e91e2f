"""A program that ends while something is dragged from it does not take the viewer with it; nor is anything lost with a
display.
"""

import ctypes
import subprocess
import sys

import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.errors import ExitStatus
from ashe_live.viewer.windows.x_errors import DISPLAY_LOST
from tests.checkout import CHECKOUT
from tests.e2e.conftest import QUICK_VIEWER, Running, Screen, player, virtual_screen
from tests.patience import PATIENCE_S, await_that

pytestmark = pytest.mark.window
CLIENT_MESSAGE = 33  # X.h

ASK_FOR_WHAT_IS_GONE = """
import ctypes
from ashe_live.viewer.windows.glfw_window import GlfwWindow
with GlfwWindow("ashe-live: errors", (64, 48)):
    xlib = ctypes.CDLL("libX11.so.6")
    xlib.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(xlib.XOpenDisplay(None))
    for ask in (xlib.XMapWindow, xlib.XFreePixmap):
        ask(display, ctypes.c_ulong(0x1234567))
        xlib.XSync(display, 0)
        print("goes on", flush=True)
"""


class ClientMessage(ctypes.Structure):
    """Xlib.h: XClientMessageEvent, of longs, with the room of an XEvent."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("room", ctypes.c_long * 24),
    )


def drag_from_closed_window(screen: Screen, window: int) -> None:
    """Drags a file over `window` from another one that is closed by then: freedesktop.org's XDND, version 5."""
    xlib = ctypes.CDLL("libX11.so.6")
    for name in ("XOpenDisplay", "XDefaultRootWindow", "XCreateSimpleWindow", "XInternAtom"):
        getattr(xlib, name).restype = ctypes.c_void_p if name == "XOpenDisplay" else ctypes.c_ulong
    display = ctypes.c_void_p(xlib.XOpenDisplay(screen.display.encode()))
    root, none = ctypes.c_ulong(xlib.XDefaultRootWindow(display)), ctypes.c_ulong(0)
    source = xlib.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, none, none)
    xlib.XDestroyWindow(display, ctypes.c_ulong(source))

    def atom(name: str) -> int:
        return int(xlib.XInternAtom(display, name.encode(), 0))

    for message, data in (
        ("XdndEnter", (source, 5 << 24, atom("text/uri-list"), 0, 0)),
        ("XdndPosition", (source, 0, 50 << 16 | 50, 0, atom("XdndActionCopy"))),
    ):
        event = ClientMessage(CLIENT_MESSAGE, 0, 1, display, window, atom(message), 32, (ctypes.c_long * 5)(*data))
        xlib.XSendEvent(display, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(event))
    xlib.XSync(display, 0)
    xlib.XCloseDisplay(display)


def test_a_drag_from_a_program_that_has_ended_does_not_end_the_viewer(play):
    viewer = play("--loop")
    drag_from_closed_window(viewer.screen, int(viewer.window))
    viewer.press("s")  # behind it in the queue of events
    await_that(lambda: viewer.process.poll() is not None or viewer.files("*.png"), "a snapshot")
    assert viewer.files("*.png"), viewer.output
    assert viewer.end() == 0


def test_a_display_that_goes_costs_no_recording(shoot_film, tmp_path):
    film = shoot_film(tmp_path, (320, 240), 30)
    folder = tmp_path / "viewer"
    folder.mkdir()
    with virtual_screen() as (screen, server):

        def launch(*arguments: object) -> Running:
            running = Running(screen, folder, tuple(map(str, arguments)), (str(QUICK_VIEWER),))
            running.await_window()
            return running

        viewer = player(launch, film)("--loop")
        viewer.press("v")
        # It begins with less than 1 kB, and grows by fragments of two seconds.
        await_that(lambda: any(path.stat().st_size > 2000 for path in folder.glob(".*.partial.mp4")), "a recording")
        server.kill()
        assert viewer.wait() == ExitStatus.WRONG_USE, viewer.output
    assert DISPLAY_LOST in viewer.output
    recordings = viewer.files("*.mp4")
    assert len(recordings) == 1, viewer.output
    (recorded,) = recordings
    assert f"saved {recorded}" in viewer.output
    with ClipSource(recorded) as clip:
        assert clip.read() is not None
    assert not list(folder.glob(".*.partial.mp4"))


def test_other_errors_of_x_end_the_program_as_before(screen):
    ran = subprocess.run(
        [sys.executable, "-c", ASK_FOR_WHAT_IS_GONE],
        env={**screen.environment, "PYTHONPATH": str(CHECKOUT)},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert ran.stdout.split("\n") == ["goes on", ""]
    assert "BadPixmap" in ran.stderr
    assert ran.returncode == 1
