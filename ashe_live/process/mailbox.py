"""A mailbox with one slot, to hand values over between threads: without a queue nothing is older than it must be."""

import threading
from typing import Generic, TypeVar

from ashe_live.process.awake import LONGEST_STEP_S, AwakeTime

T = TypeVar("T")


class Closed(Exception):  # noqa: N818 - an end, not an error
    """The other side has ended normally; nothing more will come."""


class LatestMailbox(Generic[T]):
    """Holds the latest value only: put overwrites, take empties, close carries an end or an error across."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._value: T | None = None
        self._end: BaseException | None = None

    def put(self, value: T) -> None:
        """Replaces what has not been taken. Raises Closed when the mailbox is closed."""
        with self._changed:
            if self._end is not None:
                raise Closed
            self._value = value
            self._changed.notify_all()

    def take(self, timeout_s: float) -> T | None:
        """The value, or None after `timeout_s` (AwakeTime) without one.

        A value put before the end is still handed over; then raises Closed, or the error that `close` was given.
        """
        with self._changed:
            awake = AwakeTime()
            while self._value is None and self._end is None and (left_s := timeout_s - awake.passed_s()) > 0:
                self._changed.wait(min(left_s, LONGEST_STEP_S))
            value, self._value = self._value, None
            if value is None and self._end is not None:
                raise self._end
            return value

    def drop(self) -> None:
        """Empties the slot, whose value nobody wants any more."""
        with self._changed:
            self._value = None

    def close(self, error: BaseException | None = None) -> None:
        """Closes the mailbox; only the first call counts."""
        with self._changed:
            if self._end is None:
                self._end = error if error is not None else Closed()
            self._changed.notify_all()

    @property
    def is_closed(self) -> bool:
        with self._changed:
            return self._end is not None
