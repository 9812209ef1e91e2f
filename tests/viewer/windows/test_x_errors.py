"""What is finished where a display goes, without a display: Xlib's call is made by hand, in a process of its own."""

import os
import subprocess
import sys

import pytest

from ashe_live.errors import ExitStatus
from ashe_live.viewer.windows.x_errors import DISPLAY_LOST
from tests.checkout import CHECKOUT
from tests.patience import PATIENCE_S

BEFORE = """
import atexit, sys
from contextlib import ExitStack
from ashe_live.viewer.windows import x_errors
atexit.register(print, "in order")

def fail():
    raise KeyError("the disk is full")

with ExitStack() as endings:
    def within(finish):
        endings.enter_context(x_errors.finished_if_the_display_goes(finish))
    with x_errors.finished_if_the_display_goes(lambda: print("nobody")):
        pass
    within(lambda: print("first"))
    within(lambda: print("last"))
"""


@pytest.mark.parametrize("fails", [False, True])
def test_what_is_under_way_is_finished_the_last_first_and_the_process_ends_at_once(fails: bool) -> None:
    """Without the interpreter's own end, in which a window would be closed, and X be asked again."""
    code = BEFORE + ("    within(fail)\n" if fails else "") + "    x_errors._end(0)"
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=CHECKOUT, env=buffered, capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert ran.returncode == ExitStatus.WRONG_USE
    said, _, traceback = ran.stderr.partition("\n")
    assert said == f"ashe-live: {DISPLAY_LOST}"
    assert ran.stdout == "last\nfirst\n", "each of them, whichever fails"
    if fails:
        assert traceback.endswith("KeyError: 'the disk is full'\n")
    else:
        assert traceback == ""


def test_where_there_is_no_xlib_nothing_is_handled() -> None:
    """As on Wayland alone: and Windows and macOS have none to look for."""
    code = (
        "import ctypes, sys\nfrom ashe_live.viewer.windows import x_errors\nasked = []\n"
        "def load(name):\n    asked.append(name)\n    raise OSError\n"
        "ctypes.CDLL = load\nx_errors.handle_x_errors()\n"
        "for sys.platform in ('win32', 'darwin'):\n    x_errors.handle_x_errors()\n"
        "print(asked, x_errors._installed)"
    )
    ran = subprocess.run([sys.executable, "-c", code], cwd=CHECKOUT, capture_output=True, text=True, timeout=PATIENCE_S)
    assert (ran.stdout, ran.stderr) == ("['libX11.so.6'] None\n", "")


def test_a_request_to_end_that_comes_while_the_display_goes_interrupts_nothing() -> None:
    """A session that ends asks its programs to end, too."""
    code = BEFORE + (
        "    import os, signal\n"
        "    from ashe_live.process.signals import ended_by_signals\n"
        "    within(lambda: os.kill(os.getpid(), signal.SIGTERM))\n"
        "    with ended_by_signals():\n"
        "        x_errors._end(0)"
    )
    ran = subprocess.run([sys.executable, "-c", code], cwd=CHECKOUT, capture_output=True, text=True, timeout=PATIENCE_S)
    assert ran.returncode == ExitStatus.WRONG_USE
    assert ran.stderr == f"ashe-live: {DISPLAY_LOST}\n"
    assert ran.stdout == "last\nfirst\n"
