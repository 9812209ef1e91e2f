"""The viewer's state without its window: the same on the screen, for a video file and in the tests."""

import math
from collections.abc import Sequence

from ashe_live.core.arrays import Float
from ashe_live.core.light import Illumination, LightEstimate
from ashe_live.core.types import TrackedFrame
from ashe_live.drawing.steps_sheet import steps_sheet
from ashe_live.light.live.worker import LONGEST_ESTIMATE_S, LightWorker
from ashe_live.light.live.worker_messages import Draw, WorkerFailure
from ashe_live.models.catalogue import ChosenModel
from ashe_live.tracking.families.seen_instead import SeenInstead
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.estimates.light_watch import LightWatch, NewAnswer
from ashe_live.viewer.estimates.not_there_yet import NotThereYet
from ashe_live.viewer.estimates.room_light import RoomLight
from ashe_live.viewer.estimates.sharpening import Sharpening
from ashe_live.viewer.hands.requests import Command, Request
from ashe_live.viewer.notice import Notice
from ashe_live.viewer.table.shelf import Shelf
from ashe_live.viewer.table.table import Table
from ashe_live.viewer.view_options import WHOLE, ViewOptions


class Session:
    """Takes tracked frames and requests; holds the light, the model and what is shown of them."""

    def __init__(
        self,
        shelf: Shelf,
        worker: LightWorker,
        first: FirstEstimate,
        true_to_light_marker: Float | None = None,
        others: Sequence[ChosenModel] = (),
        automatic: bool = False,
    ) -> None:
        """`true_to_light_marker` (3,): known for a rendered clip, so that the estimate's error can be shown.

        `others`: models beside the one that `shelf` begins with. `automatic`: whether the light is watched, and
        estimated anew when it changes, also while the camera stands still.
        """
        self.true_to_light_marker = true_to_light_marker
        self.tracked: TrackedFrame | None = None
        self.answer: NewAnswer | None = None  # the last one
        self.shown = Illumination()  # on its way to `lit_by`
        self.notice = Notice()
        self.say = self.notice.say
        self.table = Table(shelf, others, self.say)
        self.hand, self.arrangement = self.table.hand, self.table.arrangement
        self.automatic = automatic
        self.watch = LightWatch(worker)
        self._not_there_yet = NotThereYet(self.notice, self.watch)
        self.view = ViewOptions(self.notice)
        self.has_named_marker = True  # whether a person has named the one that is looked for
        self.seen_instead = SeenInstead()  # what is seen while the followed marker is not
        self.room_light = RoomLight()
        self.first = first
        self._by_hand_s = -math.inf

    @property
    def lit_by(self) -> Illumination:
        """The illumination that was set by hand, or else the estimated one."""
        return self.estimated_light if self.hand.light is None else self.hand.light

    @property
    def estimated_light(self) -> Illumination:
        """The estimated illumination in the frame of the marker as it lies now, whatever was set by hand."""
        return self.room_light.now(self.tracked)

    @property
    def estimate(self) -> LightEstimate | None:
        """That of the last answer."""
        return None if self.answer is None else self.answer.estimate

    @property
    def estimate_now(self) -> LightEstimate | None:
        """The last estimate, in the frame of the marker as it lies now, and not as it lay then."""
        return None if self.estimate is None else self.room_light.seen_by(self.tracked, self.estimate)

    @property
    def covers_marker(self) -> bool:
        """Whether ground is painted over the marker."""
        return self.view.covers_marker(self.tracked)

    def take(self, tracked: TrackedFrame, now_s: float) -> None:
        """Shows `tracked` from now on, and requests an estimate from it where one is due."""
        if tracked.note is not None and (self.tracked is None or self.tracked.note != tracked.note):
            self.say(tracked.note, now_s)
        # By a hand, which would be estimated with the scene.
        is_being_moved = self.tracked is not None and tracked.T_room_marker is not self.tracked.T_room_marker
        self.tracked = tracked
        self.hand.see(tracked)
        self.room_light.see(tracked)
        if is_being_moved:
            self.show_light(now_s)
        self.table.motion.tick(now_s)
        self._stand_clear()
        is_steady = self.first.add(tracked)
        if self.first.is_due_in(tracked):
            self.first.done()
            self.request_estimate(now_s)
        elif self._may_be_watched(tracked) and not is_being_moved:
            is_asked = self.watch.sharpen(tracked, now_s, self._draw)
            if self.automatic and is_steady and not is_asked:
                self.watch.look_again(tracked, now_s, self._draw)

    def _may_be_watched(self, tracked: TrackedFrame) -> bool:
        """Whether the frame may show more of the light: with the marker on its table, and nothing set by hand."""
        return tracked.marker is not None and self.hand.light is None and not self.room_light.is_lifted(tracked)

    def settle_for_last(self, now_s: float) -> bool:
        """At the end of a clip without a steady marker, requests an estimate of its last frame; returns whether."""
        if not self.first.awaits_steady or self.tracked is None or self.tracked.marker is None:
            return False
        self.first.done()
        return self.request_estimate(now_s)

    def begin_anew(self, is_photo: bool) -> None:
        """Resets everything for another clip or photo, which has another light and another marker."""
        self.tracked = self.answer = self.true_to_light_marker = None
        self.room_light = RoomLight()
        self.shown = self.room_light.jump(None)
        self.table.begin_anew()
        self.watch.begin_anew()
        self.first = FirstEstimate(Steadiness.of(is_photo), on_first_steady=True)

    def request_estimate(self, now_s: float) -> bool:
        """Hands the current frame and the key views to the worker for a person who waits; returns whether it took them.

        Shows a message when that is not possible.
        """
        if self.tracked is None or self.tracked.marker is None:
            advice = ": point the camera at it, then press Space" if self.watch.camera_may_move else ""
            self.say(f"no marker in view{advice}", now_s)
        elif not self.watch.ask(self.tracked, now_s, self._draw):
            self._by_hand_s = -math.inf  # the answer that is under way is wanted in the place of a light by hand
            self.say("still estimating", now_s)
        else:
            return True
        return False

    @property
    def _draw(self) -> Draw | None:
        """The function that draws the steps of an estimate; None if they are not shown."""
        return steps_sheet if self.view.shows_steps else None

    def poll(self, now_s: float) -> NewAnswer | None:
        """Takes what the worker and the model loader have finished, and advances the easing of the light.

        Returns a new answer, once.
        """
        self.table.poll(now_s, is_quiet=self.notice.shown(now_s) is None)
        self._stand_clear()
        if (news := self.watch.empty_table.take_news()) is not None:
            self.say(news, now_s)
        new = self._accepted(self.watch.wait(0.0), now_s)
        self.show_light(now_s)
        return new

    def wait_for_estimate(self, now_s: float) -> NewAnswer | None:
        """Like `poll`, but waits for a requested estimate to end; the first is shown at once, as nothing was before."""
        is_first = self.answer is None
        new = self._accepted(self.watch.wait(LONGEST_ESTIMATE_S), now_s)
        self.show_light(None if is_first else now_s)
        return new

    def show_light(self, now_s: float | None) -> None:
        """Shows the light set by hand at once, or the estimated one as far as it has eased by then; None: wholly."""
        by_hand, light = self.hand.light, self.room_light
        if by_hand is not None:
            self.shown = light.show_by_hand(self.tracked, by_hand)
        else:
            self.shown = light.jump(self.tracked) if now_s is None else light.shown(self.tracked, now_s)

    def _stand_clear(self, in_new_light: bool = False) -> None:
        light, in_its_place = self.estimated_light.light, self.view.vacates_body(self.tracked)
        self.arrangement.stand_clear(self.tracked, light, in_its_place, in_new_light)

    def handle(self, request: Request, now_s: float) -> bool:
        """Handles a request that needs neither window nor source; returns False for any other."""
        view = self.view
        match request.command:
            case Command.ESTIMATE:
                self.request_estimate(now_s)
            case Command.EMPTY_TABLE:
                self.say(self.watch.show_empty_table(self.tracked), now_s)
            case Command.AUTOMATIC:
                self._toggle_automatic(now_s)
            case Command.TOGGLE_LIGHT:
                view.shows_light = not view.shows_light
                if not view.shows_light:
                    self._not_there_yet.hide_light()
                elif self.lit_by.light is None:
                    self._not_there_yet.show_light(now_s)
            case Command.TOGGLE_STEPS:
                view.shows_steps = not view.shows_steps
                if view.shows_steps:
                    self._not_there_yet.show_steps(self.answer, now_s)
                else:
                    self._not_there_yet.hide_steps()
            case _:
                return view.handle(request.command, self.tracked, now_s) or self._handle_by_hand(request, now_s)
        return True

    def _handle_by_hand(self, request: Request, now_s: float) -> bool:
        before = self.hand.set_light
        if not self.table.handle(request, self.tracked, self.estimated_light, now_s):
            return False
        if request.command is Command.RESET:
            self.view.parts = WHOLE
        # Also by undoing that it was given back.
        if self.hand.set_light is not None and self.hand.set_light is not before:
            self._by_hand_s = now_s
            self.first.done()
            self._not_there_yet.take_light()
            if self.automatic:
                self.automatic = False
                self.say("the light is by hand: A watches it again", now_s)
        return True

    def _accepted(self, found: NewAnswer | WorkerFailure | None, now_s: float) -> NewAnswer | None:
        if isinstance(found, WorkerFailure):
            self.say(f"the estimate failed: {found.message}", now_s)
        if not isinstance(found, NewAnswer):
            return None
        new, frozen = found.estimate, found.frozen
        self.room_light.take(new.illumination.as_seen_in(frozen), frozen)
        self._stand_clear(in_new_light=True)
        self.answer = found
        self._not_there_yet.take_answer(found, self.view.shows_steps, now_s)
        # An estimate that was requested before the light was set by hand does not replace it.
        if self.hand.light is not None and found.asked_s >= self._by_hand_s:
            if new.light is None:
                self.say(f"no clear light: {new.reason}; it stays as set by hand", now_s)
                self.automatic = False
            else:
                self.table.take_estimated_light()
        return found

    def _toggle_automatic(self, now_s: float) -> None:
        if not self.automatic and self.hand.light is not None and not self.request_estimate(now_s):
            return  # what it says is why the light stays as set by hand
        self.automatic = not self.automatic
        if self.automatic:
            self.watch.sharpening = Sharpening()
            self.say("the light is watched, and estimated anew when it changes: A ends it", now_s)
        else:
            self.say("the light is held: Space estimates it anew", now_s)
