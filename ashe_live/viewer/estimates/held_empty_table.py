"""The frame that shows the table without the object, as long as it holds for what the camera sees now."""

from ashe_live.core.types import TrackedFrame
from ashe_live.light.live.comparable import lies_as_in

# By then the sun has moved by more than a degree, and with it the shadows of what stands around.
EMPTY_FOR_S = 300.0


class HeldEmptyTable:
    """The latest frame that is known to show the empty table: the user said so, or an estimate found nothing in it."""

    def __init__(self) -> None:
        self.frame: TrackedFrame | None = None
        self._shown: TrackedFrame | None = None  # the last one of which the user said so
        self._news: str | None = None  # why the user's no longer counts

    def show(self, frame: TrackedFrame) -> None:
        """The user says that this frame shows the empty table."""
        self.frame = self._shown = frame

    def found(self, frame: TrackedFrame) -> None:
        """An estimate found nothing on the table in this frame, which is held unless a later one is."""
        if self.frame is None or frame.frame.time_s > self.frame.frame.time_s:
            self.frame = frame

    def under(self, frozen: TrackedFrame) -> TrackedFrame | None:
        """The empty table for a frozen frame; None if there is none of its size.

        It is forgotten if the marker has been moved since, or too much time has passed.
        """
        empty = self.frame
        if empty is None:
            return None
        is_old = abs(frozen.frame.time_s - empty.frame.time_s) > EMPTY_FOR_S
        if is_old or not lies_as_in(empty, frozen):
            self.frame = None
            if empty is self._shown:
                why = f"was shown over {EMPTY_FOR_S / 60:.0f} minutes ago" if is_old else "had the marker elsewhere"
                self._news = f"the empty table {why} and no longer counts: Shift+Space shows it again"
        return self.frame if empty.frame.size == frozen.frame.size else None

    def take_news(self) -> str | None:
        """What has become of the empty table that the user has shown, returned once."""
        news, self._news = self._news, None
        return news
