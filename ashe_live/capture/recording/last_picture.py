"""Records one picture instead of a clip: of a photo the one that there is, of a clip the last."""

from pathlib import Path
from typing import Self

from ashe_live.capture.snapshot import write_png
from ashe_live.core.arrays import Image

PICTURE_SUFFIX = ".png"


class LastPicture:
    """A context manager; whatever ends it before its time leaves no file."""

    def __init__(self, path: Path, overwrite: bool = False) -> None:
        self.path = path  # once closed, where the picture is: beside a file that has appeared there meanwhile
        self._overwrite = overwrite
        self._picture: Image | None = None

    def write(self, image: Image, _time_s: float) -> None:
        """Keeps (h, w, 3) uint8 BGR, or (h, w, 4) with straight alpha, in place of what it has."""
        self._picture = image

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, at: object) -> None:
        if error is None and self._picture is not None:
            self.path = write_png(self.path, self._picture, self._overwrite, beside=True)
