"""`ashe-live webcam` with a fake camera: what is asked of it, what it says, and what is known of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from ashe_live.capture.cameras import Device, name_of
from ashe_live.commands import webcam
from ashe_live.core.camera import Size
from ashe_live.core.types import Frame
from ashe_live.tracking.focal.focal import FocalEstimate
from ashe_live.tracking.focal.focal_memory import FocalMemory
from ashe_live.tracking.tracker import MarkerTracker
from tests.viewer.conftest import SIZE, FakeSource

DEVICES = [Device(0, "Laptop", "/dev/video0"), Device(2, "C920", "/dev/video2")]
FOCAL_PX = 71.5


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch, tmp_path) -> SimpleNamespace:
    """What cameras were opened, the set-ups that would have been shown, and what the camera says."""
    camera = SimpleNamespace(asked=[], setups=[], note=None)

    def opened(which: int | str, size: Size | None) -> FakeSource:
        camera.asked.append((which, size))
        source = FakeSource(is_live=True)
        source.note = camera.note
        return source

    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(webcam, "connected", lambda: DEVICES)
    monkeypatch.setattr(webcam, "WebcamSource", opened)
    monkeypatch.setattr(webcam, "show", lambda setup: camera.setups.append(setup) or 0)
    return camera


def test_it_is_opened_by_its_number_or_its_path_with_the_size_that_is_wanted(run, camera) -> None:
    for flags in ((), ("--camera", "2"), ("--camera", "/dev/video2", "--size", "640x480")):
        assert run("webcam", *flags).status == 0
    assert camera.asked == [(0, None), (2, None), ("/dev/video2", (640, 480))]


def test_what_it_says_of_itself_is_said_once(run, camera) -> None:
    assert run("webcam").err == []
    camera.note = "camera 0 gives 640x480 instead of 1920x1080"
    assert run("webcam").err == [f"ashe-live: {camera.note}"]


def focal_px_of(tracker: MarkerTracker) -> float:
    return tracker.track(Frame(np.zeros((SIZE[1], SIZE[0], 3), np.uint8), 0, 0.0)).camera.K[0, 0]


@pytest.mark.parametrize(("which", "is_known"), [("2", True), ("/dev/video2", True), ("0", False)])
def test_the_focal_length_that_was_learned_of_it_is_recalled_whichever_marker_is_followed(
    run, camera, which, is_known
) -> None:
    FocalMemory(name_of(2, DEVICES)).keep(FocalEstimate(SIZE, FOCAL_PX, 0.5, 60))
    run("webcam", "--camera", which)
    (setup,) = camera.setups
    for tracker in (setup.tracker, setup.tracker_for("aruco:4x4_50:7", None)):
        assert bool(abs(focal_px_of(tracker) - FOCAL_PX) < 0.1) is is_known
