"""The camera that several commands make of the same options."""

import argparse

import pytest

from ashe_live.commands.flags.setup import camera_chooser


def test_one_focal_length_for_pictures_of_two_sizes_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    camera_for = camera_chooser(argparse.Namespace(camera_file=None, focal_px=600.0, hfov=None))
    for size in ((640, 480), (480, 640), (640, 480)):
        assert camera_for(size).K[0, 0] == 600
    assert capsys.readouterr().err == ""
    for _ in range(2):
        camera_for((1280, 960))
    (line,) = capsys.readouterr().err.splitlines()
    assert "--focal-px 600 is taken for pictures of 1280x960 as well as of 640x480" in line
