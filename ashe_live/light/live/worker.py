"""The light worker: makes estimates in a process of its own, which yields to the viewer while nobody waits for it.

A thread would share the interpreter's lock and its full priority with the loop; docs/reliability.md has the figures.
"""

import multiprocessing
import threading
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing.connection import Connection
from typing import Self

from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import ESTIMATORS, OF_ONE_FRAME, Estimator, make_estimator
from ashe_live.light.estimators.preset import BALANCED, ProxyPreset
from ashe_live.light.live import worker_process
from ashe_live.light.live.worker_messages import Answer, EstimateRequest, EstimateTask, WorkerFailure
from ashe_live.process import children
from ashe_live.process.awake import AwakeTime
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.process.pipes import receive_value, send_value
from ashe_live.process.unexpected_errors import fault

LIMITS = children.Limits(niceness=0)  # worker_process.py lowers its priority itself
PROCESS_TIMEOUT_S = 0.3  # this and one for each thread: closing takes less than half a second
THREAD_TIMEOUT_S = 0.05
# Not while all is suspended. The paper's estimator takes ten seconds, several times that on a busy machine.
LONGEST_ESTIMATE_S = 120.0

BALANCED_ALONE = EstimateTask(BALANCED)  # nothing drawn, awaited or followed
Outcome = Answer | WorkerFailure


class LightWorker:
    """One process that answers one request at a time; for use from one thread, which it does not block but for
    the end of a process that is given up, for a third of a second.

    `estimator` is a name in ESTIMATORS (UserError for another one), or a picklable callable that makes an estimator
    from a preset. The process starts here, so that its imports are done when the first request comes.
    `takes_one_frame`: it makes no use of other views and of the empty table.
    """

    def __init__(self, estimator: str | Callable[[ProxyPreset], Estimator]) -> None:
        if isinstance(estimator, str) and estimator not in ESTIMATORS:
            make_estimator(estimator)  # raises here, not later in the process
        self._make = partial(make_estimator, estimator) if isinstance(estimator, str) else estimator
        self.takes_one_frame = isinstance(estimator, str) and estimator in OF_ONE_FRAME
        self._asked_index: int | None = None
        self._waited = AwakeTime()  # since it was asked for
        self._closed = False
        self._process: _Process | None = _Process(self._make)

    @property
    def busy(self) -> bool:
        """Whether there is a request whose outcome has not been collected yet."""
        return self._asked_index is not None

    @property
    def waited_s(self) -> float:
        """Seconds since the last request, without the time in which this process was suspended."""
        return self._waited.passed_s()

    def request(
        self,
        tracked: TrackedFrame,
        others: Sequence[TrackedFrame] = (),
        doubted: TrackedFrame | None = None,
        task: EstimateTask = BALANCED_ALONE,
        empty: TrackedFrame | None = None,
    ) -> bool:
        """Requests an estimate of `tracked`; returns False, and does nothing, while busy.

        `others` are views, with markers, that may be of the same scene; those that are not are left out and named in
        the answer. Where none of them is, an estimate that nobody awaits is made only if `doubted`, an earlier frame of
        which this was so, shows the same scene. `empty` is a picture of the empty table, of the size of `tracked`: its
        clean plate, if it shows the same view and no others are used. A frame that was in the request before is not
        sent again. Raises ValueError when closed.
        """
        if self._closed:
            raise ValueError("the light worker is closed")
        if self.busy:
            return False
        if self._process is None or self._process.has_ended:
            self._discard()
            self._process = _Process(self._make)
        self._asked_index, self._waited = tracked.frame.index, AwakeTime()
        self._process.send((tracked, *others), doubted, empty, task)
        return True

    def wait(self, timeout_s: float) -> Outcome | None:
        """The outcome of the request, returned once, for which it waits up to `timeout_s`; None while there is none."""
        if self._process is None or self._asked_index is None:
            return None
        try:
            outcome = self._process.outcomes.take(timeout_s)
        except Exception as error:
            said = "the light estimator's process has died" if isinstance(error, EOFError) else fault(error)
            outcome = WorkerFailure(self._asked_index, said)
            self._discard()
        if outcome is None and self.waited_s > LONGEST_ESTIMATE_S:
            outcome = WorkerFailure(self._asked_index, f"no answer in {LONGEST_ESTIMATE_S:.0f} s")
            self._discard()
        if outcome is not None:
            self._asked_index = None
        return outcome

    def give_up(self) -> None:
        """Cancels the request, if there is one; the next one may be made at once."""
        if self.busy:
            self._asked_index = None
            self._discard()
            self._process = _Process(self._make)

    def close(self) -> None:
        """Ends the process, even during an estimate; closing twice is allowed."""
        self._closed = True
        self._asked_index = None
        self._discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _discard(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process = None


class _Process:
    """One instance of the process.

    When it ends, the mailbox of its outcomes is closed with EOFError; when a request or an outcome cannot be packed or
    unpacked, as where memory is short, with what says so.
    """

    def __init__(self, make: Callable[[ProxyPreset], Estimator]) -> None:
        self.outcomes: LatestMailbox[Outcome] = LatestMailbox()
        self._connection, far_end = multiprocessing.Pipe()
        self._process = children.started(worker_process.run, (make,), "ashe-live light worker", LIMITS, far_end)
        self._threads = [self._thread(_receive, self._connection, self.outcomes)]
        self._held: dict[int, TrackedFrame] = {}  # the frames that the process has, by their numbers
        self._next_number = 0

    @property
    def has_ended(self) -> bool:
        return self.outcomes.is_closed or not self._process.is_alive()

    def send(
        self,
        views: Sequence[TrackedFrame],
        doubted: TrackedFrame | None,
        empty: TrackedFrame | None,
        task: EstimateTask,
    ) -> None:
        """Sends an EstimateRequest, in a thread, as writing to the pipe blocks until the process reads."""
        numbers = {id(view): number for number, view in self._held.items()}
        before, self._held = self._held, {}
        for view in (*views, *(each for each in (doubted, empty) if each is not None)):
            if id(view) not in numbers:
                numbers[id(view)] = self._next_number
                self._next_number += 1
            self._held[numbers[id(view)]] = view
        new = {number: view for number, view in self._held.items() if number not in before}
        doubted_number, empty_number = (None if each is None else numbers[id(each)] for each in (doubted, empty))
        request = EstimateRequest(tuple(numbers[id(view)] for view in views), doubted_number, empty_number, new, task)
        self._threads[1:] = [self._thread(_send, self._connection, request, self.outcomes)]

    def kill(self) -> None:
        self._process.kill()
        self._process.join(PROCESS_TIMEOUT_S)
        # With the process gone both threads reach the pipe's end at once; a pipe still in use must not be closed.
        for thread in self._threads:
            thread.join(THREAD_TIMEOUT_S)
        if not any(thread.is_alive() for thread in self._threads):
            self._connection.close()

    @staticmethod
    def _thread(target: Callable[..., None], *arguments: object) -> threading.Thread:
        thread = threading.Thread(target=target, args=arguments, daemon=True, name="ashe-live light pipe")
        thread.start()
        return thread


def _send(connection: Connection, request: EstimateRequest, outcomes: LatestMailbox[Outcome]) -> None:
    try:
        send_value(connection, request)
    except OSError:
        pass  # the receiving thread meets a broken pipe too, and reports it
    except Exception as error:
        outcomes.close(error)


def _receive(connection: Connection, outcomes: LatestMailbox[Outcome]) -> None:
    try:
        while True:
            outcomes.put(receive_value(connection))
    except OSError:
        outcomes.close(EOFError())
    except Exception as error:
        outcomes.close(error)
