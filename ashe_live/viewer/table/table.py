"""What stands on the table, and what keys and mouse do to it and to the light."""

from collections.abc import Callable, Sequence
from pathlib import Path

from ashe_live.core.light import Illumination
from ashe_live.core.types import TrackedFrame
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.models.placement import UNMOVED, PlacedModel
from ashe_live.process.messages import listed, print_message
from ashe_live.viewer.hands.hand import Hand, HandContext
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.hands.undo import Undo
from ashe_live.viewer.table.arrangement import Arrangement
from ashe_live.viewer.table.shelf import Shelf

SETS_LIGHT = frozenset(
    (Command.MOVE_LIGHT, Command.LIGHT_STRENGTH, Command.LIGHT_SOFTNESS, Command.LIGHT_COLOUR, Command.LIGHT_DISTANCE)
)
CHANGES_MODEL = frozenset((Command.MOVE_MODEL, Command.SCALE_MODEL, Command.TURN_MODEL))


class MotionClock:
    """The clock of moving models, which a person can stop; its seconds are the caller's, which may be a clip's."""

    def __init__(self) -> None:
        self.is_stopped = False
        self.time_s = 0.0  # since the motion began, without the time for which it was stopped
        self._last_s: float | None = None

    def tick(self, now_s: float) -> None:
        """Advances to `now_s`; does nothing while it is stopped, or if the caller's clock went back."""
        if self._last_s is not None and not self.is_stopped:
            self.time_s += max(0.0, now_s - self._last_s)
        self._last_s = now_s

    def toggle(self) -> None:
        self.is_stopped = not self.is_stopped


class Table:
    """The models, the hand that holds one of them, and what it has set in the place of the estimated light."""

    def __init__(self, shelf: Shelf, others: Sequence[ChosenModel], say: Callable[[str, float], None]) -> None:
        """`others` stand beside the model that `shelf` begins with; `say` shows a line from a moment on."""
        self.hand = Hand()
        self.arrangement = Arrangement(shelf, self.hand, others)
        self.motion = MotionClock()
        self.drawn: tuple[PlacedModel, ...] = ()  # the models in the last picture; empty if nobody reports them
        self.shelf = shelf
        self._say = say
        self._undo = Undo()
        self._met_name: str | None = None  # the model in the hand, once it is known whether it moves

    @property
    def model(self) -> PlacedModel:
        """The one in the hand."""
        return self.shelf.shown

    @property
    def model_name(self) -> str:
        """The name of the model in the hand as it is shown: for a file without its folders."""
        return Path(self.shelf.shown_name).name

    @property
    def in_hand_text(self) -> str:
        """The model that keys and mouse change, and which of several it is."""
        count = len(self.arrangement)
        return self.model_name if count == 1 else f"{self.model_name} ({self.arrangement.in_hand + 1} of {count})"

    @property
    def offered(self) -> tuple[tuple[str, ...], int]:
        """The names of the models to choose from, and the index of the chosen one."""
        names = tuple(Path(name).name for name in self.shelf.names)
        return names, self.shelf.names.index(self.shelf.chosen_name)

    @property
    def is_drawn(self) -> bool:
        """Whether the model in the hand is in the picture by now, as far as is known."""
        return not self.drawn or any(each is self.model for each in self.drawn)

    @property
    def progress(self) -> str | None:
        """A message while a model is being loaded, or prepared for drawing, if that takes long."""
        return self.shelf.progress(self.is_drawn)

    @property
    def motion_s(self) -> float:
        """The time in their motion at which the models are shown; 0 if none moves."""
        return self.motion.time_s if self.arrangement.moves else 0.0

    def begin_anew(self) -> None:
        """Resets what was done by hand, for another clip or photo."""
        self.arrangement.keep_places()
        self.hand.reset()
        self.arrangement.begin_anew()
        self._undo.forget()

    def take_estimated_light(self) -> None:
        """An estimate takes the place of the light by hand, which undoing gives back."""
        self._undo.note_estimated(self.hand)
        self.hand.light = None

    def poll(self, now_s: float, is_quiet: bool) -> None:
        """Takes what has been loaded, and says, also on the terminal, what is not drawn as its file says.

        `is_quiet`: no message is shown that a hint could hide.
        """
        self.shelf.poll()
        self.arrangement.settle()
        if (error := self.shelf.take_error()) is not None:
            is_quiet = False
            self._say(str(error), now_s)
        self.motion.tick(now_s)
        if notes := self.shelf.take_notes():
            self._say("; ".join(notes), now_s)
            for line in notes:
                print_message(line)
        self._follow_shelf(now_s, is_quiet and not notes)

    def handle(self, request: Request, tracked: TrackedFrame | None, estimated: Illumination, now_s: float) -> bool:
        """Handles a request that concerns models or the light by hand; returns False for any other.

        `estimated`: the light without what was set by hand.
        """
        match request.command:
            case Command.CHOOSE_MODEL:
                if not self.shelf.choose(request.number):
                    self._say(f"there are {len(self.shelf.names)} models", now_s)
            case Command.PREVIOUS_MODEL:
                self.shelf.step(-1)
            case Command.NEXT_MODEL:
                self.shelf.step(+1)
            case Command.TURN_UP:
                self._say(self._turned_up(+1), now_s)
                self._undo.note_turned_up(lambda: f"undone: {self._turned_up(-1)}")
            case Command.STOP_MOTION:
                self._stop_motion(now_s)
            case Command.ADD_MODEL | Command.REMOVE_MODEL | Command.NEXT_IN_HAND:
                self._rearrange(request.command, now_s)
            case Command.UNDO:
                self._say(self._undo.undo(self.hand) or "nothing was done by hand that could be undone", now_s)
            case Command.RESET:
                changed = [] if self.arrangement.is_at_first else [f"{self.model_name} stands as at first"]
                if self.hand.light is not None:  # of which the last line may still speak
                    changed.append("the light is no longer by hand")
                if changed:
                    self._say(f"{listed(changed)}: Ctrl+Z takes that back", now_s)
                self._undo.note(self.hand, request, now_s)
                self.hand.reset()
                self.arrangement.give_back()
            case command if command in SETS_LIGHT | CHANGES_MODEL:
                self._obey_hand(request, tracked, estimated, now_s)
            case _:
                return False
        return True

    def _turned_up(self, by: int) -> str:
        """Stands the model in the hand on another side; says which axis is up then."""
        return f"{self.model_name}: {self.shelf.turn_up(by)} is up"

    def _finish_choice(self, now_s: float) -> None:
        """A model that was chosen just now, and is loaded, is the one that the next request is for."""
        self.shelf.poll()
        self._follow_shelf(now_s)

    def _follow_shelf(self, now_s: float, is_quiet: bool = False) -> None:
        if self.arrangement.follow_shelf():
            self._undo.forget_model()
        if self.shelf.shown_name != self._met_name:
            self._met_name = self.shelf.shown_name
            if self.arrangement.is_as_left and is_quiet:
                self._say(f"{self.model_name} stands as it was left: Backspace gives its first place and size", now_s)
            elif self.shelf.moves and is_quiet:
                self._say(f"{self.model_name} {self._motion_now}", now_s)

    def _rearrange(self, command: Command, now_s: float) -> None:
        models = self.arrangement
        self._finish_choice(now_s)
        if command is Command.NEXT_IN_HAND:
            self._note_other_taken_up(models.step(), now_s)
            if len(models) == 1:
                self._say("there is one model: T puts another beside it", now_s)
            return
        gone = f"{self.model_name} is taken away: Ctrl+Z puts it back"
        is_new = command is Command.ADD_MODEL
        take_back = models.add() if is_new else models.remove()
        if take_back is not None:
            self._undo.note_change(take_back)
            self._say(self.in_hand_text if is_new else gone, now_s)
        elif is_new:
            self._say(f"{MOST_MODELS} models are the most: Delete takes the one in hand away", now_s)
        else:
            self._say("the last model stays: B hides it", now_s)

    def _note_other_taken_up(self, take_back: Callable[[], str | None] | None, now_s: float) -> None:
        if take_back is not None:
            self._undo.note_other_taken_up(take_back)
            self._say(self.in_hand_text, now_s)

    def _obey_hand(self, request: Request, tracked: TrackedFrame | None, estimated: Illumination, now_s: float) -> None:
        match request:
            case Request(Command.MOVE_MODEL, Drag(begin_px, is_first=True)) if tracked is not None:
                self._finish_choice(now_s)
                self._note_other_taken_up(self.arrangement.take_up_at(begin_px, tracked), now_s)
        self._undo.note(self.hand, request, now_s)
        anchor = self.arrangement.anchor(tracked)
        if anchor is None and request.command is Command.MOVE_MODEL:
            self._say(f"its marker {self.arrangement.marker_in_hand} is not in view", now_s)
            return
        context: HandContext | None = None
        if tracked is not None and tracked.marker is not None:
            context = HandContext(tracked, estimated, self.model, anchor or UNMOVED)
        said = self.hand.obey(request, context)
        if said is not None:
            self._say(said, now_s)

    def _stop_motion(self, now_s: float) -> None:
        if not self.arrangement.moves:
            self._say(f"{self.model_name} stands still: it has no animation that is played", now_s)
            return
        self.motion.toggle()
        self._say(f"{self.model_name if self.shelf.moves else 'another model'} {self._motion_now}", now_s)

    @property
    def _motion_now(self) -> str:
        """What models do that can move, and how to change that."""
        return "stands still: K changes that" if self.motion.is_stopped else "moves: K stops it"
