"""Lets the program outlive errors of X that others cause: Xlib's own handler ends the process, recording and all.

GLFW answers the program from which something is dragged onto the window; where that has ended meanwhile, there is no
such window any more.
"""

import ctypes
import sys
from typing import Any

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
_installed: Any = None  # Xlib keeps its address alone


def outlive_closed_windows() -> None:
    """Ignores from now on that a window is gone; other errors end the process, as before. Does nothing without X."""
    global _installed
    if _installed is not None or sys.platform in ("win32", "darwin"):
        return
    try:
        xlib = ctypes.CDLL("libX11.so.6")  # as GLFW loads it
    except OSError:
        return
    xlib.XSetErrorHandler.restype = ctypes.c_void_p
    xlib.XSetErrorHandler.argtypes = (ctypes.c_void_p,)
    others = xlib.XSetErrorHandler(None)  # which sets its own

    def handle(display: int, event: Any) -> int:
        return 0 if event.contents.error_code == BAD_WINDOW else int(before(display, event))

    _installed = _Handler(handle)
    own = xlib.XSetErrorHandler(ctypes.cast(_installed, ctypes.c_void_p))
    before = _Handler(others or own)
