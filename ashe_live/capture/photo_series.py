"""The photos of a folder as one source, a frame each: all by one camera, of one size.

A phone that looks down at a table turns its photos as it happens to be tilted. It is one camera, whose axis lies on the
same pixel of the sensor: so all are turned as the first one is.
"""

from pathlib import Path

import numpy as np

from ashe_live.capture.folder import pictures_in
from ashe_live.capture.photo import PhotoSource
from ashe_live.capture.sources import Source
from ashe_live.core.types import Frame
from ashe_live.errors import UserError


class PhotoSeries(Source):
    """The photos that are directly in a folder, in the order of their names; each is decoded when it is read."""

    fps = None
    is_live = False
    is_photo = False

    def __init__(self, folder: Path) -> None:
        """Raises UserError as `pictures_in`, when there is no photo in it, or as PhotoSource for the first one."""
        self.name = folder.name
        self._paths, self.note = pictures_in(folder, with_clips=False)
        if not self._paths:
            raise UserError(f"there is no photo in the folder {folder}", "take a dozen photos of the board")
        self._index = 0
        first = PhotoSource(self._paths[0])
        self.size, self._quarter_turns = first.size, first.quarter_turns

    def read(self) -> Frame | None:
        """Raises UserError as PhotoSource, and for a photo of another size."""
        if self._index >= len(self._paths):
            return None
        path = self._paths[self._index]
        photo = PhotoSource(path)
        frame = photo.read()
        assert frame is not None
        turned = np.rot90(frame.image_bgr, self._quarter_turns - photo.quarter_turns)
        if turned.shape[1::-1] != self.size:
            (width, height), (first_width, first_height) = frame.size, self.size
            raise UserError(
                f"{path} has {width}x{height} pixels, and the first photo {first_width}x{first_height}",
                "use photos of one camera, all upright or all on their side",
            )
        self._index += 1
        return Frame(np.ascontiguousarray(turned), self._index - 1, float(self._index - 1))

    def rewind(self) -> None:
        self._index = 0

    def close(self) -> None:
        self._index = len(self._paths)
