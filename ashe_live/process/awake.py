"""Time in which this process could run: the measure of how long to wait for another one, or for a thread.

Suspended (Ctrl+Z, SIGSTOP), all of them stand still while the clock goes on, so that by the clock alone a process that
is fine would count as one that hangs.
"""

import threading
import time

LONGEST_STEP_S = 1.0  # the most that counts between two looks at the clock


def now_s() -> float:
    return time.monotonic()


class AwakeTime:
    """The seconds since it was made in which this process was not suspended.

    A process does not see that it was suspended, but finds that its clock has jumped. So whoever waits looks at it
    every LONGEST_STEP_S or more often, and of what lies between two looks no more than that counts.
    """

    def __init__(self) -> None:
        self._passed_s = 0.0
        self._last_s = now_s()

    def passed_s(self) -> float:
        """Looks at the clock."""
        last_s, self._last_s = self._last_s, now_s()
        self._passed_s += min(self._last_s - last_s, LONGEST_STEP_S)
        return self._passed_s


def is_set_within(event: threading.Event, longest_s: float) -> bool:
    """Waits for the event, for up to `longest_s` of AwakeTime; returns whether it came."""
    awake = AwakeTime()
    while not event.is_set() and (left_s := longest_s - awake.passed_s()) > 0:
        event.wait(min(left_s, LONGEST_STEP_S))
    return event.is_set()
