"""The cameras that are connected: their names, and the modes that they really give."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import cv2
from cv2_enumerate_cameras import enumerate_cameras
from cv2_enumerate_cameras.camera_info import CameraInfo

from ashe_live.capture.webcam import BACKEND, Capture, OpenCapture, open_opencv_capture
from ashe_live.core.camera import Size

# Sizes that cameras usually have. OpenCV has no list of a camera's sizes, but tells which it chose instead of one.
USUAL_SIZES: tuple[Size, ...] = (
    (320, 240),
    (640, 360),
    (640, 480),
    (1280, 720),
    (1920, 1080),
    (2560, 1440),
    (3840, 2160),
)


@dataclass(frozen=True, slots=True)
class Device:
    """A camera as the system lists it."""

    number: int  # as --camera takes it
    name: str  # with vendor and product, where there are: the same model has the same name on every system
    path: str | None  # where the system has devices as files


@dataclass(frozen=True, slots=True)
class Mode:
    """A format of the pictures that a camera gives."""

    size: Size  # width, height
    fps: float  # as the camera claims
    codec: str  # four characters, e.g. MJPG; empty when not told


def connected(listed: Callable[[int], Iterable[CameraInfo]] = enumerate_cameras) -> list[Device]:
    """The connected cameras, by number. Opens none of them."""
    return sorted((_device(info) for info in listed(BACKEND)), key=lambda device: device.number)


def name_of(camera: int | str, devices: Iterable[Device]) -> str:
    """The name of camera `camera` (number or path), by which it is recognised in another run."""
    for device in devices:
        if camera in (device.number, device.path):
            return device.name
    return f"camera {camera}"


def modes_of(camera: int | str, open_capture: OpenCapture = open_opencv_capture) -> Iterator[Mode]:
    """Tries the usual sizes one after another; none when the camera cannot be opened."""
    seen: set[Size] = set()
    for wanted in USUAL_SIZES:
        capture = open_capture(camera, wanted)
        try:
            if not capture.isOpened():
                return
            mode = mode_of(capture)
        finally:
            capture.release()
        if mode.size not in seen and min(mode.size) > 0:
            seen.add(mode.size)
            yield mode


def mode_of(capture: Capture) -> Mode:
    """The mode that an open camera says it will give."""
    size = round(capture.get(cv2.CAP_PROP_FRAME_WIDTH)), round(capture.get(cv2.CAP_PROP_FRAME_HEIGHT))
    code = int(capture.get(cv2.CAP_PROP_FOURCC))
    codec = code.to_bytes(4, "little").decode("ascii", "replace") if 0 < code < 1 << 32 else ""
    return Mode(size, capture.get(cv2.CAP_PROP_FPS), codec if codec.isprintable() else "")


def _device(info: CameraInfo) -> Device:
    product = "" if info.vid is None or info.pid is None else f" ({info.vid:04X}:{info.pid:04X})"
    return Device(info.index, f"{info.name}{product}", info.path or None)
