"""Requests estimates from the light worker as the camera moves, and keeps the answer that stands."""

import math
from collections.abc import Sequence
from dataclasses import replace

from ashe_live.core.types import LightEstimate, TrackedFrame
from ashe_live.light.estimators.estimator import OF_ONE_FRAME
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.live.comparable import fits
from ashe_live.light.live.held_answer import HeldAnswer
from ashe_live.light.live.key_views import KeyViews
from ashe_live.light.live.worker import LightWorker, Outcome
from ashe_live.light.live.worker_process import Answer, Draw
from ashe_live.viewer.estimates.brightness import Brightness
from ashe_live.viewer.estimates.sharpening import EVERY_S, Sharpening


class LightWatch:
    """The light of one scene: requested by the user, then refined with the key views. For use by one thread."""

    def __init__(self, worker: LightWorker) -> None:
        self.preset = BALANCED
        self.key_views = KeyViews()  # of the scene that is shown; the capture thread adds to them
        self.camera_may_move = False  # whether the source is a camera that the user may move
        self.held = HeldAnswer()  # since the user's last request
        self.sharpening = Sharpening()
        self.asked_s = -math.inf
        self.frozen: TrackedFrame | None = None  # of the last request
        self._others: Sequence[TrackedFrame] = ()  # the other views of the last request
        # A frame that shows another scene than the key views: the scene has changed if the frames after it show the
        # same, and else something has passed before the camera.
        self._doubted: TrackedFrame | None = None
        self._is_awaited = False
        self._brightness = Brightness()  # of the frame of the last request
        # The user's request, and its time, while another estimate is in progress.
        self._waiting: tuple[TrackedFrame, float, Draw | None] | None = None
        self._worker = worker

    @property
    def is_estimating(self) -> bool:
        return self._worker.busy

    @property
    def is_awaited(self) -> bool:
        """Whether an estimate that the user waits for is in progress."""
        return self._worker.busy and (self._is_awaited or self._waiting is not None)

    def begin_anew(self) -> None:
        """Forgets the scene, and gives up an estimate in progress."""
        self.frozen, self._others, self._doubted, self._waiting = None, (), None, None
        self.held, self.sharpening = HeldAnswer(), Sharpening()
        self.key_views.drop()
        self._worker.give_up()

    def ask(self, frozen: TrackedFrame, now_s: float, draw: Draw | None = None) -> bool:
        """The user requests an estimate of a frame together with the current key views; returns whether it is accepted.

        While another one that the user waits for is in progress, a request is refused; it is kept until a background
        estimate is done. The answer to it replaces any held one.
        """
        if self._worker.busy and not self.is_awaited:
            self._waiting = frozen, now_s, draw
            return True
        before, self.sharpening = self.sharpening, Sharpening()
        if self.ask_in_background(frozen, now_s, draw, is_awaited=True):
            return True
        self.sharpening = before
        return False

    def ask_in_background(
        self,
        frozen: TrackedFrame,
        now_s: float,
        draw: Draw | None = None,
        is_awaited: bool = False,
        follows: bool = False,
    ) -> bool:
        """As `ask`, but what has been learned of when another estimate is worthwhile stays, and a frame is refused that
        does not show what the held light was found by: whoever leans in to the model sees nothing of that.

        `is_awaited`: the user waits for it all the same. `follows`: the held answer's light is only to be followed, and
        estimated again only if the scene has changed.
        """
        views = self.key_views.views
        others = tuple(view for view in views if view.frame.index != frozen.frame.index and fits(view, frozen))
        self.held.move_to(frozen)
        if not (is_awaited or self.held.is_shown):
            return False
        shown = self.held.estimate
        held = shown and replace(shown, object_mask=None, shadow_mask=None)  # which nobody needs there
        if not self._worker.request(frozen, self.preset, draw, is_awaited, others, held, follows, self._doubted):
            return False
        self.frozen, self._others, self.asked_s, self._is_awaited = frozen, others, now_s, is_awaited
        self._brightness.note(frozen.frame)
        self.sharpening.asked(views, now_s)
        return True

    def sharpen(self, seen: TrackedFrame, now_s: float, draw: Draw | None) -> bool:
        """Requests an estimate of the key views if there is an answer to refine and they show more; returns whether.

        If the last request showed another scene, what is `seen` now shows whether the scene has changed.
        """
        views = self.key_views.views
        held = self.held.estimate
        if held is None or held.estimator in OF_ONE_FRAME or self.is_estimating:
            return False
        if self._doubted is not None:  # older views show what the scene was before
            return now_s - self.asked_s >= EVERY_S and self.ask_in_background(seen, now_s, draw)
        if not self.sharpening.is_due_for(views, now_s):
            return False
        return self.ask_in_background(views[-1], now_s, draw)

    def look_again(self, steady: TrackedFrame, now_s: float, draw: Draw | None) -> bool:
        """Requests an estimate of a steady frame, or only to follow the light if the last estimate is recent.

        After a while, or soon if the picture has become brighter or darker.
        """
        if self.is_estimating:
            return False
        is_old = now_s - self.asked_s >= EVERY_S
        if not (self.sharpening.is_due_again(now_s) or (is_old and self._brightness.has_jumped(steady.frame))):
            return False
        held = self.held.estimate
        follows = held is not None and self._doubted is None and self.sharpening.is_up_to_date(now_s)
        is_awaited = held is None and not self.sharpening.is_settled  # after some that failed, nobody waits any more
        return self.ask_in_background(steady, now_s, draw, is_awaited, follows)

    def wait(self, timeout_s: float) -> Outcome | None:
        """The worker's outcome, returned once, for which it waits up to `timeout_s`; None if there is none by then."""
        outcome = self._taken(self._worker.wait(timeout_s))
        if self._waiting is not None and not self._worker.busy:
            waiting, self._waiting = self._waiting, None
            self.ask(*waiting)
            return None  # the outcome of the background estimate, which would be taken for the user's
        return outcome

    def stands(self, estimate: LightEstimate | None) -> bool:
        """Whether `estimate` is the answer that stands."""
        return estimate is not None and estimate is self.held.estimate

    def _taken(self, outcome: Outcome | None) -> Outcome | None:
        if outcome is None:
            return None
        if not isinstance(outcome, Answer):
            self.sharpening.answered(False)
            return outcome
        if self.frozen is not None and outcome.estimate is not None:
            self.held.move_to(self.frozen)
        has_changed = len(outcome.outdated) == len(self._others) > 0
        if has_changed and outcome.estimate is None:
            self._doubted = self.frozen
            self.key_views.drop([view for view in self.key_views.views if view is self.frozen])
            return outcome
        if outcome.is_followed and outcome.estimate is not None:
            self.held.follow(outcome.estimate)
            self.sharpening.verified()
        elif outcome.estimate is not None:
            if self._is_awaited:
                self.held = HeldAnswer(self.frozen)
            is_sharper = self.held.offer(outcome.estimate, has_changed, outcome.has_lost_shadows)
            if has_changed and self.held.is_news:
                self.sharpening = Sharpening()
            self.sharpening.answered(is_sharper or self.held.is_disputed)
        # While a hand is before the camera, no view shows what it shows; they are of use again when it has gone.
        if not has_changed or self.held.is_news:
            self._doubted = None
            self.key_views.drop([self._others[place] for place in outcome.outdated])
        return outcome
