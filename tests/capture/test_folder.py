"""Which files of a folder are pictures, and what is said of the others."""

import os
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.folder import pictures_in, refuse_folder
from ashe_live.capture.opening import open_source
from ashe_live.errors import UserError


def picture(path: Path, kind: str = "JPEG") -> None:
    PIL.Image.fromarray(np.full((40, 60, 3), 90, np.uint8)).save(path, kind)


def test_photos_and_clips_are_taken_and_what_is_not_is_said(tmp_path: Path) -> None:
    for name in ("b.JPG", "recovered", ".hidden.jpg"):
        picture(tmp_path / name)
    picture(tmp_path / "c.gif", "GIF")
    for name in ("a.mp4", "raw.dng", "README", "notes.txt", "z.json", ".hidden"):
        (tmp_path / name).write_bytes(b"content")
    (tmp_path / "empty").touch()
    (tmp_path / "folder.jpg").mkdir()
    os.mkfifo(tmp_path / "pipe")
    pictures, note = pictures_in(tmp_path, with_clips=True)
    assert [path.name for path in pictures] == ["a.mp4", "b.JPG", "c.gif", "recovered"]
    assert note is not None
    assert note.endswith("passed over, as not named as photos or clips: README, empty, notes.txt and 2 more")
    pictures, note = pictures_in(tmp_path, with_clips=False)
    assert [path.name for path in pictures] == ["b.JPG", "recovered"]
    assert note is not None
    assert "a.mp4, c.gif" in note


def test_the_names_that_cameras_give_are_those_of_photos_and_clips(tmp_path: Path) -> None:
    """On any system, whatever its list of types has: camcorders, old phones, Canon's and Sony's HEIF, browsers."""
    names = ["00001.MTS", "clip.3gp", "dump.mjpeg", "film.mkv", "photo.HIF", "saved.jfif", "tape.m2ts", "tv.ts"]
    for name in names:
        (tmp_path / name).write_bytes(b"content")
    assert pictures_in(tmp_path, with_clips=True) == ([tmp_path / name for name in names], None)


def test_nothing_is_said_of_a_folder_of_photos_alone(tmp_path: Path) -> None:
    picture(tmp_path / "a.jpg")
    (tmp_path / ".DS_Store").write_bytes(b"x")
    assert pictures_in(tmp_path, with_clips=True) == ([tmp_path / "a.jpg"], None)


def test_a_gif_can_be_opened_as_it_is_taken(tmp_path: Path) -> None:
    picture(tmp_path / "a.gif", "GIF")
    with open_source(tmp_path / "a.gif") as source:
        assert isinstance(source, ClipSource)
        assert source.size == (60, 40)


def test_a_folder_whose_files_must_not_be_read_is_not_called_empty(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Root may read everything, so the system's answer is put in its place."""
    picture(tmp_path / "a.jpg")
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # noqa: ARG005
    with pytest.raises(UserError, match=r"cannot read the folder .* \(Permission denied\)"):
        pictures_in(tmp_path, with_clips=True)
    with pytest.raises(UserError, match="cannot read the folder"):
        refuse_folder(tmp_path)


def test_a_folder_is_refused_where_a_file_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("f/8")
    with pytest.raises(UserError, match="there is no photo or clip in it"):
        refuse_folder(tmp_path)
    refuse_folder(tmp_path / "notes.txt")
    refuse_folder(tmp_path / "missing")


def test_a_link_into_a_folder_that_must_not_be_entered_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.jpg", "link.jpg"):
        picture(tmp_path / name)
    is_file = Path.is_file

    def looked_at(path: Path) -> bool:
        if path.name == "link.jpg":
            raise PermissionError
        return is_file(path)

    monkeypatch.setattr(Path, "is_file", looked_at)
    assert pictures_in(tmp_path, with_clips=True) == ([tmp_path / "a.jpg"], None)
