"""Finds which other markers are in view, off the main thread: while the followed one is not, or when asked."""

import math
from concurrent.futures import Future
from functools import partial

from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.tracking.families.seen_instead import SeenInstead, seen_instead
from ashe_live.viewer.sources.background import in_background

EVERY_S = 1.0


class MarkerHunt:
    """Used by the main thread only."""

    def __init__(self) -> None:
        self.seen_instead = SeenInstead()  # of the followed marker; nothing while that is in view
        self._looking: Future[SeenInstead] | None = None
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
            self.seen_instead = SeenInstead()
        if tracked is None or (is_there and not self._is_asked):
            self._looking = None
            return False
        if self._looking is None:
            if now_s - self._began_s >= EVERY_S:
                self._began_s = now_s
                search = partial(seen_instead, tracked.frame.image_bgr)
                self._looking = in_background(
                    "markers", search, lambda reason: UserError(reason, "name it with --marker")
                )
            return False
        if not self._looking.done():
            return False
        looked, self._looking = self._looking, None
        found = SeenInstead() if looked.exception() is not None else looked.result()
        if self._is_asked:
            self._is_asked, self._answer = False, found.in_view
        if is_there:
            return False
        before, self.seen_instead = self.seen_instead.in_view, found
        return bool(found.in_view) and found.in_view != before
