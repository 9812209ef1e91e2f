"""A camera that is missing, busy, forbidden, unplugged in mid-run, and back: played by a fake capture."""

import itertools
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ashe_live.capture.sources import SourceLost
from ashe_live.capture.webcam import WebcamSource, camera_error
from ashe_live.core.arrays import Image
from ashe_live.errors import UserError


class FakeCapture:
    """Gives `count` pictures of `size` and then fails, as when the camera is pulled out."""

    def __init__(self, count: int, size: tuple[int, int] = (64, 48), opens: bool = True) -> None:
        self.left = count
        self.size = size
        self.opens = opens
        self.is_released = False

    def isOpened(self) -> bool:
        return self.opens

    def grab(self) -> bool:
        self.left -= 1
        return self.left >= 0

    def retrieve(self) -> tuple[bool, Image | None]:
        return True, np.zeros((self.size[1], self.size[0], 3), np.uint8)

    def get(self, prop: int) -> float:  # noqa: ARG002
        return 0.0

    def release(self) -> None:
        self.is_released = True


def one_after_another(*captures: FakeCapture) -> Callable[[int | str, tuple[int, int] | None], FakeCapture]:
    waiting = iter(captures)
    return lambda camera, size: next(waiting)  # noqa: ARG005


def ticking(step_s: float = 0.1) -> Callable[[], float]:
    ticks = itertools.count()
    return lambda: 1000.0 + next(ticks) * step_s


def test_frames_carry_the_time_at_which_they_arrived() -> None:
    with WebcamSource(0, open_capture=one_after_another(FakeCapture(3)), clock_s=ticking()) as source:
        frames = [source.read() for _ in range(3)]
        assert source.size == (64, 48)
        assert source.fps == 30.0, "a camera that does not tell its rate"
    assert [frame.index for frame in frames] == [0, 1, 2]
    np.testing.assert_allclose([frame.time_s for frame in frames], [0.0, 0.1, 0.2])


def test_lost_camera_is_said_and_resumes_where_it_was() -> None:
    first, gone, closed, back = FakeCapture(2), FakeCapture(0), FakeCapture(0, opens=False), FakeCapture(5)
    source = WebcamSource(0, open_capture=one_after_another(first, gone, closed, back), clock_s=ticking())
    source.read()
    last = source.read()
    with pytest.raises(SourceLost, match="no more pictures"):
        source.read()
    assert first.is_released, "or the system cannot give the device away again"
    with pytest.raises(SourceLost):
        source.read()
    assert [source.reopen() for _ in range(3)] == [False, False, True]
    frame = source.read()
    assert frame.index == last.index + 1
    assert frame.time_s > last.time_s
    source.close()
    source.close()
    assert all(capture.is_released for capture in (gone, closed, back))


def test_reopening_asks_for_the_size_it_had_and_accepts_no_other() -> None:
    asked: list[tuple[int, int] | None] = []
    captures = iter([FakeCapture(1), FakeCapture(9, size=(32, 24))])

    def open_capture(camera: int | str, size: tuple[int, int] | None) -> FakeCapture:  # noqa: ARG001
        asked.append(size)
        return next(captures)

    source = WebcamSource(0, (640, 480), open_capture)
    source.read()
    with pytest.raises(UserError, match="32x24 and not 64x48"):
        source.reopen()
    assert asked == [(640, 480), (64, 48)]


def test_empty_picture_counts_as_lost() -> None:
    capture = FakeCapture(9)
    source = WebcamSource(0, open_capture=one_after_another(capture))
    source.read()
    capture.size = (0, 0)
    with pytest.raises(SourceLost):
        source.read()


@pytest.mark.parametrize("capture", [FakeCapture(9, opens=False), FakeCapture(0)])
def test_camera_without_pictures_is_a_user_error_and_released(capture: FakeCapture) -> None:
    with pytest.raises(UserError):
        WebcamSource(0, open_capture=one_after_another(capture))
    assert capture.is_released


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells why a camera fails")
class TestRemedy:
    def test_missing_camera_names_those_that_exist(self, tmp_path: Path) -> None:
        (tmp_path / "video2").touch()
        error = camera_error(0, tmp_path)
        assert "there is no camera" in error.message
        assert str(tmp_path / "video2") in error.remedy

    def test_no_camera_at_all_points_to_clips(self, tmp_path: Path) -> None:
        assert "ashe-live play" in camera_error(0, tmp_path).remedy

    def test_forbidden_camera_names_the_group(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        (tmp_path / "video0").touch()
        monkeypatch.setattr(os, "access", lambda path, mode: False)  # noqa: ARG005
        assert "group video" in camera_error(0, tmp_path).remedy

    def test_busy_camera_names_other_programs(self, tmp_path: Path) -> None:
        (tmp_path / "video0").touch()
        assert "other programs" in camera_error(str(tmp_path / "video0")).remedy

    def test_opencv_says_nothing_of_its_own(self, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
        with pytest.raises(UserError, match="there is no camera"):
            WebcamSource(str(tmp_path / "video9"))
        assert capfd.readouterr().err == ""
