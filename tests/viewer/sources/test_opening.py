"""Files that are dropped on the window: opened off the main thread, and without effect when they cannot be."""

import os
import threading
from pathlib import Path

import glfw
import numpy as np
import PIL.Image
import pillow_heif
import pytest

from ashe_live.capture.opening import open_source
from ashe_live.errors import UserError
from ashe_live.viewer.hands.requests import Command, Files, Request
from ashe_live.viewer.sources import opening as opening_module
from ashe_live.viewer.sources.opening import Opening, of_each_kind, paths_in
from ashe_live.viewer.sources.pipeline import Pipeline
from ashe_live.viewer.windows.glfw_window import GlfwWindow
from tests.patience import PATIENCE_S


@pytest.fixture
def opening(fakes):
    """With the real sources and a stand-in for the tracker."""

    def opener(path: Path):
        tracker = fakes.Tracker()
        tracker.track = fakes.tracked_in
        pipeline = Pipeline(open_source(path), tracker, True)
        pipeline.start()
        return pipeline

    opening = Opening(opener)
    yield opening
    opening.close()


def awaited(opening: Opening):
    opening._coming.exception(PATIENCE_S)
    return opening.take()


def test_a_clip_comes_with_its_first_frame(opening, film):
    assert opening.progress is None
    opening.begin(film.path)
    assert opening.progress == f"opening {film.path.name}"
    opened = awaited(opening)
    assert opening.progress is None
    assert opened.name == film.path.name
    assert opened.first.frame.size == film.size
    assert opened.pipeline.is_clip
    assert opening.take() is None
    opened.pipeline.close()


@pytest.mark.parametrize("name", ["photo.png", "photo.heic"])
def test_a_photo_comes_too(opening, tmp_path, name):
    pillow_heif.register_heif_opener()  # to write with
    PIL.Image.fromarray(np.zeros((48, 64, 3), np.uint8)).save(tmp_path / name)
    opening.begin(tmp_path / name)
    opened = awaited(opening)
    assert opened.pipeline.is_photo
    assert opened.first.frame.size == (64, 48)
    opened.pipeline.close()


@pytest.mark.parametrize("name", ["missing.mp4", "empty.mp4", "nonsense.mp4", "torn.png", "notes.txt", "folder"])
def test_what_cannot_be_opened_says_so_once(opening, tmp_path, name):
    path = tmp_path / name
    if name == "folder":
        path.mkdir()
    elif name != "missing.mp4":
        path.write_bytes(b"" if name == "empty.mp4" else b"\x89PNG nonsense, and no picture")
    opening.begin(path)
    with pytest.raises(UserError) as error:
        awaited(opening)
    assert name in error.value.message
    assert "\n" not in str(error.value)
    assert opening.take() is None


@pytest.mark.parametrize(
    ("path", "named", "remedy"),
    [(Path("strange.mp4"), "strange.mp4", "convert it"), (None, "another camera", "plug it in again")],
)
def test_whatever_a_file_or_a_camera_does_to_its_reader_is_one_line(path, named, remedy):
    def opener(_path):
        raise ZeroDivisionError("in a library")

    opening = Opening(opener)
    opening.begin(path)
    assert opening.progress == f"opening {named}"
    with pytest.raises(UserError, match="in a library") as error:
        awaited(opening)
    assert named in error.value.message
    assert error.value.remedy == remedy


@pytest.mark.parametrize(("path", "remedy"), [(Path("slow.mp4"), "disk"), (None, "plug it in")])
def test_a_source_that_gives_no_picture_is_let_go(fakes, monkeypatch, path, remedy):
    """Else a camera would stay taken."""
    monkeypatch.setattr(opening_module, "LONGEST_S", 0.05)
    source, go_on = fakes.Source(), threading.Event()
    source.hook = lambda _index: go_on.wait(PATIENCE_S)

    def opener(_path):
        pipeline = Pipeline(source, fakes.Tracker(), True)
        pipeline.start()
        return pipeline

    opening = Opening(opener)
    opening.begin(path)
    with pytest.raises(UserError, match="given no picture") as error:
        awaited(opening)
    assert remedy in error.value.remedy
    go_on.set()
    assert source.closed.wait(PATIENCE_S)


def test_what_is_abandoned_does_not_come_and_without_an_opener_nothing_does(opening, film):
    opening.begin(film.path)
    coming = opening._coming
    opening.close()
    coming.exception(PATIENCE_S)
    nothing = Opening(None)
    nothing.begin(film.path)
    for each in (opening, nothing):
        assert each.progress is None
        assert each.take() is None


def test_nobody_hears_of_an_abandoned_file_that_cannot_be_opened(opening, tmp_path, caplog):
    """What is raised in a thread that nobody waits for is logged on the terminal."""
    opening.begin(tmp_path / "missing.mp4")
    coming = opening._coming
    opening.close()
    assert isinstance(coming.exception(PATIENCE_S), UserError)
    for thread in threading.enumerate():
        if thread.name == "opening":  # it may be about to say so
            thread.join(PATIENCE_S)
    assert caplog.records == []


def test_of_two_files_in_a_row_the_last_is_shown_and_the_first_is_closed(fakes):
    go_on, pipelines = threading.Event(), {}

    def opener(path: Path):
        if path.name == "first":
            go_on.wait(PATIENCE_S)
        pipelines[path.name] = Pipeline(fakes.Source(), fakes.Tracker(), True)
        pipelines[path.name].start()
        return pipelines[path.name]

    opening = Opening(opener)
    opening.begin(Path("first"))
    assert opening.take() is None, "the window goes on meanwhile"
    first = opening._coming
    opening.begin(Path("last"))
    assert awaited(opening).pipeline is pipelines["last"]
    go_on.set()
    assert first.result(PATIENCE_S).pipeline is pipelines["first"]
    assert pipelines["first"]._source.closed.wait(PATIENCE_S)
    pipelines["last"].close()


@pytest.mark.parametrize(
    ("paths", "models", "sources"),
    [
        (["/a/chair.OBJ"], ["/a/chair.OBJ"], []),
        (["/a/clip.mov"], [], ["/a/clip.mov"]),
        (["/a/photo.jpg", "/a/other.jpg", "/a/photo.jpg"], [], ["/a/photo.jpg", "/a/other.jpg"]),
        (["/a/wood.png", "/a/chair.obj", "/a/chair.mtl", "/a/chair.bin"], ["/a/chair.obj"], []),  # what belongs to it
        (
            ["/a/clip.mp4", "/a/one.glb", "/a/two.glb", "/a/late.webm"],
            ["/a/one.glb", "/a/two.glb"],
            ["/a/clip.mp4", "/a/late.webm"],
        ),
        (["/a/photo.JPG", "/a/mug.glb", "/a/mug.txt"], ["/a/mug.glb"], ["/a/photo.JPG"]),
        (["/a/part.stl", "/a/chair.gltf", "/a/wood.jpg"], ["/a/part.stl", "/a/chair.gltf"], []),
        (["a.obj", "http://[a/b.mp4"], ["a.obj"], ["http://[a/b.mp4"]),  # no address at all, and no reason to end
        (["/a/notes.txt"], [], ["/a/notes.txt"]),  # which says that it is no clip
        ([], [], []),
    ],
)
def test_files_that_are_dropped_together_are_of_two_kinds(paths, models, sources):
    assert of_each_kind(paths) == (models, sources)


@pytest.mark.parametrize(
    ("text", "paths"),
    [
        ("/a/b c.mp4\n", ("/a/b c.mp4",)),
        ("file:///a/b%20c.mp4\r\nfile:///a/d.glb\r\n", ("/a/b c.mp4", "/a/d.glb")),
        ('"/a/b.mp4"', ("/a/b.mp4",)),
        ("'/a/b.mp4'", ("/a/b.mp4",)),
        ("file:///C:/a/b%20c.glb", ("C:/a/b c.glb",)),
        (
            "x-special/nautilus-clipboard\ncopy\nfile:///a/b%20c.mp4\n",
            ("/a/b c.mp4",),
        ),  # as GNOME's Files did until 2021
        ("file://host/a/b.mp4", ("/a/b.mp4",)),
        ("file:///a/caf%E9.mp4", (os.fsdecode(b"/a/caf\xe9.mp4"),)),  # a name that is not UTF-8
        ("file://[a/b.mp4", ("/b.mp4",)),  # no address at all, and no reason to end
        ("file://", ("/",)),
        ("it's.mp4\nrock'n'roll.mp4", ("it's.mp4", "rock'n'roll.mp4")),
        ("~clip.mp4", ("~clip.mp4",)),
        ("/a/" + 50 * "word " + "name\n/a/b.mp4", ("/a/" + 50 * "word " + "name", "/a/b.mp4")),
        (60 * "word " + "\n/a/b.mp4", ("/a/b.mp4",)),  # no name of a file is as long as a paragraph
        ("\n  \n", ()),
        ("", ()),
    ],
)
def test_copied_text_names_files(text, paths):
    assert paths_in(text) == paths


@pytest.mark.skipif(os.name != "posix", reason="a backslash separates folders there")
@pytest.mark.parametrize(
    ("written", "path"),
    [  # as bash completes it, and as GNOME's terminal and Konsole write what is dropped on them
        (r"/a\ b/my\ clip\ \(1\).mp4", "/a b/my clip (1).mp4"),
        (r"/a\ b/it\'s\ mine.mp4", "/a b/it's mine.mp4"),
        (r"/a\ b/\$5\ \&\ Küche.mp4", "/a b/$5 & Küche.mp4"),
        ("'/a b/my clip (1).mp4' ", "/a b/my clip (1).mp4"),
        (r"'/a b/it'\''s mine.mp4' ", "/a b/it's mine.mp4"),
        (r"'/a b/100 %\ \(2).mp4'", r"/a b/100 %\ \(2).mp4"),  # within quotes a backslash is one
        (r"/a/b\c.mp4", r"/a/b\c.mp4"),  # a shell would put two
    ],
)
def test_a_path_may_be_copied_as_a_shell_writes_it(written, path):
    assert paths_in(f"{written}\n") == (path,)


def test_a_path_in_the_home_folder_is_found(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert [Path(path) for path in paths_in('~/clip.mp4\n"~/b c.mp4"')] == [tmp_path / "clip.mp4", tmp_path / "b c.mp4"]


def test_the_windows_drop_is_a_request():
    window = GlfwWindow.__new__(GlfwWindow)  # without a display
    window._requests = []
    window._on_drop(None, ["/a/b.glb", "/a/c d.mp4"])
    assert window._requests == [Request(Command.OPEN, Files(("/a/b.glb", "/a/c d.mp4")))]


def test_a_dropped_name_that_is_not_utf8_is_the_systems_name_of_the_file(monkeypatch):
    name = b"/a/caf\xe9.glb"
    window = GlfwWindow.__new__(GlfwWindow)
    window._requests = []
    # pyGLFW's callback decodes, and what that raises comes out of the call that waits for events.
    monkeypatch.setattr(glfw, "poll_events", lambda: name.decode("utf-8"))
    assert window.take_requests(0.0) == [Request(Command.OPEN, Files((os.fsdecode(name),)))]
