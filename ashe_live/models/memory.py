"""What a person has said of their model files, kept in the user's configuration folder."""

from pathlib import Path
from typing import Any

import platformdirs

from ashe_live.errors import UserError
from ashe_live.files.reading import read_json
from ashe_live.files.writing import write_json
from ashe_live.models.up import UPS

MOST_MODELS = 500


def default_path() -> Path:
    return platformdirs.user_config_path("ashe-live", appauthor=False) / "models.json"


class ModelMemory:
    """What cannot be read or written is as if it were not there."""

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or default_path()

    def up(self, model: str) -> str | None:
        """Which axis of the file is up, as it was said last; None where nobody has."""
        entry = self._read().get(_key(model))
        up = entry.get("up") if isinstance(entry, dict) else None
        return up if isinstance(up, str) and up in UPS else None

    def keep_up(self, model: str, up: str) -> None:
        known = {key: value for key, value in self._read().items() if key != _key(model)}
        latest = dict(list(known.items())[-(MOST_MODELS - 1) :])
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_json(self._path, {**latest, _key(model): {"up": up}}, overwrite=True)
        except (OSError, UserError):
            return

    def _read(self) -> dict[str, Any]:
        try:
            content = read_json(self._path)
        except UserError:
            return {}
        return content if isinstance(content, dict) else {}


def _key(model: str) -> str:
    return str(Path(model).absolute())
