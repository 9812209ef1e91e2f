"""The one-slot mailbox: latest value only, and an end that crosses over."""

import threading

import pytest

from ashe_live.process import mailbox
from ashe_live.process.mailbox import Closed, LatestMailbox
from tests.patience import PATIENCE_S


def test_the_latest_value_replaces_the_earlier() -> None:
    box = LatestMailbox[int]()
    box.put(1)
    box.put(2)
    assert box.take(0) == 2
    assert box.take(0) is None


@pytest.mark.parametrize("closes", [False, True])
def test_a_waiting_taker_is_woken(monkeypatch: pytest.MonkeyPatch, closes: bool) -> None:
    """At once, and not when it next looks at the clock."""
    monkeypatch.setattr(mailbox, "LONGEST_STEP_S", 4 * PATIENCE_S)
    box, waits, taken = LatestMailbox[str](), threading.Event(), list[str | None]()
    wait = box._changed.wait

    def noted(timeout_s: float) -> bool:
        waits.set()
        return wait(timeout_s)

    def take() -> None:
        try:
            taken.append(box.take(4 * PATIENCE_S))
        except Closed:
            taken.append("closed")

    monkeypatch.setattr(box._changed, "wait", noted)
    taker = threading.Thread(target=take, daemon=True)
    taker.start()
    assert waits.wait(PATIENCE_S)
    if closes:
        box.close()
    else:
        box.put("frame")
    taker.join(PATIENCE_S)
    assert taken == ["closed" if closes else "frame"]


def test_the_last_value_comes_before_the_end() -> None:
    box = LatestMailbox[int]()
    box.put(1)
    box.close()
    assert box.take(0) == 1
    with pytest.raises(Closed):
        box.take(0)
    with pytest.raises(Closed):
        box.put(2)


def test_an_error_crosses_to_the_other_side_and_the_first_counts() -> None:
    box = LatestMailbox[int]()
    box.close(RuntimeError("unplugged"))
    box.close(RuntimeError("later"))
    with pytest.raises(RuntimeError, match="unplugged"):
        box.take(0)


def test_what_is_dropped_is_not_taken_but_what_comes_after_it_is() -> None:
    box = LatestMailbox[int]()
    box.put(1)
    box.drop()
    assert box.take(0) is None
    box.put(2)
    assert box.take(0) == 2
