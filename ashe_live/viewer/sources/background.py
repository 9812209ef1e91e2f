"""Work in the background: in a daemon thread, so that it never keeps the viewer from ending."""

from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread
from typing import TypeVar

from ashe_live.errors import UserError

Result = TypeVar("Result")


def in_background(name: str, work: Callable[[], Result], failed: Callable[[str], UserError]) -> "Future[Result]":
    """Runs `work` in a thread of this name; returns its result to be, or a UserError.

    That is the one that `work` raises, or `failed` of the reason for anything else that it raises: whatever a file does
    to its reader, it does not end the viewer.
    """
    coming: Future[Result] = Future()

    def run() -> None:
        try:
            coming.set_result(work())
        except UserError as error:
            coming.set_exception(error)
        except BaseException as error:
            coming.set_exception(failed(str(error) or type(error).__name__))

    # A daemon, so that quitting waits neither for a huge file nor for one that hangs.
    Thread(target=run, name=name, daemon=True).start()
    return coming
