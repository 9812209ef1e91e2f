"""The main thread's loop, with a window that is worked by a script."""

import errno
import json
import math
import time
from pathlib import Path

import moderngl
import numpy as np
import PIL.Image
import pytest

from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.recording.recorder import Recorder
from ashe_live.core.camera import Camera
from ashe_live.core.caster import Caster
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.live.key_views import KeyViews
from ashe_live.models.catalogue import ChosenModel
from ashe_live.process.mailbox import LatestMailbox
from ashe_live.quality import BALANCED, FAST
from ashe_live.render.gl.offscreen import graphics_failures_reported
from ashe_live.render.screen import Screen
from ashe_live.tracking.families.seen_instead import SeenInstead
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.display import Display
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.estimates.light_watch import NewAnswer
from ashe_live.viewer.hands.requests import Command, Files, MouseAction, MouseEvent, Request
from ashe_live.viewer.live import LiveViewer, ViewerOptions
from ashe_live.viewer.output import keeping
from ashe_live.viewer.output import recording as recording_module
from ashe_live.viewer.output.recording import Recording
from ashe_live.viewer.quality_choice import QualityChoice
from ashe_live.viewer.session import Session
from ashe_live.viewer.sources import marker_hunt
from ashe_live.viewer.status import guidance
from ashe_live.viewer.stillness import HELD_AFTER_PICTURES
from ashe_live.viewer.table.shelf import Shelf
from ashe_live.viewer.view_options import ShownParts
from tests.light.painted_scenes import BOX, paint
from tests.patience import PATIENCE_S
from tests.viewer.scripted_session import ScriptedSession
from tests.viewer.scripted_window import ScriptedWindow


class ScriptedPipeline:
    """Frames that the test puts in."""

    is_clip, is_photo, is_camera, duration_s, has_ended = True, False, False, 2.0, False
    fps, status, stall, name = 100.0, None, None, "table.mp4"
    clip_path = Path("my films/table.mp4")

    def __init__(self) -> None:
        self.frames, self.key_views = LatestMailbox(), KeyViews()
        self.paused, self.restarts = [], 0
        self.may_follow_others, self.followed = False, []
        self.marker, self.seen_by = "aruco:4x4_50:0", []

    def follow(self, spec: str) -> None:
        self.marker = spec
        self.followed.append(spec)

    def see_by(self, hfov_deg: float | None) -> None:
        self.seen_by.append(hfov_deg)

    def pause(self, paused: bool) -> None:
        self.paused.append(paused)

    def restart(self) -> None:
        self.restarts += 1

    def track_with(self, preset) -> None:
        self.tracking = preset

    def close(self, _timeout_s: float = 0.0) -> None:
        self.frames.close()


class Stage:
    """A viewer between scripted window and scripted pipeline."""

    def __init__(self, fakes) -> None:
        self.fakes = fakes
        self.pipeline, self.dropped = ScriptedPipeline(), ScriptedPipeline()
        self.session = ScriptedSession(fakes, FirstEstimate())
        self.renderer = fakes.Renderer()

    def opener(self, path):
        if path is None:
            raise UserError("no other camera is connected", "plug one in, and press N again")
        if path.suffix == ".txt":
            raise UserError(f"{path} is not a clip", "convert it")
        self.dropped.name = path.name
        return self.dropped

    def put(self, index: int) -> None:
        self.pipeline.frames.put(self.fakes.tracked(index))

    def run(
        self,
        *steps,
        quality: str = "fast",
        frame_limit: int | None = None,
        takes_any_marker: bool = False,
        recording: Recording | None = None,
        flags: tuple[str, ...] = (),
    ) -> LiveViewer:
        self.window = ScriptedWindow(step if callable(step) else lambda step=step: step for step in steps)
        options = ViewerOptions(
            quality, opener=self.opener, takes_any_marker=takes_any_marker, recording=recording, flags=flags
        )
        viewer = LiveViewer(self.window, self.renderer, self.pipeline, self.session, options)
        viewer.run(frame_limit)
        return viewer


@pytest.fixture
def stage(fakes, monkeypatch, tmp_path) -> Stage:
    monkeypatch.chdir(tmp_path)
    return Stage(fakes)


def test_it_ends_when_the_window_closes_or_by_quit(stage):
    stage.run()
    stage.run(Command.LEAVE, None, lambda: pytest.fail("still running"))


def test_the_last_frame_is_drawn_again_and_again(stage):
    stage.put(3)
    stage.run(None, None, None)
    assert [scene.tracked.frame.index for scene in stage.renderer.scenes] == [3, 3, 3, 3]


def test_pictures_have_the_size_that_the_window_has_by_now_and_none_is_drawn_while_it_is_minimised(stage):
    stage.put(0)
    drawn = []

    def resize(size: tuple[int, int]) -> None:
        drawn.append((stage.renderer.size, len(stage.renderer.scenes)))
        stage.window.screen = Screen(size)

    stage.run(*(lambda size=size: resize(size) for size in ((80, 60), (0, 0), (0, 0), (90, 60), (64, 48))))
    sizes, counts = zip(*drawn, strict=True)
    assert sizes == ((64, 48), (80, 60), (80, 60), (80, 60), (90, 60))
    assert counts == (1, 2, 2, 2, 3)


@pytest.mark.parametrize("is_mirrored", [False, True])
@pytest.mark.parametrize("by", ["key", "drag"])
def test_in_a_mirror_the_model_goes_to_where_it_is_seen_to_go(stage, by, is_mirrored):
    stage.put(0)
    stage.session.view.is_mirrored = is_mirrored
    begin, end = (  # above the time bar
        MouseEvent(action, x_px, 4.0, shift=True)
        for action, x_px in ((MouseAction.PRESSED, 20.0), (MouseAction.MOVED, 40.0))
    )
    steps = (Request(Command.MOVE_MODEL, (1, 0)),) if by == "key" else (begin, end)
    stage.run(None, *steps, None)
    to_the_right = stage.session.hand.placement.shift_m[0]
    assert (-to_the_right if is_mirrored else to_the_right) > 0.003


def test_an_answer_that_is_no_news_is_not_printed_again(stage, monkeypatch, capfd):
    stage.put(0)
    found = stage.fakes.estimate(), stage.fakes.tracked(), 0.0, None
    answers = [NewAnswer(*found, is_news=is_news) for is_news in (True, False, False, True)]
    monkeypatch.setattr(stage.session, "poll", lambda _now_s: answers.pop(0) if answers else None)
    stage.run(None, None, None, None, None)
    assert answers == []
    assert capfd.readouterr().out.count("light: ") == 2


def test_at_the_end_of_a_clip_without_a_steady_marker_its_last_frame_is_estimated(stage):
    first = FirstEstimate(Steadiness(3), on_first_steady=True)
    stage.session = ScriptedSession(stage.fakes, first)
    stage.put(0)
    stage.run(None)
    assert stage.session.worker.requested == []
    stage.pipeline = ScriptedPipeline()
    stage.pipeline.has_ended = True
    stage.put(1)
    stage.run(None, None)
    assert [tracked.frame.index for tracked in stage.session.worker.requested] == [1]


def test_a_source_that_fails_keeps_its_last_picture_and_is_reported_once(stage, capfd):
    stage.put(0)
    failure = UserError("the camera came back with another size", "start again")
    stage.run(lambda: stage.pipeline.frames.close(failure), None, None, None)
    assert len(stage.renderer.scenes) == 5
    assert all(scene.tracked.frame.index == 0 for scene in stage.renderer.scenes)
    assert capfd.readouterr().err.count("another size") == 1


def test_a_source_that_fails_before_its_first_picture_ends_the_viewer(stage):
    stage.pipeline.frames.close(UserError("the calibration does not fit", "calibrate again"))
    with pytest.raises(UserError, match="calibration"):
        stage.run(None)


def test_a_bug_in_the_capture_thread_is_not_hidden(stage):
    stage.put(0)
    with pytest.raises(ZeroDivisionError):
        stage.run(lambda: stage.pipeline.frames.close(ZeroDivisionError()), None, None)


def test_the_estimate_is_printed(stage, capfd):
    stage.put(0)
    stage.session.worker.answer = stage.fakes.estimate()
    stage.run(Command.ESTIMATE, None, None)
    assert capfd.readouterr().out == "light: azimuth 0°, elevation 45° ± 2.9°\n"


def test_the_limit_counts_frames_of_the_source(stage):
    stage.put(0)
    steps = [lambda index=index: stage.put(index) for index in range(1, 9)]
    stage.run(*steps, frame_limit=3)
    assert stage.renderer.scenes[-1].tracked.frame.index == 2


@pytest.mark.parametrize("kind", ["is_photo", "has_ended"])
def test_the_limit_counts_how_often_a_last_frame_is_drawn(stage, kind):
    setattr(stage.pipeline, kind, True)
    stage.run(None, lambda: stage.put(0), *[None] * 5, lambda: pytest.fail("still running"), frame_limit=3)
    assert sum(scene.tracked is not None for scene in stage.renderer.scenes) == 3


@pytest.mark.parametrize("every", [1, 3, 50])
def test_the_limit_is_the_number_of_frames_that_are_recorded(stage, tmp_path, every):
    """Also of a source that comes late, whose last frame is recorded once more meanwhile."""
    stage.put(0)
    steps = [lambda at=at: stage.put(at) if at % every == 0 else None for at in range(1, 400)]
    stage.run(*steps, frame_limit=20, recording=Recording(tmp_path / "a.mp4", (64, 48), 100.0))
    with ClipSource(tmp_path / "a.mp4") as clip:
        assert len(list(clip)) == 20


def test_commands_reach_pipeline_and_window(stage):
    stage.put(0)
    stage.run(Command.PAUSE, Command.PAUSE, Command.RESTART, Command.FULLSCREEN, None)
    assert stage.pipeline.paused == [True, False]
    assert (stage.pipeline.restarts, stage.window.fullscreen) == (1, 1)


def test_what_is_known_of_the_light_and_the_caster_holds_for_every_quality(stage):
    ball = Caster.sphere(0.03)
    stage.session.watch.preset = FAST.light.assuming("sun", ball)
    stage.put(0)
    viewer = stage.run(Command.QUALITY, None, quality="fast")
    assert viewer._quality.name == "balanced"
    assert stage.session.watch.preset == BALANCED.light.assuming("sun", ball)


def test_quality_goes_round(stage):
    shown = []
    viewer = None

    def look() -> None:
        shown.append(stage.renderer.preset)

    stage.put(0)
    viewer = stage.run(look, Command.QUALITY, None, look, Command.QUALITY, None, look, quality="fast")
    assert shown[0] is FAST.render
    assert len(set(map(id, shown))) == 3
    assert viewer._quality.name == "accurate"


def test_snapshots_have_the_videos_size(stage, tmp_path):
    stage.put(0)
    stage.run(Command.SNAPSHOT, None, Command.SNAPSHOT, None)
    assert len(list(tmp_path.glob("*.png"))) == 2


@pytest.mark.parametrize("is_photo", [False, True])
def test_the_table_of_a_photo_without_a_second_frame_is_not_taken_for_the_empty_one(stage, is_photo):
    stage.pipeline.is_photo = is_photo
    stage.put(0)
    stage.run(None, Command.EMPTY_TABLE, None)
    assert (stage.session.watch.empty_table.frame is None) is is_photo
    assert ("a photo" in stage.session.notice.text) is is_photo


def test_recording_goes_on_while_paused_and_ends_by_the_same_key(stage, tmp_path, capfd):
    stage.put(0)
    steps = [Command.RECORD, *[None] * 60, Command.RECORD, None]
    stage.run(*steps)
    (path,) = tmp_path.glob("*.mp4")
    with ClipSource(path) as clip:
        assert len(list(clip)) > 2
    assert capfd.readouterr().out.startswith("saved ")


def test_that_it_records_is_shown_as_long_as_it_does(stage, monkeypatch):
    shown, scene = [], Display.scene

    def spy(display, session, screen, readings, now_s):
        shown.append("recording" in readings.quality)
        return scene(display, session, screen, readings, now_s)

    monkeypatch.setattr(Display, "scene", spy)
    stage.put(0)
    stage.run(None, Command.RECORD, *[None] * 20, Command.RECORD, None, None)
    first, last = shown.index(True), len(shown) - 1 - shown[::-1].index(True)
    assert 0 < first < last < len(shown) - 1
    assert all(shown[first : last + 1])


@pytest.mark.parametrize("error", [SystemExit(143), KeyboardInterrupt(), RuntimeError("a bug")])
def test_whatever_ends_it_a_recording_is_finished(stage, tmp_path, error):
    stage.put(0)

    def end() -> None:
        raise error

    with pytest.raises(type(error)):
        stage.run(Command.RECORD, None, lambda: stage.put(1), None, end)
    (path,) = tmp_path.iterdir()
    with ClipSource(path) as clip:
        assert clip.read() is not None


def test_whatever_fails_at_the_end_the_source_is_closed(stage, monkeypatch):
    def fail(*_):
        raise UserError("cannot write to standard output (No space left)", "choose a place that has space left")

    monkeypatch.setattr(keeping.Keeper, "finish", fail)
    stage.put(0)
    with pytest.raises(UserError, match="standard output"):
        stage.run(None)
    assert stage.pipeline.frames.is_closed


@pytest.mark.parametrize("last", [None, Command.LEAVE])
def test_closing_the_window_and_esc_finish_a_recording_too(stage, tmp_path, capfd, last):
    stage.put(0)
    stage.run(Command.RECORD, None, lambda: stage.put(1), None, last, *[None] * (last is not None))
    (path,) = tmp_path.iterdir()
    assert capfd.readouterr().out.startswith(f"saved {path} (")
    with ClipSource(path) as clip:
        assert clip.read() is not None


def test_a_picture_of_another_size_ends_the_recording(stage, tmp_path, capfd):
    stage.put(0)
    other = TrackedFrame(Frame(np.zeros((96, 128, 3), np.uint8), 0, 0.0), Camera.from_hfov((128, 96), 60), None)
    stage.run(Command.RECORD, None, lambda: stage.pipeline.frames.put(other), None, None)
    (path,) = tmp_path.iterdir()
    assert capfd.readouterr().out.startswith(f"saved {path} (")
    with ClipSource(path) as clip:
        assert clip.size == (64, 48)


class FullDisk(Recorder):
    """Full once the first two pictures are on it."""

    def write(self, image_bgr, time_s=None) -> None:
        if self.frame_count == 2:
            self._written.container.mux(self._stream.encode(None))
            self._save_and_raise(OSError(errno.ENOSPC, "No space left on device"))
        super().write(image_bgr, time_s)


def test_a_full_disk_ends_the_recording_but_not_the_viewer(stage, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(recording_module, "Recorder", FullDisk)
    stage.put(0)
    steps = [lambda index=index: stage.put(index) for index in range(1, 90)]
    stage.run(Command.RECORD, *steps)
    assert len(stage.renderer.scenes) == 91, "it went on to the script's end"
    out = capfd.readouterr().out
    assert out.count("No space left") == out.count("first part of the recording is saved") == out.count("\n") == 1
    (path,) = tmp_path.iterdir()
    assert str(path) in out
    with ClipSource(path) as clip:
        assert clip.read() is not None
    assert "No space left" in stage.session.notice.text


@pytest.fixture
def with_gaps(monkeypatch) -> None:
    """Recordings lack pictures, as on a slow machine, however fast this one is."""
    monkeypatch.setattr(Recording, "has_gaps", True)


@pytest.mark.usefixtures("with_gaps")
def test_what_plays_every_frame_names_the_clip_as_it_was_named(stage):
    """Also from another folder than the clip's, and ready for a shell."""
    stage.put(0)
    stage.run(Command.RECORD, None, lambda: stage.put(1), None, lambda: stage.put(5), None, Command.RECORD, None)
    said = "; all frames of the clip: ashe-live play 'my films/table.mp4' --model cube --headless"
    assert said in stage.session.notice.text


@pytest.mark.usefixtures("with_gaps")
@pytest.mark.parametrize("is_dropped", [False, True])
def test_what_plays_every_frame_counts_none_of_another_clip(stage, is_dropped):
    """The frame in which the light is estimated first is one of the clip that was named at the start."""
    pipeline = stage.dropped if is_dropped else stage.pipeline
    pipeline.frames.put(stage.fakes.tracked(0))
    opened = [dropped("/far/sun.mp4"), sun_awaited(stage)] if is_dropped else [None]
    put = [lambda index=index: pipeline.frames.put(stage.fakes.tracked(index)) for index in (1, 5)]
    recorded = [Command.RECORD, None, put[0], None, put[1], None, Command.RECORD, None]
    stage.run(*opened, *recorded, flags=("--estimate-at=40", "--light=sun"))
    assert "--light=sun" in stage.session.notice.text
    assert ("--estimate-at=40" in stage.session.notice.text) != is_dropped


@pytest.mark.usefixtures("with_gaps")
@pytest.mark.parametrize("is_watched", [False, True])
def test_what_plays_every_frame_watches_the_light_as_it_was_watched(stage, is_watched):
    stage.put(0)
    watching = [Command.AUTOMATIC, None] if is_watched else []
    put = [lambda index=index: stage.put(index) for index in (1, 5)]
    stage.run(None, *watching, Command.RECORD, None, put[0], None, put[1], None, Command.RECORD, None)
    assert ("--auto " in stage.session.notice.text) == is_watched


def test_a_recording_that_found_no_room_says_that_alone(stage, tmp_path, monkeypatch):
    monkeypatch.setattr(recording_module, "Recorder", FullDisk)
    stage.put(0)
    monkeypatch.setattr(recording_module.Recording, "has_gaps", True)
    stage.run(Command.RECORD, *[lambda index=index: stage.put(index) for index in range(1, 90)])
    assert "No space left" in stage.session.notice.text
    assert "all frames" not in stage.session.notice.text
    assert len(list(tmp_path.iterdir())) == 1  # the recording, and no file for a command


def test_a_graphics_driver_that_fails_ends_it_in_one_line_with_the_recording_finished(stage, tmp_path):
    stage.put(0)

    def lose_context() -> None:
        def render(_scene, **_how) -> None:
            raise moderngl.Error("GL_CONTEXT_LOST")

        stage.renderer.render = render

    steps = [lambda index=index: stage.put(index) for index in range(1, 9)]
    with (
        pytest.raises(UserError, match=r"the graphics driver failed \(GL_CONTEXT_LOST\)"),
        graphics_failures_reported(),
    ):
        stage.run(Command.RECORD, *steps, lose_context, lambda: pytest.fail("still running"))
    (path,) = tmp_path.iterdir()
    with ClipSource(path) as clip:
        assert clip.read() is not None


def test_a_snapshot_carries_the_estimate(stage, tmp_path, capfd):
    stage.put(4)
    stage.session.answer = NewAnswer(stage.fakes.estimate(2), stage.fakes.tracked(2), 0.0, None, True)
    stage.run(Command.SNAPSHOT, None)
    (path,) = tmp_path.glob("*.png")
    with PIL.Image.open(path) as picture:
        carried = json.loads(picture.text["ashe-live"])
    assert (carried["frame"], carried["estimate"]["frame"], carried["model"]) == (4, 2, "cube")
    assert carried["estimate"]["light"]["elevation_deg"] == pytest.approx(45)
    assert capfd.readouterr().out == f"saved {path}\n"
    assert str(path) in stage.session.notice.text


def test_what_covers_the_marker_is_cut_out_with_the_shadow_and_not_with_a_model_alone(stage, monkeypatch):
    cut_out, said = stage.fakes.Renderer(), []
    monkeypatch.setattr(stage.renderer, "beside", lambda _size: cut_out)

    def listen() -> None:
        said.append(stage.session.notice.text)

    stage.put(0)
    once = (Command.CUT_OUT, listen)
    stage.run(
        None, Command.TOGGLE_LIGHT, *once, Command.BEFORE_AFTER, *once, Command.RESET, Command.COVER_MARKER, *once
    )
    assert [scene.shows_cover for scene in cut_out.scenes] == [True, False, False]
    assert [scene.casts_shadow for scene in cut_out.scenes] == [True, False, True]
    assert not any(scene.shows_light for scene in cut_out.scenes)
    assert ["ground over the marker" in text for text in said] == [True, False, False]
    assert all(cut_out.waited)
    assert not any(stage.renderer.waited)


def test_a_picture_of_nothing_is_not_saved_as_model_and_shadow(stage, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stage.put(0)
    stage.run(None, *3 * (Command.BEFORE_AFTER,), Command.CUT_OUT)
    assert stage.session.view.parts is ShownParts.VIDEO_ALONE
    assert "neither model nor shadow is shown" in stage.session.notice.text
    assert list(tmp_path.iterdir()) == []


def test_where_nothing_can_be_written_it_says_so_and_goes_on(stage, tmp_path, monkeypatch):
    monkeypatch.setattr(
        keeping, "unused_name", lambda _folder, _stem, suffix, _at: tmp_path / "missing" / f"name{suffix}"
    )
    stage.put(0)
    for command in (Command.SNAPSHOT, Command.RECORD):
        stage.run(command, None, None)
        assert "no folder" in stage.session.notice.text


def test_where_the_current_folder_is_gone_it_says_so_and_goes_on(stage, tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    stage.put(0)
    stage.session.hand.light = stage.fakes.estimate(0).illumination
    for command in (Command.SNAPSHOT, Command.KEEP_LIGHT, Command.RECORD):
        stage.session.notice.text = None
        stage.run(command, None, None)
        assert "has been deleted" in stage.session.notice.text


def dropped(*paths: str) -> Request:
    return Request(Command.OPEN, Files(paths))


def awaited(stage, condition, then: Command | None = None):
    """A step that comes again until the condition holds."""
    begin_s = time.monotonic()

    def step():
        if not condition() and time.monotonic() - begin_s < PATIENCE_S:
            stage.window.steps.insert(0, step)
            return None
        assert condition()
        return then

    return step


def sun_awaited(stage):
    return awaited(stage, lambda: stage.window.title == "ashe-live: sun.mp4")


def settled_awaited(stage, counts: list[int]):
    """Until nothing is drawn for five pictures; `counts` has how many scenes were, picture by picture."""

    def is_settled() -> bool:
        counts.append(len(stage.renderer.scenes))
        return counts[-5:].count(counts[-1]) == 5

    return awaited(stage, is_settled)


def test_a_dropped_clip_replaces_source_tracker_and_light_and_ends_the_recording(stage, tmp_path, capfd):
    stage.put(5)
    stage.dropped.frames.put(stage.fakes.tracked(0))
    stage.session.worker.answer = stage.fakes.estimate()
    viewer = stage.run(
        *(Command.ESTIMATE, None, None, Command.RECORD, None, None, None, dropped("/far/sun.mp4")),
        sun_awaited(stage),
        None,
    )
    assert stage.pipeline.frames.is_closed
    assert stage.session.tracked.frame.index == 0
    assert stage.session.estimate is None
    assert viewer._source.pipeline is stage.dropped
    assert stage.dropped.tracking is FAST.tracking
    (begun,) = stage.renderer.begun_after
    assert [scene.tracked.frame.index for scene in stage.renderer.scenes[begun - 1 : begun + 1]] == [5, 0]
    assert len(list(tmp_path.glob("*.mp4"))) == 1
    assert "saved" in capfd.readouterr().out
    assert stage.dropped.frames.is_closed  # when the viewer ends


def test_views_that_a_dropped_clip_has_shown_by_then_stay(stage):
    stage.put(5)
    first = paint(BOX).tracked
    assert stage.dropped.key_views.add(first)
    stage.dropped.frames.put(first)
    stage.run(dropped("/far/sun.mp4"), sun_awaited(stage), None)
    assert stage.session.watch.key_views is stage.dropped.key_views
    assert [view.frame.index for view in stage.dropped.key_views.views] == [first.frame.index]


def test_what_cannot_be_opened_is_one_line_and_changes_nothing(stage, capfd):
    stage.put(5)

    def is_said() -> bool:
        return "is not a clip" in (stage.session.notice.text or "")

    viewer = stage.run(Command.RECORD, None, dropped("/far/notes.txt"), awaited(stage, is_said), None)
    assert viewer._source.pipeline is stage.pipeline
    assert stage.session.tracked.frame.index == 5
    refused, saved = capfd.readouterr().out.splitlines()
    assert "is not a clip" in refused
    assert saved.startswith("saved")  # the recording went on to the end


def test_what_was_copied_opens_by_a_key(stage, monkeypatch):
    stage.put(5)
    stage.run(Command.OPEN, None)
    assert "nothing to open" in stage.session.notice.text
    monkeypatch.setattr(ScriptedWindow, "clipboard", "file:///far/chair.obj")
    stage.run(Command.OPEN, None)
    assert stage.session.table.model_name == "chair.obj"


def test_a_dropped_model_is_chosen_and_the_source_stays(stage):
    stage.put(5)
    viewer = stage.run(dropped("/far/wood.png", "/far/chair.obj"), None, None)
    assert stage.session.table.model_name == "chair.obj"
    assert viewer._source.pipeline is stage.pipeline


def test_of_several_dropped_files_no_model_is_lost_and_the_first_clip_is_opened(stage):
    stage.put(5)
    stage.dropped.frames.put(stage.fakes.tracked(0))
    before = len(stage.session.table.shelf.names)
    stage.run(dropped("/far/chair.obj", "/far/table.glb", "/far/chair.obj", "/far/lamp.stl"), None)
    assert stage.session.table.model_name == "chair.obj"
    assert stage.session.table.shelf.names[before:] == ["/far/chair.obj", "/far/table.glb", "/far/lamp.stl"]
    assert "3 models joined" in stage.session.notice.text
    stage.run(Command.NEXT_MODEL, None)
    assert stage.session.table.model_name == "table.glb"
    stage.run(dropped("/far/sun.mp4", "/far/moon.mp4"), sun_awaited(stage), None)
    assert "of 2 clips and photos the first" in stage.session.notice.text


def test_escape_leaves_what_was_entered_last(stage):
    def is_help_closed() -> None:
        assert not stage.session.view.help.is_shown

    stage.run(
        Command.FULLSCREEN,
        Command.HELP,
        Command.LEAVE,
        is_help_closed,
        Command.LEAVE,
        lambda: None if not stage.window.is_fullscreen else pytest.fail("still fullscreen"),
        Command.LEAVE,
        None,
        lambda: pytest.fail("still running"),
    )


@pytest.fixture
def others(stage, monkeypatch) -> list[str]:
    """Which markers are seen in every frame without the one that is followed."""
    seen = ["aruco:4x4_50:7"]
    monkeypatch.setattr(marker_hunt, "seen_instead", lambda _image: SeenInstead(tuple(seen)))
    monkeypatch.setattr(marker_hunt, "EVERY_S", 0.0)
    stage.pipeline.may_follow_others = True
    return seen


@pytest.mark.parametrize("takes_any_marker", [True, False])
def test_the_one_marker_in_view_is_followed_where_nobody_named_any(stage, others, takes_any_marker):
    stage.pipeline.frames.put(stage.fakes.tracked(0, has_marker=False))
    steps = [awaited(stage, lambda: stage.pipeline.followed)] if takes_any_marker else []
    if not takes_any_marker:
        seen = awaited(stage, lambda: stage.session.seen_instead.in_view == tuple(others), Command.FOLLOW_OTHER)
        steps = [seen, None, lambda: None]
    stage.run(*steps, takes_any_marker=takes_any_marker)
    assert stage.pipeline.followed == others


def test_a_marker_with_a_model_of_its_own_is_not_followed_beside_one_without(stage, others):
    others[:] = ["aruco:4x4_50:3", "aruco:4x4_50:5"]
    choice = (ChosenModel("mug", "aruco:4x4_50:3"),)
    shelf = Shelf("tree", 0.08, others=["mug"])
    stage.session = Session(shelf, stage.fakes.Worker(), FirstEstimate(), others=choice)
    stage.pipeline.frames.put(stage.fakes.tracked(0, has_marker=False))
    stage.run(awaited(stage, lambda: stage.pipeline.followed), takes_any_marker=True)
    assert stage.pipeline.followed == ["aruco:4x4_50:5"]
    assert stage.session.arrangement.followed == "aruco:4x4_50:5"


def test_a_marker_is_followed_once_though_it_is_not_tracked_at_once(stage, others, capfd):
    stage.pipeline.frames.put(stage.fakes.tracked(0, has_marker=False))
    seen_again = awaited(stage, lambda: stage.pipeline.followed and stage.session.seen_instead.in_view)
    stage.run(
        awaited(stage, lambda: stage.pipeline.followed),
        seen_again,
        None,
        Command.FOLLOW_OTHER,
        None,
        takes_any_marker=True,
    )
    assert stage.pipeline.followed == others
    assert capfd.readouterr().out.count("is followed now") == 1


def test_of_several_markers_a_person_chooses(stage, others):
    others.append("apriltag:36h11:3")
    stage.pipeline.frames.put(stage.fakes.tracked(0, has_marker=False))
    stage.run(awaited(stage, lambda: len(stage.session.seen_instead.in_view) == 2), None, takes_any_marker=True)
    assert stage.pipeline.followed == []
    said = " ".join(guidance(stage.session))
    assert "aruco:4x4_50:7 and apriltag:36h11:3 are in view" in said


def test_asked_for_another_marker_it_goes_round_those_in_view(stage, others):
    others[:] = ["aruco:4x4_50:7", "aruco:4x4_50:0", "aruco:4x4_50:3"]
    stage.put(0)

    steps = []
    for count in (1, 2, 3):
        followed = awaited(stage, lambda count=count: len(stage.pipeline.followed) == count)
        steps += [None, Command.FOLLOW_OTHER, followed, lambda count=count: stage.put(count)]
    stage.run(*steps)
    assert stage.pipeline.followed == ["aruco:4x4_50:3", "aruco:4x4_50:7", "aruco:4x4_50:0"]


def test_the_field_of_view_goes_round_and_cameras_that_are_not_there_are_said(stage, capfd):
    stage.pipeline.may_follow_others = True
    stage.put(0)
    stage.run(
        None,
        *[Command.FIELD_OF_VIEW] * 6,
        None,
        Command.NEXT_CAMERA,
        awaited(stage, lambda: "no other camera" in stage.session.notice.text),
    )
    assert stage.pipeline.seen_by == [50, 60, 70, 80, None, 50]
    assert "--hfov 70" in capfd.readouterr().out


@pytest.mark.usefixtures("others")
@pytest.mark.parametrize("command", [Command.FOLLOW_OTHER, Command.FIELD_OF_VIEW])
def test_no_picture_of_another_marker_or_camera_has_anything_of_the_one_before(stage, command):
    drawn_before = []

    def begin() -> Command:
        drawn_before.append(len(stage.renderer.scenes))
        return command

    stage.put(0)
    stage.run(None, begin, awaited(stage, lambda: stage.pipeline.followed or stage.pipeline.seen_by), None)
    (begun,) = stage.renderer.begun_after
    shown = [scene.tracked for scene in stage.renderer.scenes]
    assert drawn_before[0] <= begun
    assert all(tracked is not None for tracked in shown[1:begun])
    assert shown[begun] is None


def test_of_an_upright_picture_fields_of_view_count_along_its_height(stage):
    stage.pipeline.may_follow_others = True
    upright = np.zeros((96, 54, 3), np.uint8)
    stage.pipeline.frames.put(TrackedFrame(Frame(upright, 0, 0.0), Camera.assumed((54, 96)), None))
    viewer = stage.run(None, Command.FIELD_OF_VIEW, Command.FIELD_OF_VIEW, None)
    for high_deg, wide_deg in zip((50, 60), stage.pipeline.seen_by, strict=True):
        high = math.tan(math.radians(high_deg) / 2)
        assert wide_deg == round(math.degrees(2 * math.atan(high * 54 / 96)))
    assert viewer.followed.flags([])[-1] == f"--hfov={stage.pipeline.seen_by[-1]:g}"


@pytest.mark.usefixtures("others")
def test_no_other_is_looked_for_while_the_marker_is_there(stage):
    stage.put(0)
    stage.run(*[None] * 6, takes_any_marker=True)
    assert stage.session.seen_instead.in_view == ()
    assert stage.pipeline.followed == []


def test_that_no_other_marker_is_in_view_is_said(stage, others):
    others[:] = ["aruco:4x4_50:0"]
    stage.put(0)
    told = awaited(stage, lambda: "no other marker" in (stage.session.notice.text or ""))
    stage.run(None, Command.FOLLOW_OTHER, told, takes_any_marker=True)
    assert stage.pipeline.followed == []


def test_the_light_is_saved_for_other_programs(stage, tmp_path):
    stage.put(0)
    stage.session.worker.answer = stage.fakes.estimate()
    stage.run(None, Command.KEEP_LIGHT, Command.ESTIMATE, None, Command.KEEP_LIGHT, None)
    (sky,), (record,) = tmp_path.glob("*.hdr"), tmp_path.glob("*.json")
    assert sky.read_bytes().startswith(b"#?RADIANCE")
    light = json.loads(record.read_text())["estimate"]["light"]
    assert light["to_light_marker"] == pytest.approx([0.5**0.5, 0, 0.5**0.5])


def test_the_light_is_saved_whatever_else_has_its_name(stage, tmp_path, monkeypatch):
    """As the file of a recording that ended in the same second."""
    (tmp_path / "a.json").write_text("mine")
    monkeypatch.setattr(keeping, "unused_name", lambda *_: tmp_path / "a.hdr")
    stage.put(0)
    stage.session.worker.answer = stage.fakes.estimate()
    stage.run(None, Command.ESTIMATE, None, Command.KEEP_LIGHT, None)
    assert (tmp_path / "a.json").read_text() == "mine"
    assert "estimate" in json.loads((tmp_path / "a-2.json").read_text())


def test_what_does_not_change_is_not_drawn_again(stage):
    counts: list[int] = []
    stage.put(0)
    stage.run(settled_awaited(stage, counts), lambda: stage.put(1), None, None, None)
    assert counts[-1] > HELD_AFTER_PICTURES
    assert len(stage.renderer.scenes) > counts[-1]


def test_only_pictures_that_are_drawn_tell_which_quality_the_machine_can_afford(stage, monkeypatch):
    drawn: list[int] = []
    monkeypatch.setattr(QualityChoice, "adapt", lambda *_: drawn.append(len(stage.renderer.scenes)))
    stage.put(0)
    stage.run(settled_awaited(stage, []), None, quality="auto")
    assert len(drawn) >= HELD_AFTER_PICTURES
    assert len(set(drawn)) == len(drawn)


def test_the_menu_does_what_its_row_says(stage):
    stage.put(0)

    def first_row() -> MouseEvent:
        overlay = stage.renderer.scenes[-1].overlays[-1]
        return MouseEvent(MouseAction.PRESSED, overlay.left_px + 5.0, overlay.top_px + 6.0)

    stage.session.table.shelf.at = 2
    stage.run(None, MouseEvent(MouseAction.MENU, 1.0, 1.0), None, first_row, None)
    assert stage.session.table.model_name == "cube"


def test_escape_closes_the_menu_before_it_leaves(stage):
    stage.put(0)
    still_running = []
    opening = MouseEvent(MouseAction.MENU, 1.0, 1.0)
    stage.run(None, opening, None, Command.LEAVE, lambda: still_running.append(True), Command.LEAVE, None, pytest.fail)
    assert still_running


def test_escape_is_not_spent_on_a_menu_that_has_gone_with_the_windows_size(stage):
    stage.put(0)

    def resize() -> None:
        stage.window.screen = Screen((80, 60))

    stage.run(None, MouseEvent(MouseAction.MENU, 1.0, 1.0), None, resize, None, Command.LEAVE, None, pytest.fail)
    assert stage.window.steps


def test_ctrl_z_takes_back_what_was_done_by_hand(stage):
    stage.put(0)
    stage.run(None, Request(Command.SCALE_MODEL, 1), Command.UNDO, None, Command.UNDO, None)
    assert stage.session.hand.placement.scale == 1
    assert "nothing was done" in stage.session.notice.text
