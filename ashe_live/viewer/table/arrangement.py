"""The models on the table: one in hand, which keys and mouse change, and others that stand as they were left."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from ashe_live.core.light import Light
from ashe_live.core.types import TrackedFrame
from ashe_live.models.catalogue import MOST_MODELS, ChosenModel
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement, seat_beside
from ashe_live.render.beside import FirstPlaces, first_places
from ashe_live.viewer.hands.hand import Hand
from ashe_live.viewer.hands.pointing import Pixel
from ashe_live.viewer.table.pointed_at import model_at
from ashe_live.viewer.table.shelf import Shelf
from ashe_live.viewer.table.stand import LeftPlaces, Stand, place_of


class Arrangement:
    """Which models there are, where each stands, and which of them is in the hand."""

    def __init__(self, shelf: Shelf, hand: Hand, others: Sequence[ChosenModel] = ()) -> None:
        """The first model is the one that `shelf` shows; `others` stand beside it, or on markers of their own."""
        self.in_hand = 0
        self.followed: str | None = None  # spec of the marker that is followed; None: no model's own one
        self._shelf = shelf
        self._hand = hand
        self._stands = [Stand(shelf.shown_name, shelf.shown)]
        for other in others:
            seat = self._free_seat(other.marker)
            self._stands.append(Stand(other.name, shelf.loaded(other.name), UNMOVED, seat, other.marker))
        self._left = LeftPlaces(shelf)
        self._first = FirstPlaces()  # where models stand that nobody has moved
        self._first_is_due = True  # whether it must still be found, by the light and the marker's body
        self._in_its_place = False  # whether it was found for a body that is covered
        self._stand_as_left()

    def __len__(self) -> int:
        return len(self._stands)

    @property
    def stands(self) -> tuple[Stand, ...]:
        """All models in their order; the one in hand as it stands now."""
        in_hand = self._as_it_is()
        return tuple(in_hand if number == self.in_hand else stand for number, stand in enumerate(self._stands))

    def stand_as(self, stands: tuple[Stand, ...]) -> None:
        """Replaces all models by these; the first of them is in the hand."""
        self._stands = list(stands)
        self._take_up(0)

    @property
    def marker_in_hand(self) -> str | None:
        """The spec of the marker that the model in hand stands on; None for the one that is followed."""
        return self._stands[self.in_hand].marker

    @property
    def chosen(self) -> list[ChosenModel]:
        """All models in their order, as the command line would name them."""
        return [ChosenModel(stand.name, stand.marker) for stand in self.stands]

    @property
    def moves(self) -> bool:
        """Whether any of the models moves."""
        others = (stand for number, stand in enumerate(self._stands) if number != self.in_hand)
        return self._shelf.moves or any(stand.model.model.duration_s > 0 for stand in others)

    def models(self, tracked: TrackedFrame | None) -> list[tuple[str, PlacedModel, Placement | None]]:
        """All models in their order, with names and placements; no placement if the marker is not in the frame."""
        found = []
        for stand in self.stands:
            anchor = self._anchor(stand, tracked)
            found.append((stand.name, stand.model, None if anchor is None else anchor @ stand.placement))
        return found

    def without_marker(self, tracked: TrackedFrame) -> tuple[str, ...]:
        """Specs of the markers that models stand on, and that are not in the frame."""
        specs = dict.fromkeys(stand.marker for stand in self._stands if stand.marker is not None)
        return tuple(spec for spec in specs if place_of(spec, self.followed, tracked) is None)

    def anchor(self, tracked: TrackedFrame | None) -> Placement | None:
        """The place that the placement in hand is relative to; None while that model's marker is not in view."""
        return self._anchor(self._stands[self.in_hand], tracked)

    def add(self) -> Callable[[], str] | None:
        """Puts one more like that in hand beside the others, and takes it up; None where there are too many.

        What is returned takes it away again, and the former one up, and says so; so with `remove`.
        """
        if len(self) >= MOST_MODELS:
            return None
        self._put_down()
        before, like = self.in_hand, self._stands[self.in_hand]
        added = replace(like, seat=self._free_seat(like.marker))
        self._stands.append(replace(added, placement=self._first_of(added)))
        self._take_up(len(self) - 1)

        def take_back() -> str:
            gone = self._as_it_is()
            self._stands.pop()
            self._take_up(before)
            return f"undone: {Path(gone.name).name} is gone again"

        return take_back

    def remove(self) -> Callable[[], str] | None:
        """Takes the model in hand away; None for the only one."""
        if len(self) == 1:
            return None
        number, gone = self.in_hand, self._as_it_is()
        del self._stands[number]
        self._take_up(min(number, len(self) - 1))

        def take_back() -> str:
            self._put_down()
            self._stands.insert(number, gone)
            self._take_up(number)
            return f"undone: {Path(gone.name).name} is back"

        return take_back

    def step(self) -> Callable[[], str | None] | None:
        """Takes up the next model; None if there is only one.

        What is returned takes the former one up again, and says so, unless that is in the hand; so with `take_up_at`.
        """
        return self._changed_to((self.in_hand + 1) % len(self))

    def take_up_at(self, at_px: Pixel, tracked: TrackedFrame) -> Callable[[], str | None] | None:
        """Takes up the model at a pixel of the video, or the nearest one; None where that is in the hand already."""
        number = model_at(at_px, tracked, [(model, placement) for _, model, placement in self.models(tracked)])
        return None if number is None else self._changed_to(number)

    def stand_clear(
        self, tracked: TrackedFrame | None, light: Light | None, in_its_place: bool, in_new_light: bool = False
    ) -> None:
        """Has a model that nobody has moved stand over the marker; if that is on a body, clear of body and shadow.

        in_its_place: the body is covered, and the model takes its place. It is done once for each of the two, and
        again `in_new_light`.
        """
        self._first_is_due |= in_new_light or in_its_place != self._in_its_place
        self._in_its_place = in_its_place
        if not self._first_is_due or tracked is None or tracked.marker is None:
            return
        self._first_is_due = False
        before, self._first = self._first, first_places(tracked, light, in_its_place)
        in_hand = replace(self._stands[self.in_hand], placement=self._hand.placement)
        self._hand.placement = self._left.cleared(in_hand, before, self._first)
        self._stands = [
            replace(stand, placement=self._left.cleared(stand, before, self._first)) for stand in self._stands
        ]

    def begin_anew(self) -> None:
        """Resets the places for another clip or photo: every model stands as it would in another run."""
        self._left.forget_this_run()
        self._first, self._first_is_due = FirstPlaces(), True
        self._stand_as_left()

    def give_back(self) -> None:
        """Has the model in the hand stand as if nobody had ever moved it."""
        self._hand.placement = self._first_of(self._stands[self.in_hand])
        self.keep_places()

    def keep_places(self) -> None:
        """Remembers how the model in the hand stands, for when it stands there again, in this run or another."""
        self._left.keep(self._as_it_is(), self._first)

    @property
    def is_moved(self) -> bool:
        """Whether the model in the hand stands elsewhere than where it stood at first."""
        return self._hand.placement.shift_m != self._first_of(self._stands[self.in_hand]).shift_m

    @property
    def is_at_first(self) -> bool:
        """Whether the model in the hand stands as models stand at first."""
        return self._hand.placement in (UNMOVED, self._first_of(self._stands[self.in_hand]))

    @property
    def is_as_left(self) -> bool:
        """Whether the model in the hand stands as a person left it before, and not as models stand at first."""
        stand = self._as_it_is()
        return not self.is_at_first and stand.placement == self._left.of(stand, self._first)

    def follow_shelf(self) -> bool:
        """Takes up the shelf's model where the former one stood and as large; returns whether it is another one."""
        stand, shown = self._stands[self.in_hand], self._shelf.shown_name
        if shown == stand.name:
            return False
        in_hand = replace(stand, placement=self._hand.placement)
        self._stands[self.in_hand] = self._left.exchanged(in_hand, shown, self._shelf.shown, self._first)
        self._hand.placement = self._stands[self.in_hand].placement
        return True

    def settle(self) -> None:
        """Gives models that were put down while others were being loaded in their places those, once they are there."""
        self._stands = [
            stand if number == self.in_hand else self._left.settled(stand, self._first)
            for number, stand in enumerate(self._stands)
        ]

    def _first_of(self, stand: Stand) -> Placement:
        return self._first.of(stand.seat) if stand.marker is None else UNMOVED

    def _changed_to(self, number: int) -> Callable[[], str | None] | None:
        if number == self.in_hand:
            return None
        before = self.in_hand
        self._put_down()
        self._take_up(number)

        def take_back() -> str | None:
            if before == self.in_hand:
                return None
            self._put_down()
            self._take_up(before)
            return f"undone: {Path(self._stands[before].name).name} is in hand again"

        return take_back

    def _as_it_is(self) -> Stand:
        """How the model in hand stands now."""
        at, shelf = self._stands[self.in_hand], self._shelf
        return Stand(shelf.shown_name, shelf.shown, self._hand.placement, at.seat, at.marker, shelf.awaited_name)

    def _put_down(self) -> None:
        self.keep_places()
        self._stands[self.in_hand] = self._as_it_is()

    def _stand_as_left(self) -> None:
        self._stands = [replace(stand, placement=self._left.of(stand, self._first)) for stand in self._stands]
        self._hand.placement = self._stands[self.in_hand].placement

    def _take_up(self, number: int) -> None:
        self.in_hand, stand = number, self._stands[number]
        self._shelf.take_up(stand.name, stand.model)
        if stand.awaited is not None:
            self._shelf.await_again(stand.awaited)
        self._hand.take_up(stand.placement)

    def _free_seat(self, marker: str | None) -> int:
        taken = {stand.seat for stand in self._stands if stand.marker == marker}
        return next(seat for seat in range(len(taken) + 1) if seat not in taken)

    def _anchor(self, stand: Stand, tracked: TrackedFrame | None) -> Placement | None:
        place = place_of(stand.marker, self.followed, tracked)
        seat = stand.seat
        if stand.marker is not None and stand.marker == self.followed:  # after those of whichever marker is followed
            seat += max((other.seat + 1 for other in self._stands if other.marker is None), default=0)
        return None if place is None else place @ seat_beside(seat, self._shelf.marker_side_m)
