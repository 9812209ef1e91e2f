"""Where a model stands, and how models were left at their places, in this run and in earlier ones."""

from dataclasses import dataclass, field, replace

from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement
from ashe_live.render.beside import FirstPlaces
from ashe_live.viewer.table.shelf import Shelf

AT_FIRST = UNMOVED.shift_m  # as it is kept, it means the place of a model that nobody has moved, wherever that is


@dataclass(frozen=True, slots=True)
class Stand:
    """A model at its place. For the model in hand, as it stood when it was taken up."""

    name: str
    model: PlacedModel
    placement: Placement = UNMOVED  # as set by hand, relative to its place
    seat: int = 0  # its place among the models on its marker: 0 in the middle, 1 to the right, 2 to the left, ...
    marker: str | None = None
    # The model that was chosen for it last, until that is loaded; what is shown is the same whichever it is.
    awaited: str | None = field(default=None, compare=False)

    @property
    def where(self) -> str:
        """A key for its place among those on all markers."""
        return str(self.seat) if self.marker is None else f"{self.marker} {self.seat}"

    @property
    def key(self) -> tuple[str, str]:
        return self.name, self.where


def place_of(marker: str | None, followed: str | None, tracked: TrackedFrame | None) -> Placement | None:
    """The place of a marker, at the size that a model has on the one that is followed; None while it is not in view.

    marker: its spec, None for the one that is followed, whose own spec is `followed`.
    """
    if marker in (None, followed):
        return UNMOVED
    if tracked is None or tracked.marker is None:
        return None
    for other in tracked.others:
        if other.spec == marker:
            x, y = other.centre_m
            return Placement(other.side_m / tracked.marker.side_m, other.turn_rad, (float(x), float(y)))
    return None


class LeftPlaces:
    """How models were left, by their names and places.

    `first`: where models that nobody has moved stand on the followed marker; beside it if that is on a body.
    """

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf
        self._left: dict[tuple[str, str], Placement] = {}  # in this run

    def of(self, stand: Stand, first: FirstPlaces) -> Placement:
        """How the model stands when it comes there."""
        left, here = self._left.get(stand.key), first.of(stand.seat)
        known = self._shelf.placement(*stand.key) if left is None else left
        # What was remembered from another marker does not count beside a body, which may stand at that place.
        is_at_first = known.shift_m == AT_FIRST or (left is None and here != UNMOVED)
        return replace(known, shift_m=here.shift_m) if is_at_first and stand.marker is None else known

    def cleared(self, stand: Stand, before: FirstPlaces, first: FirstPlaces) -> Placement:
        """How it stands from now on, if the first place has changed from `before` to `first`."""
        if stand.key not in self._left and stand.placement == self.of(stand, before):
            return self.of(stand, first)
        is_at_first = stand.marker is None and stand.placement.shift_m == before.of(stand.seat).shift_m
        return replace(stand.placement, shift_m=first.of(stand.seat).shift_m) if is_at_first else stand.placement

    def keep(self, stand: Stand, first: FirstPlaces) -> None:
        """Remembers how the model stands, for when it stands there again, in this run or another."""
        if stand.key in self._left or stand.placement != self.of(stand, first):
            at_first = stand.marker is None and stand.placement.shift_m == first.of(stand.seat).shift_m
            kept = replace(stand.placement, shift_m=AT_FIRST) if at_first else stand.placement
            if self._left.get(stand.key) != kept:
                self._left[stand.key] = kept
                self._shelf.keep_placement(*stand.key, kept)

    def exchanged(self, stand: Stand, name: str, model: PlacedModel, first: FirstPlaces) -> Stand:
        """Another model at the place of `stand`, as it was left there; the same one stays as it stands."""
        if name == stand.name:  # on another side
            return replace(stand, model=model, awaited=None)
        self.keep(stand, first)
        other = replace(stand, name=name, model=model, awaited=None)
        return replace(other, placement=self.of(other, first))

    def settled(self, stand: Stand, first: FirstPlaces) -> Stand:
        """`stand` with the model that it awaits, once that is loaded; without awaiting it where it cannot be read."""
        if stand.awaited is None:
            return stand
        try:
            model = self._shelf.finished(stand.awaited)
        except UserError:
            return replace(stand, awaited=None)
        return stand if model is None else self.exchanged(stand, stand.awaited, model, first)

    def forget_this_run(self) -> None:
        """Forgets what another run would not know."""
        self._left.clear()
