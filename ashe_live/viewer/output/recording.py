"""A recording under way: which pictures it takes and at which times, so that it has the source's own frame rate."""

from collections.abc import Callable
from pathlib import Path

from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.errors import UserError


class Slots:
    """Assigns pictures to the evenly spaced frame times of a clip.

    A display shows each of the source's pictures up to one interval late; a picture takes the next slot all the same,
    unless that is a whole period off.
    """

    def __init__(self, fps: float) -> None:
        self._fps = fps
        self._start_s: float | None = None
        self._last = -1
        self._last_frame: int | None = None
        # Slots that stayed empty while the source had a frame for each: one that stands still has none.
        self.missed = 0

    def time_s(self, now_s: float, new_frame: int | None) -> float | None:
        """The time of the slot that a picture at `now_s` takes, counted from the first one; None if it is not needed.

        new_frame: the index of the source's frame in the picture. Without a new one (None: paused, a photo) the last
        picture is taken again when a slot is overdue.
        """
        if self._start_s is None:
            self._start_s = now_s
        skipped = 0
        if new_frame is not None:
            if self._last_frame is not None:
                skipped = max(0, new_frame - self._last_frame - 1)
            self._last_frame = new_frame
        at = (now_s - self._start_s) * self._fps
        ahead = at - (self._last + 1)
        if ahead <= -1 or (new_frame is None and ahead < 0.5):
            return None
        taken = self._last + 1 if ahead < 1 else round(at)
        self.missed += min(skipped, taken - self._last - 1)
        self._last = taken
        return self._last / self._fps


class Recording:
    """A recording into a new MP4 file. Once the disk or the encoder fails it takes no more, and `failure` says so."""

    def __init__(self, path: Path, size: Size, fps: float, overwrite: bool = False) -> None:
        """Raises UserError as Recorder does."""
        self.size = size
        self.failure: str | None = None
        self._recorder = Recorder(path, size, fps, overwrite)
        self._slots = Slots(fps)

    def take(self, picture: Callable[[], Image], new_frame: int | None, now_s: float) -> bool:
        """Adds a picture, (h, w, 3) uint8 BGR, if one is due, and only then makes it; returns whether it was added.

        new_frame: as of `Slots.time_s`.
        """
        time_s = None if self.failure is not None else self._slots.time_s(now_s, new_frame)
        if time_s is None:
            return False
        try:
            self._recorder.write(picture(), time_s)
        except UserError as error:
            self.failure = str(error)
        return self.failure is None

    def finish(self) -> str:
        """Closes the clip; says in one line what has become of it. May be called twice."""
        try:
            self._recorder.close()
        except UserError as error:
            self.failure = str(error)
        if self.failure is not None:
            return self.failure
        frames, missed = self._recorder.frame_count, self._slots.missed
        if not frames:
            return "nothing recorded"
        lost = f", {missed} more were not shown in time" if missed else ""
        return f"saved {self._recorder.path} ({frames} {'frame' if frames == 1 else 'frames'}{lost})"

    @property
    def path(self) -> Path:
        return self._recorder.path

    @property
    def has_gaps(self) -> bool:
        """Whether pictures are missing that a machine with more time would have shown."""
        return self._slots.missed > 0
