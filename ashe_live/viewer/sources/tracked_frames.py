"""The mailbox of tracked frames, which forgets those of a marker, or a field of view, that is no longer asked for."""

import threading
from dataclasses import dataclass

from ashe_live.core.types import TrackedFrame
from ashe_live.process.mailbox import LatestMailbox


@dataclass(frozen=True, slots=True)
class Following:
    """The marker that is looked for in frames, and by which camera."""

    marker: str | None = None  # its spec; None: the one that the tracker was made for
    hfov_deg: float | None = None  # the field of view; None: that of the tracker's camera


AS_AT_FIRST = Following()


class TrackedFrames:
    """The capture thread puts frames in, which may be in progress when the other thread asks for another marker."""

    def __init__(self) -> None:
        self._latest = LatestMailbox[TrackedFrame]()
        self._asking = threading.Lock()
        self._following = AS_AT_FIRST

    def ask_for(self, following: Following) -> None:
        """From now on only frames that were tracked so are taken out; one of before that waits is dropped."""
        with self._asking:
            if following != self._following:
                self._following = following
                self._latest.drop()

    def put(self, tracked: TrackedFrame, following: Following) -> None:
        """Replaces what has not been taken by a frame that was tracked so, unless another way is asked for by now.

        Raises Closed when the mailbox is closed.
        """
        with self._asking:
            if following == self._following:
                self._latest.put(tracked)

    def take(self, timeout_s: float) -> TrackedFrame | None:
        """As `LatestMailbox.take`."""
        return self._latest.take(timeout_s)

    def close(self, error: BaseException | None = None) -> None:
        """As `LatestMailbox.close`."""
        self._latest.close(error)

    @property
    def is_closed(self) -> bool:
        return self._latest.is_closed
