"""Finds which other markers are in view, off the main thread: while the followed one is not, or when asked."""

import math
from concurrent.futures import Future

from ashe_live.core.arrays import Image
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.families.in_view import markers_in_view, mirrored_in_view
from ashe_live.viewer.sources.background import in_background

EVERY_S = 1.0

Looked = tuple[tuple[str, ...], tuple[str, ...]]  # specs in view, and of those in mirror image if there are no others


class MarkerHunt:
    """Used by the main thread only."""

    def __init__(self) -> None:
        self.in_view: tuple[str, ...] = ()  # specs, the largest first; none while the followed marker is in view
        self.mirrored: tuple[str, ...] = ()  # specs of those that are seen in mirror image, while there are no others
        self._looking: Future[Looked] | None = None
        self._began_s = -math.inf
        self._is_asked = False
        self._answer: tuple[str, ...] | None = None

    def ask(self) -> None:
        """Looks once even if the followed marker is in view; `take_answer` returns what was found."""
        self._is_asked = True
        self._looking, self._began_s = None, -math.inf

    def take_answer(self) -> tuple[str, ...] | None:
        """The specs in view, the largest first, returned once after an `ask`; None until then."""
        answer, self._answer = self._answer, None
        return answer

    def look(self, tracked: TrackedFrame | None, now_s: float) -> bool:
        """Continues the search with the latest frame; returns whether something new has been found."""
        is_there = tracked is not None and tracked.marker is not None
        if is_there:
            self.in_view = self.mirrored = ()
        if tracked is None or (is_there and not self._is_asked):
            self._looking = None
            return False
        if self._looking is None:
            if now_s - self._began_s >= EVERY_S:
                self._began_s = now_s
                image = tracked.frame.image_bgr
                self._looking = in_background(
                    "markers", lambda: _looked_for(image), lambda reason: UserError(reason, "name it with --marker")
                )
            return False
        if not self._looking.done():
            return False
        looked, self._looking = self._looking, None
        found, mirrored = ((), ()) if looked.exception() is not None else looked.result()
        if self._is_asked:
            self._is_asked, self._answer = False, found
        if is_there:
            return False
        before, self.in_view, self.mirrored = self.in_view, found, mirrored
        return bool(found) and found != before


def _looked_for(image: Image) -> Looked:
    found = markers_in_view(image)
    return found, () if found else mirrored_in_view(image)
