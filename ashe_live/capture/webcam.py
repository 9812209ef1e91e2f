"""A camera as a source, at the lowest latency that OpenCV offers, which survives being unplugged."""

import os
import sys
import threading
import time
from collections.abc import Callable
from typing import NamedTuple, Protocol

import cv2

from ashe_live.capture.camera_error import camera_error, check_is_device
from ashe_live.capture.sources import Source, SourceLost
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.process.mailbox import Closed, LatestMailbox

FALLBACK_FPS = 30.0
# How long a camera may be silent before it counts as lost (OpenCV waits 10 s on Linux unless told). Its first picture
# may take longer: some adjust their exposure first.
SILENCE_S = 4
FIRST_PICTURE_S = 10
# For a grabber that hangs in a driver; it gives the camera back when it comes out.
PATIENCE_S = 0.5
BACKEND = {"linux": cv2.CAP_V4L2, "darwin": cv2.CAP_AVFOUNDATION, "win32": cv2.CAP_DSHOW}.get(sys.platform, cv2.CAP_ANY)


class Capture(Protocol):
    """The part of cv2.VideoCapture that is used here."""

    def isOpened(self) -> bool: ...
    def grab(self) -> bool: ...
    def retrieve(self) -> tuple[bool, Image | None]: ...
    def get(self, prop: int) -> float: ...
    def release(self) -> None: ...


OpenCapture = Callable[[int | str, Size | None], Capture]


def open_opencv_capture(camera: int | str, size: Size | None) -> Capture:
    """OpenCV's capture of `camera`, set to give frames of about `size` as soon as possible after they were seen."""
    # What goes wrong is said by UserError, once, and not by OpenCV.
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", str(SILENCE_S))
    capture = cv2.VideoCapture(camera, BACKEND)
    # USB 2 carries uncompressed pictures of more than 640x480 at 10 frames a second or less.
    capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
    if size is not None:
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
    # One picture is decoded while the next is taken: a longer queue is a queue of delays, a shorter one loses pictures.
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 2)
    return capture  # type: ignore[return-value]  # cv2's stub says retrieve cannot fail


class WebcamSource(Source):
    """The latest picture of a camera, whenever it is asked for. Index and time go on after it was lost and came back.

    A thread of its own waits for the camera, so that no picture grows old in the driver's queue while the one before
    is worked on.
    """

    is_live = True
    is_photo = False

    def __init__(
        self,
        camera: int | str,
        size_request: Size | None = None,
        open_capture: OpenCapture = open_opencv_capture,
        clock_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """Opens camera number `camera`, or the device of that path, and waits for its first frame.

        The camera gives the size nearest to `size_request` (width, height) that it can, and `note` says so where that
        is another one. Raises UserError, with the remedy, when there is no such camera, it is busy, or it must not be
        used.
        """
        if isinstance(camera, str):
            check_is_device(camera)
        self._camera = camera
        self._open_capture = open_capture
        self._clock_s = clock_s
        self._grabber: _Grabber | None = None
        self._first: _Arrival | None = None
        self._index = 0
        self._start_s: float | None = None
        self.name = f"camera {camera}"
        self.note: str | None = None
        self.fps: float = FALLBACK_FPS
        if not self._open(size_request):
            raise camera_error(camera)
        assert self._first is not None
        self.size: Size = self._first.size
        if size_request not in (None, self.size):
            self.note = f"{self.name} does not give pictures of {_by(size_request)}, but of {_by(self.size)}"

    def read(self) -> Frame:
        """The newest frame that was not read yet, timed when it arrived. Raises SourceLost when there are no more."""
        arrival, self._first = self._first or self._next(SILENCE_S), None
        if arrival is None or arrival.size != self.size:
            self.close()
            what = "gives no more pictures" if arrival is None else f"gives pictures of {_by(arrival.size)} now"
            raise SourceLost(f"{self.name} {what}", "plug it in again; it is tried until it is back")
        if self._start_s is None:
            self._start_s = arrival.seen_s
        frame = Frame(arrival.image, self._index, arrival.seen_s - self._start_s)
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
        if self._first.size != self.size:
            size = self._first.size
            self.close()
            raise UserError(f"{self.name} came back with frames of {_by(size)} and not {_by(self.size)}", "start again")
        return True

    def close(self) -> None:
        self._first = None
        if self._grabber is not None:
            self._grabber.close()
        self._grabber = None

    def _open(self, size: Size | None) -> bool:
        """Whether the camera gives frames: one that another program uses often opens and then gives none."""
        capture = self._open_capture(self._camera, size)
        if not capture.isOpened():
            capture.release()
            return False
        fps = capture.get(cv2.CAP_PROP_FPS)
        self.fps = fps if fps > 0 else FALLBACK_FPS
        self._grabber = _Grabber(capture, self._clock_s)
        self._first = self._next(FIRST_PICTURE_S)
        if self._first is None:
            self.close()
        return self._first is not None

    def _next(self, timeout_s: float) -> "_Arrival | None":
        try:
            return None if self._grabber is None else self._grabber.arrivals.take(timeout_s)
        except Closed:
            return None


class _Arrival(NamedTuple):
    image: Image  # (h, w, 3)
    seen_s: float  # when it arrived, before it was decoded

    @property
    def size(self) -> Size:
        return self.image.shape[1], self.image.shape[0]


class _Grabber:
    """Takes every picture from the driver as it comes, and keeps the latest. The camera is this thread's alone."""

    def __init__(self, capture: Capture, clock_s: Callable[[], float]) -> None:
        self.arrivals = LatestMailbox[_Arrival]()
        self._capture = capture
        self._clock_s = clock_s
        self._thread = threading.Thread(target=self._run, name="camera", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self.arrivals.close()
        self._thread.join(PATIENCE_S)

    def _run(self) -> None:
        try:
            while (arrival := self._grab()) is not None:
                self.arrivals.put(arrival)
        except Closed:
            pass
        except BaseException as error:  # whatever it is, the reader must hear of it
            self.arrivals.close(error)
        finally:
            self.arrivals.close()
            self._capture.release()

    def _grab(self) -> _Arrival | None:
        """None when the camera fails."""
        if not self._capture.grab():
            return None
        seen_s = self._clock_s()
        has_picture, image = self._capture.retrieve()
        # OpenCV may report success with an empty picture when the camera is pulled out.
        if not has_picture or image is None or image.size == 0:
            return None
        return _Arrival(image, seen_s)


def _by(size: Size | None) -> str:
    return "any size" if size is None else f"{size[0]}x{size[1]}"
