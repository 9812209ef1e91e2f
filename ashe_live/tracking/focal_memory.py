"""Focal lengths that were estimated, kept for each camera in the user's configuration folder."""

import json
import math
from pathlib import Path
from typing import Any

import platformdirs

from ashe_live.core.camera import Size
from ashe_live.errors import UserError
from ashe_live.files.writing import write_json
from ashe_live.tracking.focal import FocalEstimate


def default_path() -> Path:
    return platformdirs.user_config_path("ashe-live", appauthor=False) / "focal_lengths.json"


class FocalMemory:
    """Of one camera. What cannot be read or written is as if it were not there: it is but a start for the next time."""

    def __init__(self, camera_name: str, path: Path | None = None) -> None:
        self._name = camera_name
        self._path = path or default_path()

    def recall(self, size: Size) -> FocalEstimate | None:
        """What was estimated from pictures of `size`: another size may show another part of what the lens sees."""
        kept = self._read().get(self._key(size), {})
        try:
            focal_px, sigma_px, views = float(kept["focal_px"]), float(kept["sigma_px"]), int(kept["views"])
        except (TypeError, KeyError, ValueError):
            return None
        is_possible = math.isfinite(focal_px) and math.isfinite(sigma_px) and focal_px > 0 and sigma_px > 0
        return FocalEstimate(size, focal_px, sigma_px, views) if is_possible else None

    def keep(self, estimate: FocalEstimate) -> None:
        """Replaces what was known, unless that was surer."""
        known = self.recall(estimate.size)
        if known is not None and known.relative_sigma <= estimate.relative_sigma:
            return
        entry = {"focal_px": estimate.focal_px, "sigma_px": estimate.sigma_px, "views": estimate.views}
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_json(self._path, {**self._read(), self._key(estimate.size): entry}, overwrite=True)
        except (OSError, UserError):
            return

    def _key(self, size: Size) -> str:
        return f"{self._name}, {size[0]}x{size[1]}"

    def _read(self) -> dict[str, Any]:
        try:
            content = json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            return {}
        return content if isinstance(content, dict) else {}
