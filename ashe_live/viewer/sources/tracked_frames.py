"""The mailbox of tracked frames, which forgets those of a marker, or a field of view, that is no longer asked for."""

from dataclasses import dataclass

from ashe_live.core.types import TrackedFrame
from ashe_live.process.mailbox import LatestMailbox


@dataclass(frozen=True, slots=True)
class Following:
    """The marker that is looked for in frames, and by which camera."""

    marker: str | None = None  # its spec; None: the one that the tracker was made for
    hfov_deg: float | None = None  # the field of view; None: that of the tracker's camera


AS_AT_FIRST = Following()


class TrackedFrames(LatestMailbox[TrackedFrame]):
    """The capture thread puts frames in, which may be in progress when the other thread asks for another marker."""

    def __init__(self) -> None:
        super().__init__()
        self._following = AS_AT_FIRST

    def ask_for(self, following: Following) -> None:
        """From now on only frames that were tracked so are taken out; one of before that waits is dropped."""
        with self._changed:
            if following != self._following:
                self._following, self._value = following, None

    def put_tracked(self, tracked: TrackedFrame, following: Following) -> None:
        """As `put`, but drops a frame that was not tracked as asked for. Raises Closed when the mailbox is closed."""
        with self._changed:
            if following == self._following:
                self.put(tracked)
