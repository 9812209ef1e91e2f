"""Requests to end (Ctrl+C, a closed terminal, `kill`), handled such that nothing is lost: when they act, or wait."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import CodeType, FrameType
from typing import TypeVar

Function = TypeVar("Function", bound=Callable[..., object])

_callbacks: set[CodeType] = set()


def called_from_c(function: Function) -> Function:
    """Marks what C code calls that ignores exceptions, but for printing them: a request to end waits until it returns.

    The interpreter runs handlers of signals at a function's very entry, where the function cannot catch them itself.
    """
    _callbacks.add(function.__code__)
    return function


@contextmanager
def ended_by_signals() -> Iterator[Callable[[], None]]:
    """Within this, a request to end unwinds the stack like any error, so that a recording is finished.

    The function that it yields must be called now and then: it raises the error in case the signal came during a
    callback from C (`called_from_c`), or a destructor that it interrupted has swallowed it.
    """
    asked: BaseException | None = None

    def end(number: int, stack: FrameType | None) -> None:
        nonlocal asked
        # A second request must not interrupt what unwinding finishes.
        if asked is None:
            asked = KeyboardInterrupt() if number == signal.SIGINT else SystemExit(128 + number)
            if not _is_in_callback(stack):
                raise asked

    def end_if_asked() -> None:
        if asked is not None:
            raise asked

    names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    # A signal that is already ignored (by nohup, or in a shell's background job) stays ignored.
    before = {number: was for number in numbers if (was := signal.getsignal(number)) is not signal.SIG_IGN}
    try:
        for number in before:
            signal.signal(number, end)
        yield end_if_asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _is_in_callback(stack: FrameType | None) -> bool:
    while stack is not None:
        if stack.f_code in _callbacks:
            return True
        stack = stack.f_back
    return False


@contextmanager
def ctrl_c_blocked() -> Iterator[None]:
    """Within this, Ctrl-C waits: for the thread that calls it, and for good in processes that it starts meanwhile."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def signals_held() -> Iterator[None]:
    """Within this, signals whose handler may raise wait: for C code that calls Python and ignores its exceptions."""
    waiting: list[int] = []
    if threading.current_thread() is not threading.main_thread():  # only the main thread runs handlers
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
