"""A camera that is missing, busy, forbidden, unplugged in mid-run, and back: played by a fake capture."""

import itertools
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from ashe_live.capture import camera_error as camera_errors
from ashe_live.capture import webcam
from ashe_live.capture.camera_error import camera_error, check_is_device, programs_using
from ashe_live.capture.sources import SourceLost
from ashe_live.capture.webcam import BACKEND, WebcamSource, open_opencv_capture
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError
from tests.patience import PATIENCE_S


class FakeCapture:
    """Gives a picture whenever the test says `tick`, `count` in all, and then fails, as when the camera is pulled out.

    Each picture's grey tells its number.
    """

    def __init__(self, count: int, size: tuple[int, int] = (64, 48), opens: bool = True) -> None:
        self.size = size
        self.opens = opens
        self.released = threading.Event()
        self._left = count
        self._changed = threading.Condition()
        self._shown = 1  # the one that opening waits for
        self._grabs = 0

    def tick(self, pictures: int = 1) -> None:
        """Shows so many pictures, and waits until each has been handed over."""
        with self._changed:
            self._shown += pictures
            self._changed.notify_all()
            # Who asks for one more has handed over all others.
            assert self._changed.wait_for(lambda: self._grabs > self._shown or self.released.is_set(), PATIENCE_S)

    def isOpened(self) -> bool:
        return self.opens

    def grab(self) -> bool:
        with self._changed:
            self._grabs += 1
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._shown >= self._grabs or self._left == 0, PATIENCE_S)
            self._left -= 1
            return self._left >= 0

    def retrieve(self) -> tuple[bool, Image | None]:
        return True, np.full((self.size[1], self.size[0], 3), self._grabs - 1, np.uint8)

    def get(self, prop: int) -> float:  # noqa: ARG002
        return 0.0

    def release(self) -> None:
        self.released.set()
        with self._changed:
            self._changed.notify_all()


class Flowing(FakeCapture):
    """One that gives picture after picture, as fast as they are taken, and tells its rate."""

    def grab(self) -> bool:
        return True

    def retrieve(self) -> tuple[bool, Image | None]:
        return True, np.zeros((48, 64, 3), np.uint8)

    def get(self, prop: int) -> float:
        return {cv2.CAP_PROP_FPS: 15.0}.get(prop, 0.0)


def one_after_another(*captures: FakeCapture) -> Callable[[int | str, tuple[int, int] | None], FakeCapture]:
    waiting = iter(captures)
    return lambda camera, size: next(waiting)  # noqa: ARG005


def ticking(step_s: float = 0.1) -> Callable[[], float]:
    ticks = itertools.count()
    return lambda: 1000.0 + next(ticks) * step_s


@pytest.mark.parametrize("size", [None, (1280, 720)])
def test_a_camera_is_asked_for_its_size_in_a_format_that_usb_carries(
    monkeypatch: pytest.MonkeyPatch, size: tuple[int, int] | None
) -> None:
    """After the format: a camera has other sizes in each of them. And for a short queue, as pictures grow old in it."""
    asked: list[tuple[int, float]] = []

    class Asked:
        def __init__(self, *where: object) -> None:
            assert where == (7, BACKEND)

        def set(self, prop: int, value: float) -> None:
            asked.append((prop, value))

    monkeypatch.setattr(cv2, "VideoCapture", Asked)
    monkeypatch.delenv("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", raising=False)
    open_opencv_capture(7, size)
    assert float(os.environ.pop("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT")) < 10
    assert asked[0] == (cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
    sides = [] if size is None else [(cv2.CAP_PROP_FRAME_WIDTH, size[0]), (cv2.CAP_PROP_FRAME_HEIGHT, size[1])]
    assert asked[1:] == [*sides, (cv2.CAP_PROP_BUFFERSIZE, 2)]


def test_a_camera_that_is_closed_is_free_for_others() -> None:
    capture, before = Flowing(1), threading.enumerate()
    with WebcamSource(0, open_capture=one_after_another(capture)) as source:
        assert source.fps == 15.0
        assert source.is_live
        assert not source.is_photo
        assert not capture.released.is_set()
        (grabber,) = (thread for thread in threading.enumerate() if thread not in before)
        assert grabber.daemon, "a driver that hangs does not keep the program from its end"
    assert capture.released.wait(PATIENCE_S)
    with pytest.raises(SourceLost):
        source.read()


def test_a_camera_that_shows_nothing_for_long_is_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """As soon as it lets go of the thread that waits in it."""
    monkeypatch.setattr(webcam, "FIRST_PICTURE_S", 0.0)
    monkeypatch.setattr(webcam, "PATIENCE_S", 0.0)
    lets_go = threading.Event()

    class Silent(Flowing):
        def grab(self) -> bool:
            return lets_go.wait(PATIENCE_S)

    capture = Silent(1)
    with pytest.raises(UserError):
        WebcamSource(987, open_capture=one_after_another(capture))
    lets_go.set()
    assert capture.released.wait(PATIENCE_S)


def test_frames_carry_the_time_at_which_they_arrived() -> None:
    capture = FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(capture), clock_s=ticking())
    assert source.size == (64, 48)
    assert source.fps == 30.0, "a camera that does not tell its rate"
    assert source.note is None
    frames = [source.read()]
    for _ in range(2):
        capture.tick()
        frames.append(source.read())
    assert [frame.index for frame in frames] == [0, 1, 2]
    np.testing.assert_allclose([frame.time_s for frame in frames], [0.0, 0.1, 0.2])


def test_who_comes_late_gets_the_newest_picture_and_no_older_one_after_it() -> None:
    capture = FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(capture), clock_s=ticking())
    assert source.read().image_bgr[0, 0, 0] == 0
    capture.tick(4)
    late = source.read()
    assert late.image_bgr[0, 0, 0] == 4
    assert late.index == 1
    assert late.time_s == pytest.approx(0.4)
    capture.tick()
    assert source.read().image_bgr[0, 0, 0] == 5


def test_lost_camera_is_said_and_resumes_where_it_was() -> None:
    first, gone, closed, back = FakeCapture(2), FakeCapture(0), FakeCapture(0, opens=False), FakeCapture(5)
    source = WebcamSource(0, open_capture=one_after_another(first, gone, closed, back), clock_s=ticking())
    source.read()
    first.tick()
    last = source.read()
    with pytest.raises(SourceLost, match="no more pictures"):
        source.read()
    assert first.released.wait(PATIENCE_S), "or the system cannot give the device away again"
    with pytest.raises(SourceLost):
        source.read()
    assert [source.reopen() for _ in range(3)] == [False, False, True]
    frame = source.read()
    assert frame.index == last.index + 1
    assert frame.time_s > last.time_s
    back.tick()
    source.close()
    source.close()
    back.tick()
    assert all(capture.released.wait(PATIENCE_S) for capture in (gone, closed, back))


def test_reopening_asks_for_the_size_it_had_and_accepts_no_other() -> None:
    asked: list[tuple[int, int] | None] = []
    captures = [FakeCapture(1), FakeCapture(9, size=(32, 24))]

    def open_capture(camera: int | str, size: tuple[int, int] | None) -> FakeCapture:  # noqa: ARG001
        asked.append(size)
        return captures[len(asked) - 1]

    source = WebcamSource(0, (640, 480), open_capture)
    source.read()
    with pytest.raises(UserError, match="32x24 and not 64x48"):
        source.reopen()
    assert asked == [(640, 480), (64, 48)]
    captures[1].tick()  # its thread waits in the driver until then
    assert captures[1].released.wait(PATIENCE_S), "others may use it as it is"


def test_a_camera_is_given_back_before_it_is_opened_again() -> None:
    """A system gives it to one program at a time, also to this one."""
    first, second = Flowing(1), Flowing(1)

    def open_capture(camera: int | str, size: tuple[int, int] | None) -> FakeCapture:  # noqa: ARG001
        assert size is None or first.released.is_set()
        return first if size is None else second

    with WebcamSource(0, open_capture=open_capture) as source:
        assert source.reopen()
        assert source.read().size == (64, 48)


def test_another_size_in_mid_run_counts_as_lost_and_it_may_come_back_as_it_was() -> None:
    first, back = FakeCapture(9), FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(first, back))
    source.read()
    first.size = (32, 24)
    first.tick()
    with pytest.raises(SourceLost, match="32x24 now"):
        source.read()
    assert source.reopen()
    assert source.read().size == (64, 48)


def test_a_size_that_the_camera_does_not_have_is_said() -> None:
    source = WebcamSource(0, (1920, 1080), one_after_another(FakeCapture(9)))
    assert source.note == "camera 0 does not give pictures of 1920x1080, but of 64x48"
    assert WebcamSource(0, (64, 48), one_after_another(FakeCapture(9))).note is None


def test_empty_picture_counts_as_lost() -> None:
    capture = FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(capture))
    source.read()
    capture.size = (0, 0)
    capture.tick()
    with pytest.raises(SourceLost):
        source.read()


def test_what_goes_wrong_in_the_camera_s_thread_reaches_the_reader() -> None:
    capture = FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(capture))
    source.read()

    def retrieve() -> tuple[bool, Image | None]:
        raise MemoryError

    capture.retrieve = retrieve  # type: ignore[method-assign]
    capture.tick()
    with pytest.raises(MemoryError):
        source.read()


@pytest.mark.parametrize("capture", [FakeCapture(9, opens=False), FakeCapture(0)])
def test_camera_without_pictures_is_a_user_error_and_released(capture: FakeCapture) -> None:
    with pytest.raises(UserError):
        WebcamSource(0, open_capture=one_after_another(capture))
    assert capture.released.wait(PATIENCE_S)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells why a camera fails")
class TestRemedy:
    def test_missing_camera_names_those_that_exist(self, tmp_path: Path) -> None:
        (tmp_path / "video2").touch()
        error = camera_error(0, tmp_path)
        assert "there is no camera" in error.message
        assert str(tmp_path / "video2") in error.remedy

    def test_no_camera_at_all_points_to_clips(self, tmp_path: Path) -> None:
        assert "ashe-live play" in camera_error(0, tmp_path).remedy
        assert camera_error(str(tmp_path / "cam"), tmp_path).message == f"there is no camera {tmp_path / 'cam'}"

    @pytest.mark.parametrize("right", [os.R_OK, os.W_OK])
    def test_forbidden_camera_names_the_group(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, right: int
    ) -> None:
        (tmp_path / "video0").touch()
        monkeypatch.setattr(os, "access", lambda path, mode: not mode & right)  # noqa: ARG005
        assert "group video" in camera_error(0, tmp_path).remedy

    def test_on_other_systems_the_privacy_settings_are_named(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(sys, "platform", "darwin")
        error = camera_error(1)
        assert error.message == "camera 1 cannot be used"
        assert "privacy settings" in error.remedy

    def test_busy_camera_names_other_programs(self, tmp_path: Path) -> None:
        (tmp_path / "video0").touch()
        assert "other programs" in camera_error(str(tmp_path / "video0")).remedy

    def test_busy_camera_names_the_program_that_uses_it(self, tmp_path: Path) -> None:
        device = tmp_path / "video0"
        device.touch()
        assert programs_using(device) == set()
        with device.open() as ours, subprocess.Popen(["sleep", "60"], stdin=ours) as other:
            try:
                assert programs_using(device) == {"sleep"}
                assert "it is used by sleep" in camera_error(str(device)).message
            finally:
                other.kill()

    @pytest.mark.parametrize("name", ["clip.mp4", "\udcff", "link", "/dev/null"])
    def test_only_devices_are_given_to_opencv(self, tmp_path: Path, name: str) -> None:
        """It takes files for clips and addresses for streams, and a name that is no UTF-8 ends the process."""
        (tmp_path / "clip.mp4").write_bytes(b"")
        (tmp_path / "\udcff").write_bytes(b"")
        (tmp_path / "link").symlink_to("clip.mp4")
        with pytest.raises(UserError, match="is not a camera"):
            WebcamSource(str(tmp_path / name))

    def test_a_device_may_be_named_by_a_link(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """As in /dev/v4l/by-id, which tells cameras apart."""
        (tmp_path / "cam").symlink_to("/dev/null")
        monkeypatch.setattr(camera_errors, "VIDEO_MAJOR", os.major(Path("/dev/null").stat().st_rdev))
        check_is_device(str(tmp_path / "cam"))

    def test_opencv_says_nothing_of_its_own(self, capfd: pytest.CaptureFixture[str]) -> None:
        before = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_WARNING)
        try:
            with pytest.raises(UserError, match="there is no camera /dev/video987"):
                WebcamSource(987)
        finally:
            cv2.utils.logging.setLogLevel(before)
        assert capfd.readouterr().err == ""
