"""Undo: gesture by gesture back to the beginning, and no further."""

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.models.mesh import Model
from ashe_live.models.placement import placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.viewer.hands.hand import Hand, HandContext
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.hands.undo import ONE_GESTURE_S, Undo

LARGER = Request(Command.SCALE_MODEL, 1)
TURN = Request(Command.TURN_MODEL, 1)
MODEL = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)


class Table:
    """A hand whose requests are noted first, as the session does."""

    def __init__(self, fakes) -> None:
        self.hand, self.undo = Hand(), Undo()
        estimated = Illumination((Light(np.array((1.0, 0.0, 1.0))),))
        self._context = HandContext(fakes.tracked(), estimated, MODEL)

    def obey(self, request: Request, now_s: float) -> None:
        self.undo.note(self.hand, request, now_s)
        self.hand.obey(request, self._context)


@pytest.mark.parametrize(
    ("requests", "pause_s"),
    [((LARGER, TURN, LARGER), ONE_GESTURE_S / 4), ((LARGER, LARGER, LARGER), 2 * ONE_GESTURE_S)],
    ids=["other keys at once", "the same after a pause"],
)
def test_each_gesture_is_taken_back_by_itself(requests, pause_s, fakes):
    table = Table(fakes)
    states = [table.hand.placement]
    for number, request in enumerate(requests):
        table.obey(request, pause_s * number)
        states.append(table.hand.placement)
    for state in reversed(states[:-1]):
        assert table.undo.undo(table.hand)
        assert table.hand.placement == state
    assert not table.undo.undo(table.hand)


def test_a_turning_wheel_is_one_gesture(fakes):
    table = Table(fakes)
    before = table.hand.placement
    for number in range(20):
        table.obey(LARGER, number * ONE_GESTURE_S / 2)
    assert table.undo.undo(table.hand)
    assert table.hand.placement == before


def test_the_same_key_again_after_undoing_or_another_change_is_a_gesture_of_its_own(fakes):
    table = Table(fakes)
    before = table.hand.placement
    undo = table.undo
    for change in (undo.note_change, undo.note_turned_up, undo.note_other_taken_up):
        table.obey(LARGER, 0.0)
        larger = table.hand.placement
        change(lambda: "taken back")
        table.obey(LARGER, 0.1)
        assert undo.undo(table.hand)
        assert table.hand.placement == larger
        assert undo.undo(table.hand) == "taken back"
        table.obey(LARGER, 0.2)
        for state in (larger, before):
            assert undo.undo(table.hand)
            assert table.hand.placement == state


def test_a_drag_is_one_gesture_however_slow(fakes):
    table = Table(fakes)
    for number in range(20):
        drag = Drag((30.0, 20.0), (30.0 + number, 20.0), is_first=number == 0)
        table.obey(Request(Command.MOVE_LIGHT, drag), 5.0 * number)
    assert table.hand.light is not None
    assert table.undo.undo(table.hand)
    assert table.hand.light is None
    assert not table.undo.undo(table.hand)


def test_what_changed_nothing_takes_no_step(fakes):
    table = Table(fakes)
    table.obey(LARGER, 0.0)
    before = table.hand.placement
    for number in range(1, 4):
        table.undo.note(table.hand, Request(Command.RESET), 10.0 * number)
    assert table.undo.undo(table.hand)
    assert table.hand.placement != before


def test_the_steps_of_another_model_are_forgotten(fakes):
    table = Table(fakes)
    table.obey(LARGER, 0.0)
    table.undo.forget()
    assert not table.undo.undo(table.hand)


def test_what_was_undone_is_said(fakes):
    """Or else the words on what was done would stand there still, when it is done no more."""
    table = Table(fakes)
    table.obey(TURN, 0.0)
    table.obey(Request(Command.MOVE_LIGHT, Drag((30.0, 20.0), (40.0, 20.0), is_first=True)), 10.0)
    table.obey(Request(Command.RESET), 20.0)
    table.hand.reset()
    said = [table.undo.undo(table.hand) for _ in range(4)]
    assert said == ["undone: light and model as before", "undone: light as before", "undone: model as before", None]
