"""Requests to end (Ctrl+C, a closed terminal, `kill`) that cost nothing: when they are heard, and when they wait."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def ended_by_signals() -> Iterator[Callable[[], None]]:
    """Within, a request to end unwinds the stack like any error, so that a recording is finished.

    What it yields is to be called now and then: it asks once more, where a callback from C or a destructor that the
    signal fell into has swallowed the error.
    """
    asked: BaseException | None = None

    def end(number: int, _stack: FrameType | None) -> None:
        nonlocal asked
        # Impatience must not cut short what unwinding finishes.
        if asked is None:
            asked = KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)
            raise asked

    def end_if_asked() -> None:
        if asked is not None:
            raise asked

    names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    # One that is ignored already (nohup, a shell's background job) is not meant for us.
    before = {number: was for number in numbers if (was := signal.getsignal(number)) is not signal.SIG_IGN}
    try:
        for number in before:
            signal.signal(number, end)
        yield end_if_asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def signals_held() -> Iterator[None]:
    """Within, signals wait whose handler may raise: for C code that calls Python and does not ask what came of it."""
    waiting: list[int] = []
    if threading.current_thread() is not threading.main_thread():  # no other one runs handlers
        yield
        return
    before = {number: was for number in signal.valid_signals() if callable(was := signal.getsignal(number))}
    try:
        for number in before:
            signal.signal(number, lambda number, _stack: waiting.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for late in waiting:
            signal.raise_signal(late)
