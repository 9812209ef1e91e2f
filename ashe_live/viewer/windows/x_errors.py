"""Lets recordings outlive errors of X that others cause: Xlib's own handlers end the process on the spot.

GLFW answers the program from which something is dragged onto the window; where that has ended meanwhile, there is no
such window any more. And a display may go: its server ends (a session is closed, a virtual one is killed), or the
connection to it breaks, as over SSH.
"""

import contextlib
import ctypes
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from typing import Any

from ashe_live.errors import ExitStatus
from ashe_live.process.messages import print_message
from ashe_live.process.signals import called_from_c

DISPLAY_LOST = "the display is gone (its server has ended, or the connection to it is lost): start again"
BAD_WINDOW = 3  # X.h: BadWindow


class _XErrorEvent(ctypes.Structure):
    """Xlib.h."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("resourceid", ctypes.c_ulong),
        ("serial", ctypes.c_ulong),
        ("error_code", ctypes.c_ubyte),
        ("request_code", ctypes.c_ubyte),
        ("minor_code", ctypes.c_ubyte),
    )


_Handler = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(_XErrorEvent))
_LostHandler = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)
_installed: Any = None  # Xlib keeps their addresses alone
_endings: list[Callable[[], None]] = []  # of what has to be finished where the display goes, the last first


@contextlib.contextmanager
def finished_if_the_display_goes(finish: Callable[[], None]) -> Iterator[None]:
    """Within it, `finish` is called where the display goes, before the process ends; it must not use OpenGL."""
    _endings.append(finish)
    try:
        yield
    finally:
        _endings.remove(finish)


def handle_x_errors() -> None:
    """Ignores from now on that a window is gone; other errors end the process, as before. Does nothing without X.

    Where the display is gone, the process ends with a line that says so, and what is under way is finished before.
    """
    global _installed
    if _installed is not None or sys.platform in ("win32", "darwin"):
        return
    try:
        xlib = ctypes.CDLL("libX11.so.6")  # as GLFW loads it
    except OSError:
        return
    xlib.XSetErrorHandler.restype = ctypes.c_void_p
    xlib.XSetErrorHandler.argtypes = xlib.XSetIOErrorHandler.argtypes = (ctypes.c_void_p,)
    others = xlib.XSetErrorHandler(None)  # which sets its own

    @called_from_c
    def handle(display: int, event: Any) -> int:
        return 0 if event.contents.error_code == BAD_WINDOW else int(before(display, event))

    _installed = _Handler(handle), _LostHandler(_end)
    own = xlib.XSetErrorHandler(ctypes.cast(_installed[0], ctypes.c_void_p))
    xlib.XSetIOErrorHandler(ctypes.cast(_installed[1], ctypes.c_void_p))
    before = _Handler(others or own)


@called_from_c  # where a session ends, its display goes and its programs are asked to end, at the same moment
def _end(_display: int) -> int:
    """Ends the process, as Xlib would once this has returned; no call of X may be made any more."""
    try:
        with contextlib.ExitStack() as endings:  # which calls each of them, the last first, also where another fails
            endings.callback(sys.stdout.flush)
            for finish in _endings:
                endings.callback(finish)
            print_message(DISPLAY_LOST)
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(ExitStatus.WRONG_USE)
