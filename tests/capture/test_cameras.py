"""Which cameras there are: names by which they are known again, and modes that they really give."""

import cv2
import pytest
from cv2_enumerate_cameras.camera_info import CameraInfo

from ashe_live.capture.cameras import Device, Mode, connected, modes_of, name_of
from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size

C920 = CameraInfo(2, "HD Pro Webcam C920", "/dev/video2", 0x046D, 0x082D, cv2.CAP_V4L2)
LAPTOP = CameraInfo(0, "Integrated Camera", "", None, None, cv2.CAP_V4L2)
DEVICES = [
    Device(0, "Integrated Camera", None),
    Device(2, "HD Pro Webcam C920 (046D:082D)", "/dev/video2"),
]


class FakeCapture:
    """Gives the largest of its sizes that is not larger than the one asked for."""

    sizes: tuple[Size, ...] = ((640, 480), (1280, 720))
    opened = released = 0
    fourcc = cv2.VideoWriter.fourcc(*"MJPG")

    def __init__(self, camera: int | str, wanted: Size | None) -> None:
        assert wanted is not None
        FakeCapture.opened += 1
        self.camera = camera
        self.size = max((size for size in self.sizes if size <= wanted), default=self.sizes[0])

    def isOpened(self) -> bool:
        return self.camera == 0

    def grab(self) -> bool:
        raise AssertionError("to list modes, no picture is taken")

    def retrieve(self) -> tuple[bool, Image | None]:
        raise AssertionError

    def get(self, prop: int) -> float:
        values = {cv2.CAP_PROP_FRAME_WIDTH: self.size[0], cv2.CAP_PROP_FRAME_HEIGHT: self.size[1]}
        return float({**values, cv2.CAP_PROP_FPS: 30, cv2.CAP_PROP_FOURCC: self.fourcc}.get(prop, 0))

    def release(self) -> None:
        FakeCapture.released += 1


def test_cameras_come_by_number_and_with_what_identifies_their_model() -> None:
    assert connected(lambda backend: [C920, LAPTOP]) == DEVICES  # noqa: ARG005
    assert connected(lambda backend: []) == []  # noqa: ARG005
    for half in ((0x046D, None), (None, 0x082D)):
        (device,) = connected(lambda backend: [CameraInfo(1, "Half told", "", *half, backend)])  # noqa: B023
        assert device == Device(1, "Half told", None)


def test_a_camera_is_known_by_number_and_by_path() -> None:
    assert name_of(2, DEVICES) == name_of("/dev/video2", DEVICES) == "HD Pro Webcam C920 (046D:082D)"
    assert name_of(0, DEVICES) == "Integrated Camera"
    assert name_of(7, DEVICES) == "camera 7"


def test_each_mode_that_it_gives_is_listed_once() -> None:
    assert list(modes_of(0, FakeCapture)) == [Mode((640, 480), 30.0, "MJPG"), Mode((1280, 720), 30.0, "MJPG")]
    assert FakeCapture.opened == FakeCapture.released


def test_a_camera_that_cannot_be_opened_has_no_modes() -> None:
    assert list(modes_of(1, FakeCapture)) == []
    assert FakeCapture.opened == FakeCapture.released


def test_what_a_driver_does_not_tell_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A size of none, and a code of no letters: OpenCV gives -1 and 0 for what it does not know."""
    monkeypatch.setattr(FakeCapture, "sizes", ((0, 0), (640, 0), (640, 480)))
    for fourcc in (-1, 0, 0x04030201, 1 << 40):
        monkeypatch.setattr(FakeCapture, "fourcc", fourcc)
        assert list(modes_of(0, FakeCapture)) == [Mode((640, 480), 30.0, "")]
