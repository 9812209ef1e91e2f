"""The models to choose from, loaded off the main thread so that no switch stalls the picture."""

import time
from concurrent.futures import Future
from pathlib import Path

from ashe_live.errors import UserError
from ashe_live.models.catalogue import model_names
from ashe_live.models.placement import PlacedModel
from ashe_live.models.reading import read_model
from ashe_live.viewer.background import begun

# A line that is gone before it can be read would only flicker.
SILENT_S = 0.3


class Shelf:
    """The shipped models, and before them the file that the user named, if any.

    A model that cannot be read is reported once by `take_error`, and the last good one stays.
    """

    def __init__(self, first_choice: str, marker_side_m: float) -> None:
        """Loads `first_choice`, a shipped name or a file, at once. Raises UserError when it is neither."""
        self._marker_side_m = marker_side_m
        shipped = list(model_names())
        self.names = shipped if first_choice in shipped else [first_choice, *shipped]
        self._loading: dict[str, Future[PlacedModel]] = {}
        self._begun_s: dict[str, float] = {}
        self._chosen = self.names.index(first_choice)
        self._shown_name = first_choice
        self._untried: set[str] = set()  # dropped, and not read yet
        self._shown = self._load(first_choice).result()
        self._error: UserError | None = None

    def choose(self, index: int) -> bool:
        """Chooses a model by its place; returns False when there is none."""
        if not 0 <= index < len(self.names):
            return False
        self._chosen = index
        return True

    def step(self, by: int) -> None:
        self._chosen = (self._chosen + by) % len(self.names)

    def add(self, path: str) -> None:
        """Chooses a model file, after all others; one that is there already is read anew.

        When it cannot be read and never could, it goes again.
        """
        if path not in self.names:
            self.names.append(path)
            self._untried.add(path)
        self._loading.pop(path, None)
        self._chosen = self.names.index(path)

    @property
    def chosen_name(self) -> str:
        return self.names[self._chosen]

    def model(self) -> PlacedModel:
        """The chosen model as soon as it is loaded, until then the one before."""
        loading = self._load(self.chosen_name)
        if loading.done():
            try:
                self._shown, self._shown_name = loading.result(), self.chosen_name
                self._untried.discard(self.chosen_name)
            except UserError as error:
                # Forgotten, so that a mended file can be chosen again.
                failed = self.chosen_name
                del self._loading[failed]
                if failed in self._untried:
                    self._untried.remove(failed)
                    self.names.remove(failed)
                self._error, self._chosen = error, self.names.index(self._shown_name)
        return self._shown

    @property
    def progress(self) -> str | None:
        """A message while the chosen model is loading, if that takes long."""
        loading = self._loading.get(self.chosen_name)
        if loading is None or loading.done():
            return None
        waited_s = time.monotonic() - self._begun_s[self.chosen_name]
        return None if waited_s < SILENT_S else f"loading {Path(self.chosen_name).name}: {waited_s:.0f} s"

    def take_error(self) -> UserError | None:
        error, self._error = self._error, None
        return error

    def _load(self, name: str) -> Future[PlacedModel]:
        if name not in self._loading:
            self._begun_s[name] = time.monotonic()
            self._loading[name] = begun(
                "model",
                lambda: read_model(name, self._marker_side_m),
                lambda reason: UserError(f"cannot show the model {name} ({reason})", "choose another"),
            )
        return self._loading[name]
