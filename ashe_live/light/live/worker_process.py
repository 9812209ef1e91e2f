"""The light worker's process: makes estimates, one request after the other."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from ashe_live.process.pipes import receive_value

if TYPE_CHECKING:
    from ashe_live.core.types import LightEstimate, TrackedFrame
    from ashe_live.light.estimators.estimator import Estimator


@dataclass(frozen=True, slots=True)
class WorkerFailure:
    """Why a request got no estimate."""

    frame_index: int
    message: str  # one line, for the user


def run(connection: Connection, make: "Callable[[str], Estimator]") -> None:
    """Answers every tracked frame and preset with a LightEstimate or a WorkerFailure until the connection is closed."""
    import cv2

    # The other cores are left to the viewer's loop.
    cv2.setNumThreads(1)
    estimators: dict[str, Estimator] = {}
    # EOFError and BrokenPipeError: the viewer has gone, and no answer is needed.
    with suppress(EOFError, OSError):
        while True:
            tracked, preset = receive_value(connection)
            if preset not in estimators:
                estimators[preset] = make(preset)
            connection.send(_answer(estimators[preset], tracked))


def _answer(estimator: "Estimator", tracked: "TrackedFrame") -> "LightEstimate | WorkerFailure":
    """The estimate, or a failure for any exception, so that the process goes on."""
    try:
        return estimator.estimate(tracked)
    except Exception as error:
        first_line = (str(error).strip() or "no message").splitlines()[0]
        return WorkerFailure(tracked.frame.index, f"{type(error).__name__}: {first_line}")
