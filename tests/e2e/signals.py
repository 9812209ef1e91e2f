"""Signals as a program that is started by hand finds them."""

import signal


def ignore_none() -> None:
    """Before a program starts, as children ignore what those do who run the tests (nohup, a shell's background)."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
