"""Focal lengths that were estimated, kept for each camera in the user's configuration folder."""

from pathlib import Path
from typing import Any

import platformdirs

from ashe_live.core.camera import Size
from ashe_live.core.ranges import COUNT, FOCAL, Range
from ashe_live.errors import UserError
from ashe_live.files.reading import read_json
from ashe_live.files.writing import write_json
from ashe_live.tracking.focal.focal import FocalEstimate

SIGMA = Range(1e-6, FOCAL.high, "px")


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
            focal_px = FOCAL.checked(kept["focal_px"], "focal_px")
            sigma_px = SIGMA.checked(kept["sigma_px"], "sigma_px")
            views = COUNT.checked(kept["views"], "views")
        except (TypeError, KeyError, ValueError):
            return None
        return FocalEstimate(size, focal_px, sigma_px, int(views))

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
            content = read_json(self._path)
        except UserError:
            return {}
        return content if isinstance(content, dict) else {}
