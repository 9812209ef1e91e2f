"""The models to choose from, loaded off the main thread so that no switch stalls the picture."""

import time
from collections.abc import Sequence
from concurrent.futures import Future
from pathlib import Path

from ashe_live.errors import UserError
from ashe_live.models.assembly.up import UPS
from ashe_live.models.catalogue import model_names
from ashe_live.models.memory import ModelMemory
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement
from ashe_live.models.reading import read_model
from ashe_live.viewer.sources.background import in_background

# How long a model may load before a message says so: a line that is gone before it can be read would only flicker.
SILENT_S = 0.3


class Shelf:
    """The shipped models, and before them the files that the user named, if any.

    A model that cannot be read is reported once by `take_error`, and the last good one stays.
    """

    def __init__(
        self,
        first_choice: str,
        marker_side_m: float,
        up: str | None = None,
        memory: ModelMemory | None = None,
        others: Sequence[str] = (),
    ) -> None:
        """Loads `first_choice` and `others`, shipped names or files, at once. Raises UserError when one is neither.

        `up`: which axis of its file is up (models/assembly/up.py), in this run. `memory`: the axes that were chosen by
        a key before.
        """
        self.marker_side_m = marker_side_m
        self._memory = memory
        self._ups: dict[str, str] = {} if up is None else {first_choice: up}
        self._notes: list[str] = []
        self._noted: set[str] = set()
        shipped = model_names()
        self.names = [name for name in dict.fromkeys((first_choice, *others)) if name not in shipped] + list(shipped)
        self._loading: dict[str, Future[PlacedModel]] = {}
        self._waited_for: tuple[str, float] | None = None  # a chosen model that is not shown yet, and since when
        self._chosen = self.names.index(first_choice)
        self._shown_name = first_choice
        self._untried: set[str] = set()  # files that were dropped and have not been read yet
        self._error: UserError | None = None
        self._shown = self.loaded(first_choice)
        for name in others:
            self.loaded(name)

    def loaded(self, name: str, up: str | None = None) -> PlacedModel:
        """Waits for the model of that name, which can be chosen from now on. Raises UserError when it cannot be read.

        `up`: which axis of its file is up from now on; None leaves that as it is.
        """
        if up is not None and (name not in self._loading or self._load(name).result().model.up != up):
            self._ups[name] = up
            self._loading.pop(name, None)
        model = self._load(name).result()
        if name not in self.names:
            self.names.append(name)
        self._note(name, model)
        return model

    def take_up(self, name: str, model: PlacedModel) -> None:
        """Chooses a model that was shown before, as it was then."""
        self._chosen, self._shown, self._shown_name = self.names.index(name), model, name
        latest = self._loading.get(name)
        is_loaded = latest is not None and latest.done() and latest.exception() is None
        if latest is None or (is_loaded and latest.result().model.up != model.model.up):
            self._hold(name, model)

    def choose(self, index: int) -> bool:
        """Chooses a model by its place; returns False when there is none."""
        if not 0 <= index < len(self.names):
            return False
        self._chosen = index
        return True

    def step(self, by: int) -> None:
        self._chosen = (self._chosen + by) % len(self.names)

    def add(self, *paths: str) -> None:
        """Adds model files at the end and chooses the first of them; those that are there already are read anew.

        `paths`: each one once. A file that turns out to be unreadable, and was never read, is taken off again.
        """
        known = set(self.names)
        new = [path for path in paths if path not in known]
        self.names += new
        self._untried.update(new)
        for path in paths:
            self._loading.pop(path, None)
        self._chosen = self.names.index(paths[0])

    def turn_up(self, by: int = 1) -> str:
        """Turns the chosen model onto another of its sides, `by` on in their order; returns which axis is up then."""
        name = self.chosen_name
        before = self._up_of(name) or (self._shown.model.up if name == self._shown_name else UPS[0])
        self._ups[name] = up = UPS[(UPS.index(before) + by) % len(UPS)]
        if self._memory is not None and name not in model_names():
            self._memory.keep_up(name, up)
        self._loading.pop(name, None)
        return up

    def placement(self, name: str, where: str) -> Placement:
        """How a person left the model at that place on the marker, in this run or one before."""
        known = None if self._memory is None else self._memory.placement(name, where, self.marker_side_m)
        return known or UNMOVED

    def keep_placement(self, name: str, where: str, placement: Placement) -> None:
        """Remembers how a model stands at that place; forgets it for a model that is not moved."""
        if self._memory is not None:
            self._memory.keep_placement(name, where, placement, self.marker_side_m)

    def take_notes(self) -> list[str]:
        """Notes on the models that were shown, each line once."""
        notes, self._notes = self._notes, []
        return notes

    @property
    def chosen_name(self) -> str:
        return self.names[self._chosen]

    @property
    def shown(self) -> PlacedModel:
        """The chosen model if it is loaded, until then the one before; changed by `poll` and `take_up` alone."""
        return self._shown

    @property
    def shown_name(self) -> str:
        return self._shown_name

    @property
    def moves(self) -> bool:
        """Whether the model that is shown moves."""
        return self._shown.model.duration_s > 0

    @property
    def awaited_name(self) -> str | None:
        """The chosen model while it is being loaded, or on another side; None once it is shown."""
        name, loading = self.chosen_name, self._loading.get(self.chosen_name)
        return name if name != self._shown_name or loading is None or not loading.done() else None

    def await_again(self, name: str) -> None:
        """Chooses a model that was chosen before, and is being loaded; none if it turned out to be unreadable."""
        if name in self.names:
            self._chosen = self.names.index(name)

    def poll(self) -> None:
        """Shows the chosen model if it has been loaded since; begins to load it if nobody has."""
        name = self.chosen_name
        try:
            model = self.finished(name)
        except UserError:
            self._chosen = self.names.index(self._shown_name)
            if name == self._shown_name:  # read anew, as it was dropped again or turned, and no longer readable
                self._hold(name, self._shown)
            return
        if model is not None:
            self._shown, self._shown_name = model, name

    def finished(self, name: str) -> PlacedModel | None:
        """The model if it has been loaded since; None until then. Begins to load it if nobody has.

        Raises UserError, which `take_error` gives too, when it cannot be read.
        """
        loading = self._load(name)
        if not loading.done():
            return None
        try:
            model = loading.result()
        except UserError as error:
            self._error = error
            del self._loading[name]  # so that a mended file can be chosen again
            if name in self._untried:
                chosen = self.chosen_name
                self._untried.remove(name)
                self.names.remove(name)
                self._chosen = self.names.index(self._shown_name if chosen == name else chosen)
            raise
        self._untried.discard(name)
        if model is not self._shown:
            self._note(name, model)
        return model

    def progress(self, is_drawn: bool) -> str | None:
        """A message until the chosen model is loaded and in the picture, if that takes long.

        `is_drawn`: whether the model that is shown is in the picture.
        """
        loading = self._loading.get(self.chosen_name)
        if is_drawn and (loading is None or loading.done()):
            self._waited_for = None
            return None
        now_s = time.monotonic()
        if self._waited_for is None or self._waited_for[0] != self.chosen_name:
            self._waited_for = self.chosen_name, now_s
        waited_s = now_s - self._waited_for[1]
        return None if waited_s < SILENT_S else f"loading {Path(self.chosen_name).name}: {waited_s:.0f} s"

    def take_error(self) -> UserError | None:
        error, self._error = self._error, None
        return error

    def _note(self, name: str, placed: PlacedModel) -> None:
        """Notes, the first time that a model is shown, what of its file is not drawn, and which axis is a guess."""
        model, file = placed.model, Path(name).name
        # Only a person's own models need words: what the shipped ones lack is documented (docs/models.md).
        if model.notes and name not in self._noted and name not in model_names():
            self._notes.append(f"{file}: {'; '.join(model.notes)}")
        if model.is_up_guessed and name not in self._noted:
            self._notes.append(f"{file} is taken to stand with {model.up} up: U, or --up, makes it another axis")
        self._noted.add(name)

    def _hold(self, name: str, model: PlacedModel) -> None:
        """Counts a model as loaded, as it was then, so that its file is not read again."""
        self._loading[name] = as_then = Future[PlacedModel]()
        as_then.set_result(model)
        self._ups[name] = model.model.up

    def _up_of(self, name: str) -> str | None:
        remembered = None if self._memory is None or name in model_names() else self._memory.up(name)
        return self._ups.get(name, remembered)

    def _load(self, name: str) -> Future[PlacedModel]:
        if name not in self._loading:
            self._loading[name] = in_background(
                "model",
                lambda: read_model(name, self.marker_side_m, self._up_of(name)),
                lambda reason: UserError(f"cannot show the model {name} ({reason})", "choose another"),
            )
        return self._loading[name]
