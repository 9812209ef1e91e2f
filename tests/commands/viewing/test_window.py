"""`ashe-live play` in a window that is worked by a script: how it ends."""

from pathlib import Path
from typing import Any, Self

import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.camera import Size
from ashe_live.errors import UserError
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.viewer.session import Session
from ashe_live.viewer.windows import glfw_window
from tests.viewer.scripted_window import ScriptedWindow

pytestmark = pytest.mark.usefixtures("instant")
PICTURES = 500  # by then it has ended, or never will


class Window(ScriptedWindow):
    """In the place of GLFW's."""

    def __init__(self, _title: str, _size: Size) -> None:
        super().__init__([lambda: None] * PICTURES)
        self.context = offscreen_context()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None: ...


@pytest.fixture
def play(run, film, monkeypatch):
    """Plays the film for three frames, or until the window closes."""
    monkeypatch.setattr("ashe_live.commands.viewing.window.has_display", lambda: True)
    monkeypatch.setattr(glfw_window, "GlfwWindow", Window)
    flags = ("--hfov", "55", "--quality", "fast", "--no-hide-marker", "--frames", 3)
    return lambda *arguments: run("play", film.path, *flags, *arguments)


def test_what_is_recorded_is_as_long_as_was_asked_for(play, tmp_path):
    assert play("--out", tmp_path / "a.mp4").status == 0
    with ClipSource(tmp_path / "a.mp4") as clip:
        assert len(list(clip)) == 3


def test_a_marker_counts_as_named_where_a_person_has_named_it(play, monkeypatch):
    sessions: list[Session] = []

    def make(*arguments: Any) -> Session:
        sessions.append(Session(*arguments))
        return sessions[-1]

    monkeypatch.setattr("ashe_live.commands.viewing.setup.Session", make)
    for flags in ((), ("--marker", "aruco:4x4_50:7")):
        assert play(*flags).status == 0
    assert [session.has_named_marker for session in sessions] == [False, True]


def test_a_recording_that_is_not_there_is_no_success(play, tmp_path: Path, monkeypatch):
    def write(*_: object) -> None:
        raise UserError("cannot write a.mp4 (No space left on device)", "make room")

    monkeypatch.setattr(Recorder, "write", write)
    outcome = play("--out", tmp_path / "a.mp4")
    assert outcome.status == 2
    assert sum("No space left" in line for line in outcome.out) == 1


@pytest.mark.parametrize("is_headless", [False, True])
def test_recordings_that_were_cut_short_are_looked_for_here_and_where_the_next_one_goes(
    play, tmp_path: Path, monkeypatch, is_headless: bool
):
    asked, here, there = [], tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setattr(
        "ashe_live.commands.viewing.setup.rescue_recordings", lambda folder: asked.append(folder) or [folder / "a.mp4"]
    )
    outcome = play("--out", there / "b.mp4", *(("--headless",) if is_headless else ()))
    assert sorted(asked) == [here, there]
    assert all(
        f"ashe-live: a recording that was cut short is now {folder / 'a.mp4'}" in outcome.err for folder in asked
    )
