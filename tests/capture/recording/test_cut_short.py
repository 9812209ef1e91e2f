"""Recordings whose program was killed are found again, and nothing else is touched."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import pytest

from ashe_live.capture.recording import cut_short
from ashe_live.capture.recording.cut_short import rescue_recordings
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.arrays import Image
from ashe_live.files import new_file
from ashe_live.files.new_file import partial_path
from tests.capture.conftest import frames_of
from tests.checkout import CHECKOUT
from tests.windows_files import as_on_windows

Draw = Callable[[int], Image]

RECORD_UNTIL_KILLED = """
import sys, numpy as np
from ashe_live.capture.recording.recorder import Recorder
recorder = Recorder(sys.argv[1], (96, 64), 10)
for i in range(int(sys.argv[2])):
    recorder.write(np.full((64, 96, 3), i, np.uint8), i / 10)
print("recording", flush=True)
sys.stdin.read()
"""


def killed_recording(path: Path, frames: int) -> Path:
    """What a program leaves of a recording at `path` that is killed after so many frames."""
    before = set(path.parent.iterdir())
    with subprocess.Popen(
        [sys.executable, "-c", RECORD_UNTIL_KILLED, str(path), str(frames)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=CHECKOUT,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"recording\n"
        process.kill()
    (partial,) = set(path.parent.iterdir()) - before
    return partial


@pytest.fixture(scope="module")
def nine_seconds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return killed_recording(tmp_path_factory.mktemp("killed") / "walk.mp4", 90)


@pytest.fixture(params=["here", "as on Windows"])
def a_system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param != "here":
        as_on_windows(monkeypatch)


pytestmark = pytest.mark.usefixtures("a_system")


@pytest.fixture
def abandoned(nine_seconds: Path, tmp_path: Path) -> Path:
    """Of walk.mp4, under its hidden name."""
    return Path(shutil.copy(nine_seconds, tmp_path))


def test_it_gets_a_name_that_can_be_seen_at_once(abandoned: Path) -> None:
    (found,) = rescue_recordings(abandoned.parent)
    assert found.name == "walk-cut-short.mp4"
    assert list(found.parent.iterdir()) == [found]
    assert len(frames_of(found)) >= 40
    assert rescue_recordings(abandoned.parent) == []


def test_nothing_is_overwritten(abandoned: Path) -> None:
    taken = abandoned.with_name("walk-cut-short.mp4")
    taken.write_text("precious")
    (found,) = rescue_recordings(abandoned.parent)
    assert found.name == "walk-cut-short-2.mp4"
    assert taken.read_text() == "precious"


def test_a_name_in_capitals_is_found_too(tmp_path: Path) -> None:
    killed_recording(tmp_path / "WALK.MP4", 90)
    (found,) = rescue_recordings(tmp_path)
    assert found.name == "WALK-cut-short.mp4"


def test_one_that_broke_off_before_its_first_picture_goes(tmp_path: Path) -> None:
    partial = killed_recording(tmp_path / "walk.mp4", 3)
    assert rescue_recordings(tmp_path) == []
    assert not partial.exists()


def test_what_is_being_recorded_is_left_alone_however_long_it_rests(tmp_path: Path, picture: Draw) -> None:
    with Recorder(tmp_path / "walk.mp4", (96, 64), 10) as recorder:
        for index in range(60):
            recorder.write(picture(index), index / 10)
        (partial,) = tmp_path.iterdir()
        os.utime(partial, (0, 0))
        assert rescue_recordings(tmp_path) == []
        assert list(tmp_path.iterdir()) == [partial]
    assert len(frames_of(tmp_path / "walk.mp4")) == 60


def contents(folder: Path) -> dict[str, bytes | str]:
    """By name: what files hold, and where links lead."""
    return {
        path.name: str(path.readlink()) if path.is_symlink() else path.read_bytes()
        for path in folder.iterdir()
        if path.is_symlink() or path.is_file()
    }


def test_files_and_links_of_others_are_left_alone(abandoned: Path, tmp_path: Path, clip: Path) -> None:
    folder = tmp_path / "others"
    folder.mkdir()
    thesis = folder / "thesis.txt"
    thesis.write_text("ten years")
    partial_path(folder / "a.mp4").symlink_to(thesis)
    partial_path(folder / "recording.mp4").symlink_to(abandoned)
    partial_path(folder / "gone.mp4").symlink_to("gone")
    partial_path(folder / "b.mp4").write_text("not a clip")
    partial_path(folder / "c.mp4").write_bytes(b"")
    shutil.copy(clip, partial_path(folder / "finished.mp4"))
    (folder / ".movie.partial.mp4").write_bytes(abandoned.read_bytes())
    partial_path(folder / "folder.mp4").mkdir()
    os.mkfifo(partial_path(folder / "pipe.mp4"))
    before = contents(folder)
    assert rescue_recordings(folder) == []
    assert contents(folder) == before
    assert abandoned.exists()


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="the system does not tell whose a file is")
def test_those_of_other_users_are_left_alone(abandoned: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a folder that is shared."""
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    assert rescue_recordings(abandoned.parent) == []
    assert list(abandoned.parent.iterdir()) == [abandoned]


def test_what_takes_its_place_while_it_is_copied_stays(abandoned: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if new_file.fcntl is None:
        pytest.skip("on Windows nothing takes the place of a file that is open")
    copy = cut_short.copy_whole_fragments

    def copy_and_replace(broken: BinaryIO, whole: BinaryIO) -> None:
        copy(broken, whole)
        abandoned.unlink()
        abandoned.write_text("precious")

    monkeypatch.setattr(cut_short, "copy_whole_fragments", copy_and_replace)
    (found,) = rescue_recordings(abandoned.parent)
    assert len(frames_of(found)) >= 40
    assert abandoned.read_text() == "precious"


def test_a_folder_that_is_not_there_holds_none(tmp_path: Path) -> None:
    assert rescue_recordings(tmp_path / "missing") == []
