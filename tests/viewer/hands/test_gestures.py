"""What the mouse does, as requests."""

import pytest

from ashe_live.viewer.hands.gestures import CLICK_SLACK_PX, DOUBLE_CLICK_S, Gestures
from ashe_live.viewer.hands.requests import Command, Drag, MouseAction, MouseEvent, Request

PRESSED, MOVED, RELEASED = MouseAction.PRESSED, MouseAction.MOVED, MouseAction.RELEASED


def requests(gestures: Gestures, *events: tuple, begin_s: float = 0.0) -> list[Request]:
    """Of events (action, x, y, shift), 10 ms apart."""
    made = [gestures.add(MouseEvent(*event), begin_s + place / 100) for place, event in enumerate(events)]
    return [request for request in made if request is not None]


@pytest.mark.parametrize(("shift", "command"), [(False, Command.MOVE_LIGHT), (True, Command.MOVE_MODEL)])
def test_a_drag_begins_where_the_button_went_down_and_is_what_it_was_then(shift, command):
    events = [
        (PRESSED, 10, 20, shift),
        (MOVED, 30, 20),
        (MOVED, 30, 50, not shift),
        (MOVED, 11, 20),
        (RELEASED, 11, 20),
        (MOVED, 90, 90),
    ]
    assert requests(Gestures(), *events) == [
        Request(command, Drag((10, 20), (30, 20), True)),
        Request(command, Drag((10, 20), (30, 50), False)),
        Request(command, Drag((10, 20), (11, 20), False)),
    ]


def test_moving_alone_asks_for_nothing_and_neither_does_a_click():
    assert requests(Gestures(), (MOVED, 5, 5), (PRESSED, 5, 5), (MOVED, 6, 5), (RELEASED, 6, 5), (MOVED, 99, 5)) == []


def click(x: float = 5.0) -> tuple[tuple, tuple]:
    return (PRESSED, x, 5.0), (RELEASED, x, 5.0)


def test_two_clicks_reset_and_what_follows_until_the_release_drags_nothing():
    events = *click(), (PRESSED, 6, 5), (MOVED, 80, 5), (RELEASED, 80, 5)
    assert requests(Gestures(), *events, begin_s=1000.0) == [Request(Command.RESET)]


def test_three_clicks_are_one_double_click():
    assert requests(Gestures(), *click(), *click(), *click()) == [Request(Command.RESET)]


def test_clicks_far_apart_in_time_or_place_are_single():
    gestures = Gestures()
    assert requests(gestures, *click()) == []
    assert requests(gestures, *click(), begin_s=DOUBLE_CLICK_S + 0.1) == []
    assert requests(Gestures(), *click(), *click(5 + 2 * CLICK_SLACK_PX)) == []


def test_a_drag_and_a_click_are_no_double_click():
    dragged = (PRESSED, 5, 5), (MOVED, 50, 5), (MOVED, 5, 5), (RELEASED, 5, 5)
    assert Request(Command.RESET) not in requests(Gestures(), *dragged, *click())


def test_a_dense_screen_has_as_wide_a_slack():
    assert requests(Gestures(2.0), (PRESSED, 5, 5), (MOVED, 5 + 1.5 * CLICK_SLACK_PX, 5)) == []


def test_the_wheel_with_alt_moves_the_light_nearer_and_farther():
    scrolled = MouseEvent(MouseAction.SCROLLED, 5, 5, notches=-2.0, alt=True)
    assert Gestures().add(scrolled, 0.0) == Request(Command.LIGHT_DISTANCE, -2.0)


def test_the_wheel_scales_and_with_shift_turns():
    scrolled = MouseEvent(MouseAction.SCROLLED, 1, 1, False, 2.5), MouseEvent(MouseAction.SCROLLED, 1, 1, True, -1.0)
    gestures = Gestures()
    assert [gestures.add(event, 0.0) for event in scrolled] == [
        Request(Command.SCALE_MODEL, 2.5),
        Request(Command.TURN_MODEL, -1.0),
    ]
