"""Work in the background: in a daemon thread, so that it never keeps the viewer from ending."""

from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread
from typing import TypeVar

from ashe_live.errors import UserError

Result = TypeVar("Result")


def begun(name: str, work: Callable[[], Result], failed: Callable[[str], UserError]) -> "Future[Result]":
    """The future result of `work`, or a UserError: its own, or `failed` of the reason for anything else that it raises.

    `name` is the thread's. Whatever a file does to its reader, it does not end the viewer.
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
