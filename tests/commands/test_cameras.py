"""`ashe-live cameras`: a table, or one line that says what to do."""

import pytest

from ashe_live.capture.cameras import Device, Mode
from ashe_live.commands import cameras


def test_each_camera_is_listed_with_its_modes(run, monkeypatch: pytest.MonkeyPatch) -> None:
    modes = {0: [Mode((640, 480), 30.0, "MJPG"), Mode((1280, 720), 60.0, "")], 2: []}
    monkeypatch.setattr(cameras, "connected", lambda: [Device(0, "Laptop", None), Device(2, "C920", "/dev/video2")])
    monkeypatch.setattr(cameras, "modes_of", lambda number: iter(modes[number]))
    text = "\n".join(run("cameras").out)
    for said in ("Laptop", "C920", "640x480   30 fps   MJPG", "1280x720   60 fps", "in use, or forbidden"):
        assert said in text
    fast = run("cameras", "--fast")
    assert fast.status == 0
    assert "640x480" not in "\n".join(fast.out)


def test_without_a_camera_it_says_what_to_do(run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cameras, "connected", list)
    assert "no camera" in run("cameras").refusal
