"""Time in which a process could run: what it does not count is the time in which it was suspended."""

import threading
from collections.abc import Iterator
from itertools import accumulate, chain, repeat

import pytest

from ashe_live.process import awake
from ashe_live.process.awake import LONGEST_STEP_S, AwakeTime, is_set_within
from ashe_live.process.mailbox import LatestMailbox

HOUR_S = 3600.0


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """What passes between looks at the clock, one after the other; then always the last of them."""
    given: list[float] = []
    clock: Iterator[float] | None = None

    def now_s() -> float:
        nonlocal clock
        if clock is None:
            clock = accumulate(chain([0.0], given, repeat(given[-1])))
        return next(clock)

    monkeypatch.setattr(awake, "now_s", now_s)
    return given


def test_what_passes_in_small_steps_counts_and_a_jump_does_not(steps: list[float]) -> None:
    steps += [0.25, 0.5, HOUR_S, 0.25]
    time = AwakeTime()
    assert time.passed_s() == 0.25
    assert time.passed_s() == 0.75
    assert time.passed_s() == 0.75 + LONGEST_STEP_S
    assert time.passed_s() == 1.0 + LONGEST_STEP_S


def test_who_waits_goes_on_after_a_jump_and_ends_in_time(steps: list[float]) -> None:
    steps += [0.0, HOUR_S, *repeat(0.5, 5)]
    event, looks = threading.Event(), []

    class Looked(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            looks.append(timeout)
            return False

    assert not is_set_within(Looked(), 3.0)
    # One look before the jump, one after it, with a second gone, and then every half second.
    assert looks == [1.0, 1.0, 1.0, 1.0, 0.5]
    event.set()
    assert is_set_within(event, 0.0)


def test_a_mailbox_gives_what_comes_after_a_jump(steps: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    steps += [0.0, HOUR_S, 0.5]
    box = LatestMailbox[str]()
    waits: list[float] = []

    def wait(timeout_s: float) -> None:
        waits.append(timeout_s)
        if len(waits) == 2:
            box.put("late")

    monkeypatch.setattr(box._changed, "wait", wait)
    assert box.take(20.0) == "late"
    assert waits == [LONGEST_STEP_S] * 2
    assert box.take(2.0) is None
    assert waits[2:] == [1.0, 1.0, 0.5], "until the time is over, and no longer"
