"""The light worker's process: makes estimates, one request after the other."""

import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from ashe_live.process.pipes import receive_value, send_value

if TYPE_CHECKING:
    from ashe_live.core.arrays import Image
    from ashe_live.core.types import LightEstimate, TrackedFrame
    from ashe_live.light.estimators.estimator import Estimator
    from ashe_live.light.estimators.steps import ProxySteps
    from ashe_live.light.estimators.trace import Trace

Draw = Callable[["TrackedFrame", "LightEstimate", "Trace"], "Image"]  # a picture (h, w, 3), BGR, of an estimate's trace


LOWEST_PRIORITY = 19


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a request."""

    estimate: "LightEstimate"
    picture_bgr: "Image | None" = None  # of the trace; None where none was asked for, or the estimator keeps no trace


@dataclass(frozen=True, slots=True)
class WorkerFailure:
    """Why a request got no estimate."""

    frame_index: int
    message: str  # one line, for the user


def run(connection: Connection, make: "Callable[[ProxySteps], Estimator]") -> None:
    """Answers each request with an Answer or a WorkerFailure.

    A request is a tracked frame, a preset, what to draw its trace by, and whether a person waits for it.

    Returns when the connection is closed.
    """
    import cv2

    # The other cores are left to the viewer's loop.
    cv2.setNumThreads(1)
    estimators: dict[ProxySteps, Estimator] = {}
    patient = ThreadPoolExecutor(1, "patient", initializer=_give_way)
    # EOFError and BrokenPipeError: the viewer has gone, and no answer is needed.
    with suppress(EOFError, OSError):
        while True:
            tracked, preset, draw, is_awaited = receive_value(connection)
            if preset not in estimators:
                estimators[preset] = make(preset)
            work = partial(_answer, estimators[preset], tracked, draw)
            send_value(connection, work() if is_awaited else patient.submit(work).result())


def _give_way() -> None:
    """Puts this thread at the lowest priority, from which there is no way back: on Linux each thread has its own."""
    if sys.platform == "linux":
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), LOWEST_PRIORITY)


def _answer(estimator: "Estimator", tracked: "TrackedFrame", draw: Draw | None) -> Answer | WorkerFailure:
    """The estimate, or a failure for any exception, so that the process goes on."""
    from ashe_live.light.estimators.estimator import TracingEstimator

    try:
        if draw is not None and isinstance(estimator, TracingEstimator):
            estimate, trace = estimator.traced(tracked)
            return Answer(estimate, draw(tracked, estimate, trace))
        return Answer(estimator.estimate(tracked))
    except Exception as error:
        first_line = (str(error).strip() or "no message").splitlines()[0]
        return WorkerFailure(tracked.frame.index, f"{type(error).__name__}: {first_line}")
