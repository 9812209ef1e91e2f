"""The light worker's process: makes estimates, one request after the other."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from ashe_live.process.pipes import receive_value, send_value

if TYPE_CHECKING:
    from ashe_live.core.types import LightEstimate, TrackedFrame
    from ashe_live.light.estimators.estimator import Estimator
    from ashe_live.light.estimators.trace import Trace


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a request."""

    estimate: "LightEstimate"
    trace: "Trace | None" = None  # None where none was asked for, or the estimator keeps none


@dataclass(frozen=True, slots=True)
class WorkerFailure:
    """Why a request got no estimate."""

    frame_index: int
    message: str  # one line, for the user


def run(connection: Connection, make: "Callable[[str], Estimator]") -> None:
    """Answers each request (a tracked frame, a preset, whether to trace) with an Answer or a WorkerFailure.

    Returns when the connection is closed.
    """
    import cv2

    # The other cores are left to the viewer's loop.
    cv2.setNumThreads(1)
    estimators: dict[str, Estimator] = {}
    # EOFError and BrokenPipeError: the viewer has gone, and no answer is needed.
    with suppress(EOFError, OSError):
        while True:
            tracked, preset, with_trace = receive_value(connection)
            if preset not in estimators:
                estimators[preset] = make(preset)
            send_value(connection, _answer(estimators[preset], tracked, with_trace))


def _answer(estimator: "Estimator", tracked: "TrackedFrame", with_trace: bool) -> Answer | WorkerFailure:
    """The estimate, or a failure for any exception, so that the process goes on."""
    from ashe_live.light.estimators.estimator import TracingEstimator

    try:
        if with_trace and isinstance(estimator, TracingEstimator):
            return Answer(*estimator.traced(tracked))
        return Answer(estimator.estimate(tracked))
    except Exception as error:
        first_line = (str(error).strip() or "no message").splitlines()[0]
        return WorkerFailure(tracked.frame.index, f"{type(error).__name__}: {first_line}")
