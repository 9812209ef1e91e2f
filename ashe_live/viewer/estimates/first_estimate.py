"""Decides when the light of a source is estimated for the first time without a request."""

from ashe_live.core.types import TrackedFrame
from ashe_live.tracking.poses.steadiness import Steadiness


class FirstEstimate:
    """One that is made once: of the frame with a number, or of the first in which the marker is steady, or never."""

    def __init__(
        self, steadiness: Steadiness | None = None, on_first_steady: bool = False, at_frame: int | None = None
    ) -> None:
        self._steadiness = Steadiness() if steadiness is None else steadiness
        self._on_first_steady = on_first_steady
        self._at_frame = at_frame
        self._is_done = False
        self._last_index = -1
        self._has_gone_round = False

    @property
    def awaits_steady(self) -> bool:
        """Whether it will be made once the marker is steady."""
        return self._on_first_steady and self._at_frame is None and not self._is_done

    def add(self, tracked: TrackedFrame) -> bool:
        """Takes the next frame; returns whether the marker is steady in it."""
        self._has_gone_round = tracked.frame.index < self._last_index
        self._last_index = tracked.frame.index
        return self._steadiness.add(tracked)

    def is_due_in(self, tracked: TrackedFrame) -> bool:
        """Whether it is to be made of the frame that was added last."""
        if self._is_done:
            return False
        if self._at_frame is not None:
            return tracked.frame.index >= self._at_frame  # that one may have come too late to be tracked
        # A looped clip has no last frame: if none was steady in a round, as on a slow machine, this one has to do.
        may_be_last = self._has_gone_round and tracked.marker is not None
        return self._on_first_steady and (self._steadiness.is_steady or may_be_last)

    def done(self) -> None:
        """It has been made, or is not needed any more."""
        self._is_done = True
