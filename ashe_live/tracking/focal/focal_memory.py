"""Focal lengths that were estimated, kept for each camera in the user's configuration folder."""

from pathlib import Path

from ashe_live.core.camera import Size
from ashe_live.core.ranges import COUNT, FOCAL, Range
from ashe_live.files.kept import KeptObject, configuration_file
from ashe_live.tracking.focal.focal import FocalEstimate

SIGMA = Range(1e-6, FOCAL.high, "px")


class FocalMemory:
    """One camera's focal length. Errors of reading and writing are ignored, as it is only a start for the next time."""

    def __init__(self, camera_name: str, path: Path | None = None) -> None:
        self._name = camera_name
        self._kept = KeptObject(path or configuration_file("focal_lengths.json"))

    def recall(self, size: Size) -> FocalEstimate | None:
        """The estimate from pictures of `size`, as another size may show another part of what the lens sees."""
        kept = self._kept.read().get(self._key(size), {})
        try:
            focal_px = FOCAL.checked(kept["focal_px"], "focal_px")
            sigma_px = SIGMA.checked(kept["sigma_px"], "sigma_px")
            views = COUNT.checked(kept["views"], "views")
        except (TypeError, KeyError, ValueError):
            return None
        return FocalEstimate(size, focal_px, sigma_px, int(views))

    def keep(self, estimate: FocalEstimate) -> None:
        """Replaces what was known, unless that was surer."""
        with self._kept.alone():
            known = self.recall(estimate.size)
            if known is not None and known.relative_sigma <= estimate.relative_sigma:
                return
            entry = {"focal_px": estimate.focal_px, "sigma_px": estimate.sigma_px, "views": estimate.views}
            self._kept.write({**self._kept.read(), self._key(estimate.size): entry})

    def forget(self, size: Size) -> None:
        """What was kept for pictures of `size` is wrong."""
        with self._kept.alone():
            self._kept.write({key: entry for key, entry in self._kept.read().items() if key != self._key(size)})

    def _key(self, size: Size) -> str:
        return f"{self._name}, {size[0]}x{size[1]}"
