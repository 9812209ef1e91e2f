"""Takes back what was done by hand to light and models, gesture by gesture."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

from ashe_live.light.live.moved_marker import FixedInRoom
from ashe_live.models.placement import Placement
from ashe_live.process.messages import listed
from ashe_live.viewer.hands.hand import Hand
from ashe_live.viewer.hands.requests import Command, Drag, Request

MOST_STEPS = 100
# Turns of the wheel and repetitions of a key count as one gesture while they follow each other as fast as this.
ONE_GESTURE_S = 0.8


@dataclass(frozen=True, slots=True)
class _State:
    light: FixedInRoom | None
    placement: Placement | None  # None: of a model that is no longer in the hand


@dataclass(frozen=True, slots=True)
class _Change:
    take_back: Callable[[], str | None]  # ends it, and says so; None where it has ended anyway


class _TurnedUp(_Change):
    """The model in the hand stands on another side."""


class _OtherTakenUp(_Change):
    """Another model is in the hand."""


class Undo:
    """The changes made to light and models by hand; those of a model are forgotten when it is switched."""

    def __init__(self) -> None:
        self._before: deque[_State | _Change] = deque(maxlen=MOST_STEPS)
        self._last: tuple[Command | None, float] = None, -math.inf

    def note(self, hand: Hand, request: Request, now_s: float) -> None:
        """Keeps the state of `hand` before it obeys `request`, where that begins a gesture."""
        command, last_s = self._last
        self._last = request.command, now_s
        continues = command is request.command and now_s - last_s < ONE_GESTURE_S
        if isinstance(request.argument, Drag):
            continues = not request.argument.is_first
        if not continues:
            self._before.append(_State(hand.set_light, hand.placement))

    def note_estimated(self, hand: Hand) -> None:
        """Keeps the state of `hand` before an estimate replaces the light that it has set."""
        self._note_whole(_State(hand.set_light, hand.placement))

    def note_change(self, take_back: Callable[[], str]) -> None:
        """Keeps that there is one model more, or one fewer; `take_back` ends that, and says so."""
        self._note_whole(_Change(take_back))

    def note_turned_up(self, take_back: Callable[[], str]) -> None:
        """Keeps that the model in the hand stands on another side; `take_back` ends that, and says so."""
        self._note_whole(_TurnedUp(take_back))

    def note_other_taken_up(self, take_back: Callable[[], str | None]) -> None:
        """Keeps that another model was taken up; all that follow each other are taken back at once.

        `take_back` takes the former one up again, and says so; None where that is in the hand anyway.
        """
        follows_other = bool(self._before) and isinstance(self._before[-1], _OtherTakenUp)
        self._note_whole(self._before.pop() if follows_other else _OtherTakenUp(take_back))

    def undo(self, hand: Hand) -> str | None:
        """Returns `hand` to the state before its last gesture that changed something, or takes the last change back.

        Says what of it is as before; None where there is nothing to undo.
        """
        self._last = None, -math.inf
        while self._before:
            last = self._before.pop()
            if isinstance(last, _Change):
                if (said := last.take_back()) is not None:
                    return said
                continue
            placement = last.placement or hand.placement
            changed = {"light": last.light is not hand.set_light, "model": placement != hand.placement}
            if any(changed.values()):
                hand.set_light, hand.placement = last.light, placement
                return f"undone: {listed(name for name, is_other in changed.items() if is_other)} as before"
        return None

    def forget(self) -> None:
        self._before.clear()
        self._last = None, -math.inf

    def forget_model(self) -> None:
        """Forgets what was done to the model in the hand since it was put there; not what was done to the light."""
        self._last = None, -math.inf
        of_light: deque[_State] = deque()
        while self._before and isinstance(self._before[-1], _State | _TurnedUp):
            if isinstance(last := self._before.pop(), _State):
                of_light.appendleft(replace(last, placement=None))
        self._before += of_light

    def _note_whole(self, step: _State | _Change) -> None:
        """Keeps what is a gesture of its own, however soon another follows."""
        self._last = None, -math.inf
        self._before.append(step)
