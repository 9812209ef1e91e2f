"""Loads GLFW, of which pyGLFW has two libraries for Linux: it chooses by the session's type, and not by the display.

So in a Wayland session a window could not be opened on a virtual screen of X11, and in one that was started from a
console, whose type is tty, none on Wayland.
"""

import os
from collections.abc import Mapping

from ashe_live.process.signals import ctrl_c_blocked

VARIANT = "PYGLFW_LIBRARY_VARIANT"


def variant(environment: Mapping[str, str]) -> str | None:
    """Which library the displays leave as the only one; None where they leave both, or there is no display."""
    names = {"x11": "DISPLAY", "wayland": "WAYLAND_DISPLAY"}
    possible = [each for each, name in names.items() if environment.get(name)]
    return possible[0] if len(possible) == 1 else None


if (only := variant(os.environ)) is not None:
    os.environ.setdefault(VARIANT, only)

with ctrl_c_blocked():  # it starts a process to look for its library, which would answer with a traceback
    import glfw as glfw  # strict typing wants the name again for those that import it from here
