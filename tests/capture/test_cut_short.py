"""Recordings whose program was killed are found again, and nothing else is touched."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from ashe_live.capture.clip import ClipSource
from ashe_live.capture.cut_short import rescue_recordings
from ashe_live.core.arrays import Image
from ashe_live.core.output_files import partial_name

Draw = Callable[[int], Image]


@pytest.fixture
def abandoned(clip: Path) -> Path:
    """An hour ago, under its hidden name."""
    partial = clip.rename(partial_name(clip.with_name("walk.mp4")))
    an_hour_ago = partial.stat().st_mtime - 3600
    os.utime(partial, (an_hour_ago, an_hour_ago))
    return partial


def test_it_gets_a_name_that_can_be_seen(abandoned: Path) -> None:
    (found,) = rescue_recordings(abandoned.parent)
    assert found.name == "walk-cut-short.mp4"
    assert [path.name for path in found.parent.iterdir()] == [found.name]
    with ClipSource(found) as source:
        assert source.read() is not None
    assert rescue_recordings(abandoned.parent) == []


def test_nothing_is_overwritten(abandoned: Path) -> None:
    taken = abandoned.with_name("walk-cut-short.mp4")
    taken.write_text("precious")
    (found,) = rescue_recordings(abandoned.parent)
    assert found.name == "walk-cut-short-2.mp4"
    assert taken.read_text() == "precious"


def test_what_is_being_written_or_is_no_clip_is_left_alone(abandoned: Path, tmp_path: Path) -> None:
    os.utime(abandoned)
    broken = tmp_path / ".notes.partial.mp4"
    broken.write_text("not a clip")
    os.utime(broken, (0, 0))
    assert rescue_recordings(tmp_path) == []
    assert {path.name for path in tmp_path.iterdir()} == {abandoned.name, broken.name}


def test_a_folder_that_is_not_there_holds_none(tmp_path: Path) -> None:
    assert rescue_recordings(tmp_path / "missing") == []
