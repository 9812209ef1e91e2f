"""While the marker is not in view: which others are, looked for off the main thread, now and then."""

import math
from concurrent.futures import Future

from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.families.in_view import markers_in_view
from ashe_live.viewer.sources.background import begun

EVERY_S = 1.0


class MarkerHunt:
    """Used by the main thread only."""

    def __init__(self) -> None:
        self.in_view: tuple[str, ...] = ()  # specs, the largest first; none while the marker that is followed is there
        self._looking: Future[tuple[str, ...]] | None = None
        self._began_s = -math.inf

    def look(self, tracked: TrackedFrame | None, now_s: float) -> bool:
        """Goes on looking; returns whether something new has been found."""
        if tracked is None or tracked.marker is not None:
            self.in_view, self._looking = (), None
            return False
        if self._looking is None:
            if now_s - self._began_s >= EVERY_S:
                self._began_s = now_s
                image = tracked.frame.image_bgr
                self._looking = begun(
                    "markers", lambda: markers_in_view(image), lambda reason: UserError(reason, "name it with --marker")
                )
            return False
        if not self._looking.done():
            return False
        looked, self._looking, before = self._looking, None, self.in_view
        self.in_view = () if looked.exception() is not None else looked.result()
        return bool(self.in_view) and self.in_view != before
