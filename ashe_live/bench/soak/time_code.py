"""A camera that plays the shipped clip and numbers its pictures, so that their age can be read from the screen."""

import time
from threading import Event

import cv2
import numpy as np

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.core.arrays import Image

BITS = 16
CELL_PX = 10
# At the right edge, where the viewer writes nothing and the shipped clip shows no marker.
TOP_PX = 40
# More pictures than can be under way at once.
REMEMBERED = 4096


def paint_number(image_bgr: Image, number: int) -> None:
    """Paints a column of squares into (h, w, 3), white for a set bit; before the bits, a white and a black square."""
    bits = np.array([1, 0, *((number >> bit & 1) for bit in range(BITS))], np.uint8)
    cells = np.repeat(bits * np.uint8(255), CELL_PX)
    image_bgr[TOP_PX : TOP_PX + len(cells), -CELL_PX:] = cells[:, None, None]


def read_number(image_bgr: Image) -> int | None:
    """The number painted into (h, w, 3), modulo 2^BITS; None if there is none."""
    middles = TOP_PX + CELL_PX // 2 + CELL_PX * np.arange(2 + BITS)
    if middles[-1] >= image_bgr.shape[0]:
        return None
    first, second, *bits = image_bgr[middles, -CELL_PX // 2, 1] > 127
    if not first or second:
        return None
    return sum(1 << bit for bit, is_set in enumerate(bits) if is_set)


class TimeCodeCamera:
    """Stands in for OpenCV's capture in WebcamSource: the clip, repeated, at `rate_hz` or as fast as it is read."""

    def __init__(self, clip: KnownClip, rate_hz: float) -> None:
        self.size = clip.camera.size
        self._source = ClipSource(clip.path)
        self._rate_hz = rate_hz
        self._count = 0
        self._due_s = time.monotonic()
        self._taken_s = np.zeros(REMEMBERED)
        self._released = Event()

    def taken_s(self, number: int) -> float:
        """When that picture was taken, on the monotonic clock; for the last REMEMBERED ones."""
        return float(self._taken_s[number % REMEMBERED])

    def isOpened(self) -> bool:
        return not self._released.is_set()

    def grab(self) -> bool:
        """Waits until the next picture is due; missed pictures are skipped."""
        now_s = time.monotonic()
        self._due_s = max(self._due_s + 1 / self._rate_hz, now_s)
        return not self._released.wait(self._due_s - now_s)

    def retrieve(self) -> tuple[bool, Image | None]:
        frame = self._source.read()
        if frame is None:
            self._source.rewind()
            frame = self._source.read()
            assert frame is not None
        image = frame.image_bgr.copy()
        paint_number(image, self._count)
        self._taken_s[self._count % REMEMBERED] = time.monotonic()
        self._count += 1
        return True, image

    def get(self, prop: int) -> float:
        return self._rate_hz if prop == cv2.CAP_PROP_FPS else 0.0

    def release(self) -> None:
        self._released.set()
        self._source.close()
