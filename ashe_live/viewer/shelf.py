"""The models to choose from, loaded off the main thread so that no switch stalls the picture."""

from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Self

from ashe_live.errors import UserError
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import PlacedModel, placed_on_marker


class Shelf:
    """The shipped models, and before them the file that the user named, if any.

    A model that cannot be read is reported once by `take_error`, and the last good one stays.
    """

    def __init__(self, first_choice: str, marker_side_m: float) -> None:
        """Loads `first_choice`, a shipped name or a file, at once. Raises UserError when it is neither."""
        self._marker_side_m = marker_side_m
        shipped = list(model_names())
        self.names = shipped if first_choice in shipped else [first_choice, *shipped]
        self._loader = ThreadPoolExecutor(1, thread_name_prefix="models")
        self._chosen = self.names.index(first_choice)
        self._loading: dict[str, Future[PlacedModel]] = {}
        self._shown = self._load(first_choice).result()
        self._error: UserError | None = None

    def preload(self) -> None:
        """Starts to load all the others in the background."""
        for name in self.names:
            self._load(name)

    def choose(self, index: int) -> bool:
        """False when there is no such model."""
        if not 0 <= index < len(self.names):
            return False
        self._chosen = index
        return True

    def step(self, by: int) -> None:
        self._chosen = (self._chosen + by) % len(self.names)

    @property
    def chosen_name(self) -> str:
        return self.names[self._chosen]

    def model(self) -> PlacedModel:
        """The chosen model as soon as it is loaded, until then the one before."""
        loading = self._load(self.chosen_name)
        if loading.done():
            try:
                self._shown = loading.result()
            except UserError as error:
                self._error = error
                self._chosen = next(i for i, name in enumerate(self.names) if self._is_loaded(name))
        return self._shown

    def take_error(self) -> UserError | None:
        error, self._error = self._error, None
        return error

    def close(self) -> None:
        self._loader.shutdown(wait=False, cancel_futures=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _load(self, name: str) -> Future[PlacedModel]:
        if name not in self._loading:
            self._loading[name] = self._loader.submit(self._read, name)
        return self._loading[name]

    def _read(self, name: str) -> PlacedModel:
        return placed_on_marker(load_model(name), self._marker_side_m)

    def _is_loaded(self, name: str) -> bool:
        loading = self._loading.get(name)
        return loading is not None and loading.done() and loading.exception() is None
