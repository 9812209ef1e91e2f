"""A camera as a source, at the lowest latency that OpenCV offers, which survives being unplugged."""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import cv2

from ashe_live.capture.sources import Source, SourceLost
from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from ashe_live.errors import UserError

FALLBACK_FPS = 30.0
# How long a camera may be silent before it counts as lost (on Linux; OpenCV waits 10 s unless told).
SILENCE_S = 4
BACKENDS = {"linux": cv2.CAP_V4L2, "darwin": cv2.CAP_AVFOUNDATION, "win32": cv2.CAP_DSHOW}


class Capture(Protocol):
    """The part of cv2.VideoCapture that is used here."""

    def isOpened(self) -> bool: ...
    def grab(self) -> bool: ...
    def retrieve(self) -> tuple[bool, Image | None]: ...
    def get(self, prop: int) -> float: ...
    def release(self) -> None: ...


OpenCapture = Callable[[int | str, tuple[int, int] | None], Capture]


def open_opencv_capture(camera: int | str, size: tuple[int, int] | None) -> Capture:
    """OpenCV's capture of `camera`, set to give frames of about `size` as late as possible after they were seen."""
    # What goes wrong is said by UserError, once, and not by OpenCV.
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", str(SILENCE_S))
    capture = cv2.VideoCapture(camera, BACKENDS.get(sys.platform, cv2.CAP_ANY))
    # USB 2 carries uncompressed pictures of more than 640x480 at 10 frames a second or less.
    capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
    if size is not None:
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
    # A queue of frames is a queue of delays.
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    return capture  # type: ignore[return-value]  # cv2's stub says retrieve cannot fail


class WebcamSource(Source):
    """Frames of a camera as they come. Index and time go on after the camera was lost and came back."""

    is_live = True
    is_photo = False
    note = None

    def __init__(
        self,
        camera: int | str = 0,
        size_request: tuple[int, int] | None = None,
        open_capture: OpenCapture = open_opencv_capture,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """Opens camera number `camera`, or the device of that path, and waits for its first frame.

        The camera gives the size nearest to `size_request` (width, height) that it can. Raises UserError, with the
        remedy, when there is no such camera, it is busy, or it must not be used.
        """
        self._camera = camera
        self._open_capture = open_capture
        self._clock_s = clock_s
        self._capture: Capture | None = None
        self._first: tuple[Image, float] | None = None
        self._index = 0
        self._start_s: float | None = None
        self.name = f"camera {camera}"
        if not self._open(size_request):
            raise camera_error(camera)
        assert self._capture is not None
        assert self._first is not None
        height, width = self._first[0].shape[:2]
        self.size: tuple[int, int] = (width, height)
        fps = self._capture.get(cv2.CAP_PROP_FPS)
        self.fps = fps if fps > 0 else FALLBACK_FPS

    def read(self) -> Frame:
        """The next frame, timed when it arrived. Raises SourceLost when the camera gives no more."""
        arrival, self._first = self._first or self._grab(), None
        if arrival is None:
            self.close()
            raise SourceLost(f"{self.name} gives no more pictures", "plug it in again; it is tried until it is back")
        image, seen_s = arrival
        if self._start_s is None:
            self._start_s = seen_s
        frame = Frame(image, self._index, seen_s - self._start_s)
        self._index += 1
        return frame

    def rewind(self) -> None:
        pass

    def reopen(self) -> bool:
        """Tries once. Raises UserError when frames come again but in another size, which nothing downstream fits."""
        self.close()
        if not self._open(self.size):
            return False
        assert self._first is not None
        height, width = self._first[0].shape[:2]
        if (width, height) != self.size:
            self.close()
            was = f"{self.size[0]}x{self.size[1]}"
            raise UserError(f"{self.name} came back with frames of {width}x{height} and not {was}", "start again")
        return True

    def close(self) -> None:
        self._first = None
        if self._capture is not None:
            self._capture.release()
        self._capture = None

    def _open(self, size: tuple[int, int] | None) -> bool:
        """Whether the camera gives frames: one that another program uses often opens and then gives none."""
        self._capture = self._open_capture(self._camera, size)
        self._first = self._grab() if self._capture.isOpened() else None
        if self._first is None:
            self.close()
        return self._first is not None

    def _grab(self) -> tuple[Image, float] | None:
        """A picture (h, w, 3) and the time of its arrival, before it was decoded; None when the camera fails."""
        if self._capture is None or not self._capture.grab():
            return None
        seen_s = self._clock_s()
        has_picture, image = self._capture.retrieve()
        # OpenCV may report success with an empty picture when the camera is pulled out.
        if not has_picture or image is None or image.size == 0:
            return None
        return image, seen_s


def camera_error(camera: int | str, devices: Path = Path("/dev")) -> UserError:
    """Why `camera` could not be used, as far as the system tells, and the remedy. `devices` is where Linux has them."""
    if not sys.platform.startswith("linux"):
        return UserError(
            f"camera {camera} cannot be used",
            "connect it, close other programs that use it, and allow camera access in the system's privacy settings",
        )
    device = devices / f"video{camera}" if isinstance(camera, int) else Path(camera)
    if not device.exists():
        others = ", ".join(str(path) for path in sorted(devices.glob("video*")))
        remedy = (
            f"choose one of {others} with --camera" if others else "connect one, or play a clip: ashe-live play FILE"
        )
        return UserError(f"there is no camera {device}", remedy)
    if not os.access(device, os.R_OK | os.W_OK):
        return UserError(
            f"no permission to use {device}",
            "add yourself to the group video (sudo usermod -aG video $USER) and log in again",
        )
    return UserError(
        f"{device} gives no pictures",
        "close other programs that use it; a camera can have several devices, so try the next number too",
    )
