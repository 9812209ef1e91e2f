"""The marker on a screen."""

import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.types import Frame
from ashe_live.quality import BALANCED
from ashe_live.render.hud import FONT_PT, Hud
from ashe_live.render.screen import Screen
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.windows import marker_window
from ashe_live.viewer.windows.marker_window import on_white, room_beside, show_marker
from tests.viewer.scripted_window import ScriptedWindow


@pytest.mark.parametrize("size", [(720, 720), (1920, 1080), (300, 500)])
def test_the_tracker_finds_it_in_a_window_of_any_shape(size):
    marker = parse_marker("aruco:4x4_50:3")
    picture = on_white(marker.bitmap(960), size)
    tracker = MarkerTracker(marker, Camera.from_hfov(size, 60), 0.08, BALANCED.tracking)
    tracked = tracker.track(Frame(picture, 0, 0.0))
    assert picture.shape == (size[1], size[0], 3)
    assert tracked.marker is not None
    assert tracked.marker.corners_px.mean(axis=0) == pytest.approx(((size[0] - 1) / 2, (size[1] - 1) / 2), abs=1)


@pytest.mark.parametrize(("size", "has_room"), [((1200, 300), True), ((1920, 600), True), ((720, 720), False)])
def test_text_beside_it_leaves_its_margin_white(size, has_room):
    room = room_beside(size)
    assert (room is not None) is has_room
    inked = np.flatnonzero((on_white(np.zeros((100, 100), np.uint8), size) < 255).any(axis=(0, 2)))
    assert room is None or room < inked[0] - 0.1 * (inked[-1] - inked[0])


class Window(ScriptedWindow):
    """Keys that are pressed one after the other."""

    def take_requests(self, _wait_s):
        self.swap()
        return super().take_requests(0.0)


@pytest.fixture
def shown(monkeypatch):
    """Shows a marker in a window of some size while keys are pressed; returns the window, and picture by picture."""

    def shown(screen, commands, spec="aruco:4x4_50:3", flags=()):
        window = Window([lambda each=each: each for each in commands])
        window.screen = screen
        pictures = []

        class Pictures:
            def __init__(self, *_):
                self.window = window

            def show(self, picture_bgr, *text):
                pictures.append((picture_bgr, *text))

            def __enter__(self):
                return self

            def __exit__(self, *_): ...

        monkeypatch.setattr(marker_window, "PictureWindow", Pictures)
        show_marker(spec, parse_marker(spec).bitmap(480), flags)
        return window, pictures

    return shown


LONG = "--marker", "image:/home/maria/pictures/of the house/and of the garden/the sign above the door as it was.png"


@pytest.mark.parametrize("flags", [(), LONG], ids=["short", "long"])
@pytest.mark.parametrize("size", [(720, 720), (1440, 1440), (500, 500), (300, 500), (800, 600), (1920, 600)])
def test_what_explains_it_leaves_white_around_it(shown, size, flags):
    """A dark plate that touches it would end its outline there."""
    screen = Screen(size, 2.0 if size[0] == 1440 else 1.0)
    _, ((picture, *text), *_) = shown(screen, [None, None], flags=flags)
    (plate,) = Hud().overlays(text[0], screen, *text[1:])
    (width, height), marker = plate.shown_size, parse_marker("aruco:4x4_50:3")
    if not flags and size[0] >= 720:
        assert height > 2 * 1.3 * screen.px(FONT_PT), "as large as all text is"
    covered = picture[plate.top_px : plate.top_px + height, plate.left_px : plate.left_px + width]
    assert covered.shape == (height, width, 3)
    assert (covered == 255).all()
    covered[:] = plate.image_rgba[0, width // 2, :3]
    tracker = MarkerTracker(marker, Camera.from_hfov(size, 60), 0.08, BALANCED.tracking)
    assert tracker.track(Frame(picture, 0, 0.0)).marker is not None


def test_keys_hide_what_explains_it_fill_the_screen_and_end_it(shown):
    window, pictures = shown(
        Screen((720, 720)), [None, Command.TOGGLE_HUD, Command.TOGGLE_HUD, Command.FULLSCREEN, Command.LEAVE, None]
    )
    assert [bool(text.hint) for _, text, *_ in pictures] == [True, False, True, True]
    assert window.fullscreen == 1
    assert not window.is_closing, "it has ended before"


def test_in_a_minimised_window_nothing_is_drawn_until_it_comes_back(shown):
    assert shown(Screen((0, 0)), [None, None])[1] == []


@pytest.mark.parametrize(
    ("size", "beside"),
    [((720, 720), None), ((800, 600), None), ((1300, 600), None), ((1340, 600), 370), ((600, 1920), None)],
)
def test_what_explains_it_stands_beside_it_only_where_lines_have_room(size, beside):
    """Of 0.6 of the height: in less they would be many, or their letters small."""
    assert room_beside(size) == beside
