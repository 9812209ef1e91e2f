"""Which frame shows the table without the object, and for how long it does."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.transforms import rigid
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.viewer.estimates.held_empty_table import EMPTY_FOR_S, HeldEmptyTable


@pytest.fixture
def at(fakes):
    """A frame of this time; the viewer may run for hours."""

    def at(time_s: float) -> TrackedFrame:
        tracked = fakes.tracked()
        return replace(tracked, frame=Frame(tracked.frame.image_bgr, 0, 10_000 + time_s))

    return at


def test_the_latest_frame_counts_whoever_found_that_it_shows_the_empty_table(at) -> None:
    held, shown, before, later = HeldEmptyTable(), at(10), at(5), at(20)
    held.found(before)
    assert held.frame is before
    held.show(shown)
    held.found(before)  # an estimate may have taken that long
    assert held.frame is shown
    held.found(later)
    assert held.frame is later
    held.show(shown)
    assert held.frame is shown, "who says so knows it"


@pytest.mark.parametrize("sign", [1, -1], ids=["after it", "before it, as a clip may go back"])
def test_it_is_forgotten_after_minutes_and_only_the_users_own_with_a_word(at, sign) -> None:
    for is_users in (True, False):
        held = HeldEmptyTable()
        (held.show if is_users else held.found)(at(0))
        assert held.under(at(sign * (EMPTY_FOR_S - 1))) is held.frame is not None
        assert held.take_news() is None
        assert held.under(at(sign * (EMPTY_FOR_S + 1))) is None
        assert held.frame is None
        news = held.take_news()
        assert ("minutes ago" in (news or "")) is is_users
        assert held.take_news() is None


def test_it_is_forgotten_where_the_marker_was_moved(at) -> None:
    held = HeldEmptyTable()
    held.show(replace(at(0), T_room_marker=np.eye(4)))
    there = replace(at(1), T_room_marker=rigid(np.eye(3), (0.1, 0.0, 0.0)))
    assert held.under(there) is None
    assert "had the marker elsewhere" in (held.take_news() or "")


def test_for_a_frame_of_another_size_there_is_none_and_it_stays(at) -> None:
    held, seen = HeldEmptyTable(), at(1)
    held.show(shown := at(0))
    small = (32, 24)
    other = replace(
        seen, frame=Frame(np.zeros((24, 32, 3), np.uint8), 1, seen.frame.time_s), camera=Camera.from_hfov(small, 60)
    )
    assert held.under(other) is None
    assert held.under(seen) is shown
