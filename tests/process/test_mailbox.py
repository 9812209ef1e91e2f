"""The one-slot mailbox: latest value only, and an end that crosses over."""

import threading

import pytest

from ashe_live.process.mailbox import Closed, LatestMailbox


def test_the_latest_value_replaces_the_earlier() -> None:
    box = LatestMailbox[int]()
    box.put(1)
    box.put(2)
    assert box.take(0) == 2
    assert box.take(0) is None


def test_a_waiting_taker_is_woken() -> None:
    box = LatestMailbox[str]()
    taken: list[str | None] = []
    taker = threading.Thread(target=lambda: taken.append(box.take(10)))
    taker.start()
    box.put("frame")
    taker.join(10)
    assert taken == ["frame"]


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


def test_closing_wakes_everybody() -> None:
    box = LatestMailbox[int]()
    ended = threading.Event()

    def take() -> None:
        with pytest.raises(Closed):
            box.take(10)
        ended.set()

    taker = threading.Thread(target=take)
    taker.start()
    box.close()
    assert ended.wait(10)
    taker.join(10)


def test_what_is_dropped_is_not_taken_but_what_comes_after_it_is() -> None:
    box = LatestMailbox[int]()
    box.put(1)
    box.drop()
    assert box.take(0) is None
    box.put(2)
    assert box.take(0) == 2
