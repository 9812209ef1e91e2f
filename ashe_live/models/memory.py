"""Remembers a person's settings of their models between runs, in the user's configuration folder."""

import math
from pathlib import Path
from typing import Any

from ashe_live.files.kept import KeptObject, configuration_file
from ashe_live.models.assembly.up import UPS
from ashe_live.models.catalogue import model_names
from ashe_live.models.placement import UNMOVED, Placement

MOST_MODELS = 500


class ModelMemory:
    """Forgets the oldest of more than MOST_MODELS. What cannot be read or written is as if it were not there."""

    def __init__(self, path: Path | None = None, has_places: bool = True) -> None:
        """`has_places`: False where models stand as they come, whatever was done to them in a window."""
        self._kept = KeptObject(path or configuration_file("models.json"))
        self._has_places = has_places

    def up(self, model: str) -> str | None:
        """Which axis of the file is up, as it was said last; None where nobody has."""
        up = self._entry(model).get("up")
        return up if isinstance(up, str) and up in UPS else None

    def keep_up(self, model: str, up: str) -> None:
        with self._kept.alone():
            self._keep(model, {**self._entry(model), "up": up})

    def placement(self, model: str, where: str, side_m: float) -> Placement | None:
        """How the model was left on that place of a marker of `side_m`; None where it was never moved."""
        places = self._entry(model).get("places")
        known: Any = places.get(where) if self._has_places and isinstance(places, dict) else None
        try:
            scale, turn_deg, (x, y) = (known[key] for key in ("scale", "turn_deg", "shift_sides"))
            return Placement(float(scale), math.radians(turn_deg) % math.tau, (x * side_m, y * side_m))
        except (KeyError, TypeError, ValueError):  # damaged, or written by hand
            return None

    def keep_placement(self, model: str, where: str, placement: Placement, side_m: float) -> None:
        """Keeps where a model was left on a marker of `side_m`; forgets one that is not moved."""
        if not self._has_places:
            return
        with self._kept.alone():
            entry = self._entry(model)
            places = dict(entry["places"]) if isinstance(entry.get("places"), dict) else {}
            before = dict(places)
            places.pop(where, None)
            if placement != UNMOVED:
                places[where] = {
                    "scale": placement.scale,
                    "turn_deg": math.degrees(placement.turn_rad),
                    "shift_sides": [shift / side_m for shift in placement.shift_m],
                }
            if places != before:
                self._keep(model, {**entry, "places": places})

    def _entry(self, model: str) -> dict[str, Any]:
        entry = self._kept.read().get(_key(model))
        return entry if isinstance(entry, dict) else {}

    def _keep(self, model: str, entry: dict[str, Any]) -> None:
        known = {key: value for key, value in self._kept.read().items() if key != _key(model)}
        latest = dict(list(known.items())[-(MOST_MODELS - 1) :])
        self._kept.write({**latest, _key(model): entry})


def _key(model: str) -> str:
    """The name of a shipped model, the path of a file."""
    return model if model in model_names() else str(Path(model).absolute())
