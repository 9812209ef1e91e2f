"""What a window for pictures shows, drawn for real, and how the calibration's one is worked by its keys."""

from collections.abc import Iterator

import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.types import Frame
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.hud import HudText
from ashe_live.render.screen import Screen
from ashe_live.tracking.boards.calibration_guide import CalibrationGuide
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.windows import picture_window
from ashe_live.viewer.windows.calibration_window import CalibrationWindow, progress_lines
from ashe_live.viewer.windows.picture_window import PictureWindow
from tests.viewer.scripted_window import ScriptedWindow

RED, BLUE = (0, 0, 255), (255, 0, 0)


class Window(ScriptedWindow):
    """In the place of GLFW's; keeps the pictures that it has shown."""

    def __init__(self, title: str, size: tuple[int, int]) -> None:
        super().__init__([lambda: None] * 99)
        self.title, self.screen = title, Screen(size)
        self.context = offscreen_context()
        self.shown: list[Image] = []
        self.is_closed = False

    def swap(self) -> None:
        super().swap()
        self.shown.append(self.presented.read_bgr())

    def close(self) -> None:
        self.is_closed = True
        self.context.release()


@pytest.fixture(autouse=True)
def _window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_window, "GlfwWindow", Window)


@pytest.fixture
def pictures() -> Iterator[PictureWindow]:
    with PictureWindow("ashe-live: test", (64, 48)) as pictures:
        yield pictures
    assert pictures.window.is_closed


def test_a_picture_fills_the_window_of_whatever_size_that_is_by_now(pictures: PictureWindow) -> None:
    for size in ((64, 48), (128, 96)):
        pictures.window.screen = Screen(size)
        pictures.show(np.full((48, 64, 3), RED, np.uint8), HudText())
        assert pictures.window.shown[-1].shape == (size[1], size[0], 3)
        assert (pictures.window.shown[-1] == RED).all()


def test_text_lies_over_the_picture_where_it_has_room(pictures: PictureWindow) -> None:
    pictures.window.screen = Screen((400, 300))
    for free in ((None, None), (120, None), (None, 60)):
        pictures.show(np.full((300, 400, 3), BLUE, np.uint8), HudText(hint=("some words and some more " * 2,)), *free)
    whole, narrow, low = (np.argwhere((picture != BLUE).any(axis=2)) for picture in pictures.window.shown)
    assert whole.max(axis=0)[1] > 120 > narrow.max(axis=0)[1]
    assert low.min(axis=0)[0] > 300 - 60 > narrow.min(axis=0)[0]


class Calibration:
    """The calibration's window, in which grey frames without a board are shown."""

    def __init__(self, shown_in: CalibrationWindow) -> None:
        self._shown_in = shown_in
        self.window: Window = shown_in._pictures.window
        self._frame = Frame(np.full((240, 320, 3), 200, np.uint8), 0, 0.0)

    def goes_on(self, pressed: Command | None = None, said: str | None = None) -> bool:
        self.window.steps[0] = lambda: pressed
        return self._shown_in.show(self._frame, None, CalibrationGuide((320, 240)), said)


@pytest.fixture
def calibration() -> Iterator[Calibration]:
    with CalibrationWindow("camera 0", (320, 240)) as shown_in:
        yield Calibration(shown_in)
    assert shown_in._pictures.window.is_closed


def test_the_calibration_goes_on_until_esc_or_until_its_window_is_closed(calibration: Calibration) -> None:
    assert calibration.window.title == "ashe-live: calibrate camera 0"
    assert calibration.goes_on()
    assert calibration.goes_on(Command.HELP)
    assert not calibration.goes_on(Command.LEAVE)
    calibration.window.is_closing = True
    assert not calibration.goes_on()


def test_the_calibration_says_how_far_it_is_and_what_it_was_told(
    calibration: Calibration, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts: list[HudText] = []
    monkeypatch.setattr(PictureWindow, "show", lambda _self, _picture, text: texts.append(text))
    for said in (None, "this view was blurred"):
        calibration.goes_on(said=said)
    without, told = texts
    assert without.status == told.status == progress_lines(None, CalibrationGuide((320, 240)))
    assert told.hint == ("this view was blurred", *without.hint)


def test_the_calibration_goes_on_while_its_window_is_minimised(calibration: Calibration) -> None:
    calibration.window.screen = Screen((0, 0))
    assert calibration.goes_on()
    assert calibration.window.shown == []
