"""What keys and mouse make of a clip, and why they make nothing of photos and cameras."""

import pytest

from ashe_live.render.screen import Screen
from ashe_live.viewer.drawn.time_bar import bar_at
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.hands.requests import Command, MouseAction, MouseEvent, Request
from ashe_live.viewer.playback import BAR_SHOWN_S, SPEEDS, Playback
from tests.viewer.scripted_session import ScriptedSession

SCREEN = Screen((640, 480))
OF_TIME = (Command.PAUSE, Command.RESTART, Command.STEP, Command.SEEK, Command.SPEED, Command.LOOP)


class NotingPipeline:
    """Notes what it is told."""

    def __init__(self, is_clip: bool = True, is_photo: bool = False) -> None:
        self.is_clip, self.is_photo, self.has_ended = is_clip, is_photo, False
        self.duration_s = 10.0 if is_clip else None
        self.told: list[tuple] = []

    def __getattr__(self, name: str):
        return lambda *arguments: self.told.append((name, *arguments))


class Stage:
    def __init__(self, fakes, **kind: bool) -> None:
        self.pipeline = NotingPipeline(**kind)
        self.session = ScriptedSession(fakes, FirstEstimate())
        self.playback = Playback(self.pipeline, self.session)
        self.shown = fakes.tracked(30)
        self.bar = bar_at(SCREEN, self.pipeline.duration_s or 0.0)

    def ask(self, command: Command, argument: int = 0) -> list[tuple]:
        self.pipeline.told.clear()
        assert self.playback.handle(Request(command, argument), 0.0)
        return self.pipeline.told

    def mouse(self, action: MouseAction, share: float, y_px: float = SCREEN.size[1] - 5, now_s: float = 0.0) -> bool:
        x_px = self.bar.left + share * (self.bar.right - self.bar.left)
        return self.playback.take_mouse(MouseEvent(action, x_px, y_px), SCREEN, now_s)

    def moment(self, now_s: float = 0.0):
        return self.playback.moment(self.shown, now_s)


@pytest.fixture
def stage(fakes) -> Stage:
    return Stage(fakes)


def test_keys_reach_the_pipeline(stage):
    assert stage.ask(Command.STEP, -1) == [("step", -1)]
    assert stage.ask(Command.SEEK, 5) == [("seek_by", 5)]
    assert stage.ask(Command.RESTART) == [("restart",)]
    assert stage.ask(Command.LOOP) == [("play", 1.0, True)]
    assert stage.ask(Command.LOOP) == [("play", 1.0, False)]
    assert not stage.playback.handle(Request(Command.LEAVE), 0.0)


def test_speeds_go_from_a_quarter_to_four_and_stay_there(stage):
    told = [stage.ask(Command.SPEED, 1)[0][1] for _ in range(4)]
    assert told == [2.0, 4.0, 4.0, 4.0]
    told = [stage.ask(Command.SPEED, -1)[0][1] for _ in range(6)]
    assert told == [2.0, 1.0, 0.5, 0.25, 0.25, 0.25]
    assert (SPEEDS[0], SPEEDS[-1]) == (0.25, 4.0)


def test_a_speed_that_is_not_the_clips_own_is_shown(stage):
    assert stage.playback.pace_shown == ""
    stage.ask(Command.SPEED, -1)
    assert stage.playback.pace_shown == "0.5x"


def test_a_pause_is_shown_as_long_as_it_lasts(stage):
    stage.ask(Command.PAUSE)
    assert stage.playback.pace_shown == "paused"
    stage.ask(Command.PAUSE)
    assert stage.playback.pace_shown == ""


def test_p_goes_on_after_a_step(stage):
    stage.ask(Command.STEP, 1)
    assert stage.ask(Command.PAUSE) == [("pause", False)]
    assert stage.ask(Command.PAUSE) == [("pause", True)]


def test_p_at_the_end_starts_again(stage):
    stage.pipeline.has_ended = True
    assert stage.ask(Command.PAUSE) == [("restart",)]


def test_p_after_a_pause_at_the_end_goes_on(stage):
    """It was stepped there, or paused at its last frame: nothing was asked to begin again."""
    stage.ask(Command.PAUSE)
    stage.pipeline.has_ended = True
    assert stage.ask(Command.PAUSE) == [("pause", False)]


@pytest.mark.parametrize("command", OF_TIME)
def test_photos_and_cameras_say_why_nothing_happens(fakes, command):
    for kind, why in (({"is_photo": True}, "a photo is one moment"), ({}, "a camera shows what is there now")):
        stage = Stage(fakes, is_clip=False, **kind)
        told = stage.ask(command, 1)
        assert stage.moment() is None
        assert not stage.mouse(MouseAction.PRESSED, 0.5)
        if kind or command is not Command.PAUSE:
            assert told == []
            assert stage.session.notice.text.startswith(why)
        else:
            assert told == [("pause", True)]


def test_the_bar_is_there_while_it_stands_still_or_the_pointer_is_near(stage):
    assert stage.moment() is None
    stage.mouse(MouseAction.MOVED, 0.5, y_px=100)
    assert stage.moment() is None
    stage.mouse(MouseAction.MOVED, 0.5)
    assert stage.moment().time_s == stage.shown.frame.time_s
    assert stage.moment().frame is None
    assert stage.moment(BAR_SHOWN_S + 0.1) is None
    stage.ask(Command.PAUSE)
    assert stage.moment(1e9).frame == 30
    assert stage.playback.moment(None, 0.0) is None, "there is no frame yet"


@pytest.mark.parametrize(("command", "argument"), [(Command.SEEK, -5), (Command.SPEED, 1), (Command.LOOP, 0)])
def test_what_a_key_changes_the_bar_shows_for_a_while(stage, command, argument):
    stage.ask(command, argument)
    assert stage.moment(BAR_SHOWN_S - 0.1) is not None
    assert stage.moment(BAR_SHOWN_S + 0.1) is None


def test_after_a_drag_the_bar_stays_for_a_while(stage):
    """However far from it the pointer was."""
    stage.mouse(MouseAction.PRESSED, 0.2)
    stage.mouse(MouseAction.MOVED, 0.5, y_px=-100, now_s=60.0)
    stage.mouse(MouseAction.RELEASED, 0.5, y_px=-100, now_s=60.1)
    assert stage.moment(60.0 + BAR_SHOWN_S - 0.1) is not None
    assert stage.moment(60.0 + BAR_SHOWN_S + 0.2) is None


def test_at_the_end_the_bar_stays_with_the_frames_number(stage):
    stage.pipeline.has_ended = True
    assert stage.moment(1e9).frame == 30


def test_what_a_key_has_changed_is_said(stage):
    said = []
    for command, argument in ((Command.PAUSE, 0), (Command.PAUSE, 0), (Command.LOOP, 0), (Command.LOOP, 0)):
        stage.ask(command, argument)
        said.append(stage.session.notice.text)
    assert said == ["paused: P goes on", "playing", "played again and again: O ends it", "played once"]
    stage.ask(Command.SPEED, -1)
    assert stage.session.notice.text == "speed 0.5x"


def test_a_press_on_the_bar_goes_there_and_dragging_on_and_on(stage):
    assert stage.mouse(MouseAction.PRESSED, 0.25)
    assert stage.moment().time_s == pytest.approx(2.5)
    assert stage.mouse(MouseAction.MOVED, 0.5, y_px=-100)  # also far above it
    assert stage.mouse(MouseAction.MOVED, 1.5)
    assert stage.mouse(MouseAction.RELEASED, 1.5)
    asked = [told[0] for told in stage.pipeline.told]
    assert asked == ["pause", "seek", "seek", "seek", "pause"]
    assert [told[1] for told in stage.pipeline.told] == pytest.approx([True, 2.5, 5.0, 10.0, False])
    assert not stage.mouse(MouseAction.MOVED, 0.5)


def test_a_paused_clip_stays_paused_after_a_drag(stage):
    stage.ask(Command.PAUSE)
    stage.mouse(MouseAction.PRESSED, 0.5)
    stage.mouse(MouseAction.RELEASED, 0.5)
    assert stage.pipeline.told[-1] == ("pause", True)


def test_a_clip_goes_on_after_a_drag_during_which_all_text_was_hidden(stage):
    stage.mouse(MouseAction.PRESSED, 0.5)
    stage.session.view.shows_hud = False
    assert stage.mouse(MouseAction.RELEASED, 0.5)
    assert stage.pipeline.told[-1] == ("pause", False)
    stage.session.view.shows_hud = True
    assert not stage.mouse(MouseAction.MOVED, 0.9)


def test_what_is_not_the_bars_is_left_to_others(stage):
    for action in (MouseAction.PRESSED, MouseAction.MOVED, MouseAction.RELEASED):
        assert not stage.mouse(action, 0.5, y_px=200)
    stage.session.view.shows_hud = False  # hidden, it takes nothing either
    assert not stage.mouse(MouseAction.PRESSED, 0.5)
    stage.session.view.shows_hud = True
    stage.session.view.handle(Command.HELP, None, 0.0)
    assert not stage.mouse(MouseAction.PRESSED, 0.5)
    assert stage.pipeline.told == []
