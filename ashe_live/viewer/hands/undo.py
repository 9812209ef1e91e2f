"""Takes back what was done by hand to light and model, gesture by gesture."""

import math
from collections import deque
from dataclasses import dataclass

from ashe_live.core.types import Illumination
from ashe_live.models.placement import Placement
from ashe_live.viewer.hands.hand import Hand
from ashe_live.viewer.hands.requests import Command, Drag, Request

MOST_STEPS = 100
# Turns of the wheel and repetitions of a key count as one gesture while they follow each other as fast as this.
ONE_GESTURE_S = 0.8


@dataclass(frozen=True, slots=True)
class _State:
    light: Illumination | None
    placement: Placement


class Undo:
    """The states before the last gestures; those of another model are forgotten when the model is switched."""

    def __init__(self) -> None:
        self._before: deque[_State] = deque(maxlen=MOST_STEPS)
        self._last: tuple[Command | None, float] = None, -math.inf

    def note(self, hand: Hand, request: Request, now_s: float) -> None:
        """Keeps the state of `hand` before it obeys `request`, where that begins a gesture."""
        command, last_s = self._last
        self._last = request.command, now_s
        continues = command is request.command and now_s - last_s < ONE_GESTURE_S
        if isinstance(request.argument, Drag):
            continues = not request.argument.is_first
        state = _State(hand.light, hand.placement)
        if not continues:
            self._before.append(state)

    def undo(self, hand: Hand) -> str | None:
        """Returns `hand` to the state before its last gesture that changed something.

        Says what of it is as before; None where there is no such gesture.
        """
        self._last = None, -math.inf
        while self._before:
            state = self._before.pop()
            changed = {"light": state.light is not hand.light, "model": state.placement != hand.placement}
            if any(changed.values()):
                hand.light, hand.placement = state.light, state.placement
                return f"undone: {' and '.join(name for name, is_other in changed.items() if is_other)} as before"
        return None

    def forget(self) -> None:
        self._before.clear()
        self._last = None, -math.inf
