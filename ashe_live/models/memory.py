"""What a person has said of their model files, kept in the user's configuration folder."""

from pathlib import Path

from ashe_live.files.kept import KeptObject, configuration_file
from ashe_live.models.assembly.up import UPS

MOST_MODELS = 500


class ModelMemory:
    """Forgets the oldest of more than MOST_MODELS. What cannot be read or written is as if it were not there."""

    def __init__(self, path: Path | None = None) -> None:
        self._kept = KeptObject(path or configuration_file("models.json"))

    def up(self, model: str) -> str | None:
        """Which axis of the file is up, as it was said last; None where nobody has."""
        entry = self._kept.read().get(_key(model))
        up = entry.get("up") if isinstance(entry, dict) else None
        return up if isinstance(up, str) and up in UPS else None

    def keep_up(self, model: str, up: str) -> None:
        known = {key: value for key, value in self._kept.read().items() if key != _key(model)}
        latest = dict(list(known.items())[-(MOST_MODELS - 1) :])
        self._kept.write({**latest, _key(model): {"up": up}})


def _key(model: str) -> str:
    return str(Path(model).absolute())
