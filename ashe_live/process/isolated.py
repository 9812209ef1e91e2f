"""Calls a function in a process of its own: whatever it does there, the caller gets an answer in time."""

import multiprocessing
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import TypeVar

from ashe_live.errors import UserError
from ashe_live.process.awake import is_set_within
from ashe_live.process.children import Limits, started
from ashe_live.process.pipes import receive_value, send_value

Result = TypeVar("Result")


class NoAnswerError(Exception):
    """The process ended without an answer, or was ended; the message says how, e.g. "ended with status -6"."""


class _Alarm:
    """Calls a function, in a thread, if it is not stopped within a time in which this process could run."""

    def __init__(self, after_s: float, ring: Callable[[], None]) -> None:
        self.has_rung = False
        self._after_s, self._ring = after_s, ring
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="ashe-live alarm", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Returns once it rings no more."""
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        if not is_set_within(self._stopped, self._after_s):
            self.has_rung = True
            self._ring()


def isolated_call(
    function: Callable[..., Result], arguments: tuple[object, ...], name: str, limits: Limits, longest_s: float
) -> Result:
    """What `function(*arguments)` returns, called in a process of that name; arrays in it are read-only.

    The function must be importable, its arguments and result picklable. Raises the UserError that it raised, and
    NoAnswerError for any other exception, for its end, and when it takes longer than `longest_s` or more than `limits`.
    """
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = started(_answer, (function, *arguments), name, limits, sender)
    # A process may also stop in the middle of its answer; its end ends the wait for the rest.
    alarm = _Alarm(longest_s, process.kill)
    try:
        outcome = receive_value(receiver)
    except EOFError:
        alarm.stop()
        process.join()
        how = f"no answer within {longest_s:g} s" if alarm.has_rung else _how_it_ended(process.exitcode, limits)
        raise NoAnswerError(how) from None
    finally:
        alarm.stop()
        receiver.close()
        process.kill()
        process.join()
    if isinstance(outcome, UserError | NoAnswerError):
        raise outcome
    result: Result = outcome
    return result


def _answer(connection: Connection, function: Callable[..., object], *arguments: object) -> None:
    outcome: object
    try:
        outcome = function(*arguments)
    except UserError as error:
        outcome = error
    except MemoryError:
        outcome = NoAnswerError("out of memory")
    except Exception as error:
        outcome = NoAnswerError(f"{type(error).__name__}: {error}")
    # The parent may have ended, and nobody waits for the answer.
    with suppress(OSError):
        send_value(connection, outcome)


def _how_it_ended(status: int | None, limits: Limits) -> str:
    if status is not None and -status == getattr(signal, "SIGXCPU", None):
        return f"more than {limits.processor_s} s of processor time"
    return f"ended with status {status}"
