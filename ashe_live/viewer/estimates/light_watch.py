"""Requests estimates from the light worker as the camera moves, and keeps the answer that stands."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ashe_live.core.arrays import Image
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.light.estimators.estimator import OF_ONE_FRAME
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.live.comparable import fits
from ashe_live.light.live.held_answer import HeldAnswer
from ashe_live.light.live.key_views import KeyViews
from ashe_live.light.live.worker import LightWorker, Outcome
from ashe_live.light.live.worker_messages import (
    Draw,
    Estimated,
    EstimateTask,
    Followed,
    OtherScene,
    Unchanged,
    WorkerFailure,
)
from ashe_live.viewer.estimates.brightness import Brightness
from ashe_live.viewer.estimates.held_empty_table import HeldEmptyTable
from ashe_live.viewer.estimates.sharpening import EVERY_S, Sharpening


@dataclass(frozen=True, slots=True, eq=False)
class NewAnswer:
    """An estimate that is the answer from now on."""

    estimate: LightEstimate
    frozen: TrackedFrame  # the frame that it is of
    asked_s: float
    steps_bgr: Image | None  # a sheet of the steps to it, where one was asked for and the estimator keeps them
    is_news: bool  # whether it is another light than before, or the first
    is_over_empty_table: bool = False  # whether only what came onto the table counts


class LightWatch:
    """The light of one scene: requested by the user, then refined with the key views. For use by one thread."""

    def __init__(self, worker: LightWorker) -> None:
        self.preset = BALANCED
        self.key_views = KeyViews()  # of the scene that is shown; the capture thread adds to them
        self.camera_may_move = False  # whether the source is a camera that the user may move
        self.is_photo = False  # which has no other frame
        self.held = HeldAnswer()  # since the user's last request
        self.empty_table = HeldEmptyTable()
        self._is_over_empty_table = False  # whether the held answer was found so
        self.sharpening = Sharpening()
        self._asked_s = -math.inf
        self._frozen: TrackedFrame | None = None  # of the last request
        self._others: Sequence[TrackedFrame] = ()  # the other views of the last request
        # A frame that shows another scene than the key views: the scene has changed if the frames after it show the
        # same, and else something has passed before the camera.
        self._doubted: TrackedFrame | None = None
        self._is_awaited = False
        self._brightness = Brightness()  # of the frame of the last request
        self._worker = worker

    @property
    def is_estimating(self) -> bool:
        return self._worker.busy

    @property
    def is_awaited(self) -> bool:
        """Whether an estimate that the user waits for is in progress."""
        return self._worker.busy and self._is_awaited

    @property
    def how_it_gets_known(self) -> str:
        """What to do about the light while none has been estimated."""
        return "it is being estimated" if self.is_estimating else "Space estimates it"

    @property
    def waited_s(self) -> float:
        """How long the estimate in progress has taken, without the time in which this process was suspended."""
        return self._worker.waited_s

    @property
    def may_show_empty_table(self) -> bool:
        """Whether the user may still show it, to some use."""
        return self.camera_may_move and self.empty_table.frame is None and not self._worker.takes_one_frame

    def begin_anew(self) -> None:
        """Forgets the scene, and gives up an estimate in progress."""
        self._frozen, self._others, self._doubted = None, (), None
        self.held, self.sharpening = HeldAnswer(), Sharpening()
        self.empty_table = HeldEmptyTable()
        self.key_views.drop()
        self._worker.give_up()

    def ask(self, frozen: TrackedFrame, now_s: float, draw: Draw | None = None) -> bool:
        """The user requests an estimate of a frame together with the current key views; returns whether it is accepted.

        While another one that the user waits for is in progress, a request is refused; a background estimate is given
        up for it. The answer to it replaces any held one.
        """
        if self._worker.busy and not self.is_awaited:
            # What it may still find would not be shown, and at its low priority a busy machine may give it nothing.
            self._worker.give_up()
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
        task = EstimateTask(self.preset, draw, is_awaited, held, follows)
        doubted = self._doubted if self._doubted is not None and fits(self._doubted, frozen) else None
        if not self._worker.request(frozen, others, doubted, task, self.empty_table.under(frozen)):
            return False
        self._frozen, self._others, self._asked_s, self._is_awaited = frozen, others, now_s, is_awaited
        self._brightness.note(frozen.frame)
        self.sharpening.asked(views, now_s)
        return True

    def show_empty_table(self, tracked: TrackedFrame | None) -> str:
        """The user says that a frame shows the table without the object; returns what to do next."""
        if tracked is None or tracked.marker is None:
            return "no marker in view"
        if tracked.marker.body is not None:
            return "the paper cube's light is found without an empty table"
        if self._worker.takes_one_frame:
            return "this estimator makes no use of the empty table"
        if self.is_photo:
            return (
                "a photo has no second frame: `ashe-live estimate PHOTO --empty EMPTY` takes a photo of the empty table"
            )
        self.empty_table.show(tracked)
        if not self.camera_may_move:
            return "the empty table is known: in another frame of this view press Space"
        return "the empty table is known: put the object there, leave the camera where it is, press Space"

    def sharpen(self, seen: TrackedFrame, now_s: float, draw: Draw | None) -> bool:
        """Requests an estimate of the key views if there is an answer to refine and they show more; returns whether.

        If the last request showed another scene, what is `seen` now shows whether the scene has changed.
        """
        views = self.key_views.views
        held = self.held.estimate
        if held is None or held.estimator in OF_ONE_FRAME or self.is_estimating:
            return False
        if self._doubted is not None:  # older views show what the scene was before
            return now_s - self._asked_s >= EVERY_S and self.ask_in_background(seen, now_s, draw)
        if not self.sharpening.is_due_for(views, now_s):
            return False
        return self.ask_in_background(views[-1], now_s, draw)

    def look_again(self, steady: TrackedFrame, now_s: float, draw: Draw | None) -> bool:
        """Requests an estimate of a steady frame, or only to follow the light if the last estimate is recent.

        After a while, or soon if the picture has become brighter or darker.
        """
        if self.is_estimating:
            return False
        is_old = now_s - self._asked_s >= EVERY_S
        if not (self.sharpening.is_due_again(now_s) or (is_old and self._brightness.has_jumped(steady.frame))):
            return False
        held = self.held.estimate
        follows = held is not None and self._doubted is None and self.sharpening.is_up_to_date(now_s)
        is_awaited = held is None and not self.sharpening.is_settled  # after some that failed, nobody waits any more
        return self.ask_in_background(steady, now_s, draw, is_awaited, follows)

    def wait(self, timeout_s: float) -> NewAnswer | WorkerFailure | None:
        """What the worker has found, returned once, for which it waits up to `timeout_s`; None where that is nothing
        new, or nothing by then.
        """
        outcome = self._worker.wait(timeout_s)
        return None if outcome is None else self._taken(outcome)

    def _taken(self, outcome: Outcome) -> NewAnswer | WorkerFailure | None:
        """The answer from now on, by what the worker has found; None where the one before stands."""
        frozen = self._frozen
        assert frozen is not None
        is_in_doubt, steps_bgr = False, None
        match outcome:
            case WorkerFailure():
                self.sharpening.answered(False)
                return outcome
            case OtherScene():
                self._doubted = frozen
                # By its number: of a large picture the view is a smaller copy.
                number = frozen.frame.index
                self.key_views.drop([view for view in self.key_views.views if view.frame.index == number])
                return None
            case Followed():
                self.held.move_to(frozen)
                self.held.follow(outcome.estimate)
                self.sharpening.verified()
            case Estimated():
                if outcome.shows_empty_table:
                    self.empty_table.found(frozen)
                self.held.move_to(frozen)
                is_in_doubt, steps_bgr = self._offer(outcome), outcome.picture_bgr
        # While a hand is before the camera, no view shows what it shows; they are of use again when it has gone.
        if not is_in_doubt:
            self._doubted = None
            self.key_views.drop([self._others[place] for place in outcome.outdated])
        if isinstance(outcome, Unchanged) or outcome.estimate is not self.held.estimate:
            return None
        if isinstance(outcome, Estimated):
            self._is_over_empty_table = outcome.is_over_empty_table
        is_news, is_over_empty = self.held.is_news, self._is_over_empty_table
        return NewAnswer(outcome.estimate, frozen, self._asked_s, steps_bgr, is_news, is_over_empty)

    def _offer(self, new: Estimated) -> bool:
        """Offers an estimate to the held answer; returns whether it may be of a scene with a hand in it."""
        if self._is_awaited:
            self.held = HeldAnswer(self._frozen)
        is_sharper = self.held.offer(new.estimate, new.is_of_changed_scene, new.has_lost_shadows)
        if new.is_of_changed_scene and self.held.is_news:
            self.sharpening = Sharpening()
        self.sharpening.answered(is_sharper or self.held.is_disputed)
        return new.is_of_changed_scene and not self.held.is_news
