"""What a photo, a clip and a camera have in common as sources of frames, and how large a picture may be."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol, Self, runtime_checkable

from ashe_live.core.ranges import SIDE
from ashe_live.core.types import Frame
from ashe_live.errors import UserError

# More than phones' pictures have. Each takes up to 18 bytes on the way to an estimate.
MAX_PIXELS = 110_000_000


def too_many_pixels(path: Path) -> UserError:
    return UserError(f"{path} has more than {MAX_PIXELS // 10**6} million pixels", "scale it down")


def refuse_too_large(path: Path, size: tuple[int, int]) -> None:
    """Raises UserError for pictures, width x height, that are too large to be worked on."""
    if size[0] * size[1] > MAX_PIXELS:
        raise too_many_pixels(path)
    if max(size) > SIDE.high:
        raise UserError(f"{path} is longer than {SIDE.high} pixels", "scale it down, or cut a part out")


class SourceLost(UserError):  # noqa: N818 - what happened, as Closed
    """A live source has stopped, as when a camera is unplugged; `Source.reopen` tries to get it back."""


class Source(Protocol):
    """Frames of one size, in the order of their times. Used as a context manager; not safe for two threads at once."""

    name: str  # for a person: the file's name, or which camera
    size: tuple[int, int]  # width, height of every frame in pixels
    fps: float | None  # nominal frames a second; None for a photo
    is_live: bool  # frames come at their own pace and cannot be read again
    is_photo: bool  # there is one frame only, to be shown on and on
    note: str | None  # what a person should know about the frames read so far, e.g. that the clip is truncated

    def read(self) -> Frame | None:
        """The next frame, or None at the end (a live source has none). Raises SourceLost."""

    def __iter__(self) -> Iterator[Frame]:
        """The frames from here to the end."""
        while (frame := self.read()) is not None:
            yield frame

    def rewind(self) -> None:
        """Starts again at frame 0; does nothing to a live source."""

    def reopen(self) -> bool:
        """Tries once to get a lost live source back; True when frames can be read again."""
        return False

    def close(self) -> None:
        """Frees the file or the camera; may be called twice."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@runtime_checkable
class Seekable(Protocol):
    """A source that can seek: a clip."""

    path: Path  # of the file, as it was named
    duration_s: float | None  # from the first frame to the last; None: not known

    def seek(self, time_s: float) -> None:
        """The next frame read is the one shown `time_s` after the first: the first before all, the last after all."""

    def seek_frame(self, index: int) -> None:
        """The next frame read is number `index`, 0 before all, or the end when there is none."""

    def pass_over(self, is_shown: Callable[[float], bool]) -> bool:
        """Passes over the next frame, of which no picture is made, where `is_shown` of its time is False; whether so.

        The last frame stays, whatever its time.
        """
