"""Recognises drags, double clicks and turns of the wheel, and turns them into requests."""

import math

from ashe_live.viewer.hands.controls import COMMAND_BY_GESTURE
from ashe_live.viewer.hands.requests import Drag, Gesture, MouseAction, MouseEvent, Request

DOUBLE_CLICK_S = 0.35
# A click may move the mouse by this much before it counts as a drag.
CLICK_SLACK_PX = 4.0


class Gestures:
    """A recogniser, fed with the mouse's events in order."""

    def __init__(self, content_scale: float = 1.0) -> None:
        self._slack_px = CLICK_SLACK_PX * content_scale
        self._pressed: MouseEvent | None = None
        self._drags = False
        self._clicked: tuple[MouseEvent, float] | None = None

    def add(self, event: MouseEvent, now_s: float) -> Request | None:
        """The request that `event` completes, if any; a drag begins where the button was pressed."""
        match event.action:
            case MouseAction.PRESSED:
                return self._press(event, now_s)
            case MouseAction.MOVED:
                return self._move(event)
            case MouseAction.RELEASED:
                is_click = self._pressed is not None and not self._drags
                self._clicked = (event, now_s) if is_click else None
                self._pressed, self._drags = None, False
            case MouseAction.SCROLLED:
                gesture = Gesture.SHIFT_WHEEL if event.shift else Gesture.ALT_WHEEL if event.alt else Gesture.WHEEL
                return Request(COMMAND_BY_GESTURE[gesture], event.notches)
        return None

    def _press(self, event: MouseEvent, now_s: float) -> Request | None:
        clicked, self._clicked = self._clicked, None
        if clicked is not None and now_s - clicked[1] <= DOUBLE_CLICK_S and self._is_near(clicked[0], event):
            return Request(COMMAND_BY_GESTURE[Gesture.DOUBLE_CLICK])  # moving on from there is not a drag
        self._pressed, self._drags = event, False
        return None

    def _move(self, event: MouseEvent) -> Request | None:
        begin = self._pressed
        if begin is None or (not self._drags and self._is_near(begin, event)):
            return None
        is_first, self._drags = not self._drags, True
        gesture = Gesture.SHIFT_DRAG if begin.shift else Gesture.DRAG
        drag = Drag((begin.x_px, begin.y_px), (event.x_px, event.y_px), is_first)
        return Request(COMMAND_BY_GESTURE[gesture], drag)

    def _is_near(self, a: MouseEvent, b: MouseEvent) -> bool:
        return math.hypot(a.x_px - b.x_px, a.y_px - b.y_px) <= self._slack_px
