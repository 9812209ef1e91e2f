"""The window on the screen, with a stand-in for GLFW: what it makes of events, monitors and failures."""

import os
from types import SimpleNamespace
from typing import Any

import glfw
import pytest

from ashe_live.core.camera import Size
from ashe_live.errors import UserError
from ashe_live.viewer.hands.requests import Command, Files, MouseAction, MouseEvent, Request
from ashe_live.viewer.windows import glfw_window
from ashe_live.viewer.windows.glfw_window import GlfwWindow

PRIMARY, PROJECTOR = (0, 0, 1920, 1080, 60), (1920, 200, 1280, 720, 75)  # left, top, width, height, rate
LEFT, RIGHT, MIDDLE = glfw.MOUSE_BUTTON_LEFT, glfw.MOUSE_BUTTON_RIGHT, glfw.MOUSE_BUTTON_MIDDLE
MOVED, PRESSED, RELEASED = MouseAction.MOVED, MouseAction.PRESSED, MouseAction.RELEASED


class Glfw:
    """GLFW's constants, and a desktop with one window on it. `density`: pixels for each unit of the window."""

    def __init__(self) -> None:
        self.monitors = [PRIMARY, PROJECTOR]
        self.bar_px = 0  # of the primary monitor, at its bottom
        self.place, self.fills = (100, 50, 640, 480), None
        self.density, self.magnifies = 1, 1
        self.down: set[int] = set()
        self.starts = self.opens = True
        self.text: bytes | None = None
        self.undecodable: bytes | None = None  # the name of a dropped file
        self.calls: list[str] = []
        self.on: dict[str, Any] = {}
        self.hints: dict[int, int] = {}
        self.labels: dict[int, str] = {}  # of keys on which other letters stand than on an American keyboard's

    def __getattr__(self, name: str) -> Any:
        if name.isupper():
            return getattr(glfw, name)
        if name.startswith("set_") and name.endswith("_callback"):
            return lambda _window, callback: self.on.update({name[4:-9]: callback})
        return lambda *_: self.calls.append(name)

    def init(self) -> bool:
        return self.starts

    def create_window(self, width: int, height: int, *_: object) -> str | None:
        self.place = (*self.place[:2], self.magnifies * width, self.magnifies * height)
        return "window" if self.opens else None

    def window_hint(self, hint: int, value: int) -> None:
        self.hints[hint] = value

    def get_error(self) -> tuple[int, bytes]:
        return 0, b"no such thing"

    def get_window_pos(self, _window: object) -> tuple[int, int]:
        return self.place[:2]

    def get_window_size(self, _window: object) -> tuple[int, int]:
        return self.place[2:4] if self.fills is None else self.fills[2:4]

    def set_window_size(self, _window: object, width: int, height: int) -> None:
        self.place = (*self.place[:2], width, height)

    def get_framebuffer_size(self, window: object) -> tuple[int, int]:
        width, height = self.get_window_size(window)
        return self.density * width, self.density * height

    def get_window_content_scale(self, _window: object) -> tuple[float, float]:
        return float(self.density), float(self.density)

    def get_cursor_pos(self, _window: object) -> tuple[float, float]:
        return 7.0, 9.0

    def get_primary_monitor(self) -> tuple[int, ...] | None:
        return self.monitors[0] if self.monitors else None

    def get_monitors(self) -> list[tuple[int, ...]]:
        return self.monitors

    def get_monitor_pos(self, monitor: tuple[int, ...]) -> tuple[int, ...]:
        return monitor[:2]

    def get_monitor_workarea(self, monitor: tuple[int, ...]) -> tuple[int, ...]:
        left, top, width, height, _ = monitor
        return left, top, width, height - self.bar_px

    def get_video_mode(self, monitor: tuple[int, ...]) -> SimpleNamespace:
        _, _, width, height, rate = monitor
        return SimpleNamespace(size=SimpleNamespace(width=width, height=height), refresh_rate=rate)

    def get_window_monitor(self, _window: object) -> tuple[int, ...] | None:
        return self.fills

    def set_window_monitor(self, _window: object, monitor: tuple[int, ...] | None, *place: int) -> None:
        self.fills = monitor
        if monitor is None:
            self.place = place[:4]

    def get_key_name(self, key: int, _scancode: int) -> str | None:
        return self.labels.get(key, chr(key).lower()) if key < 128 and key != glfw.KEY_SPACE else None

    def get_key(self, _window: object, key: int) -> int:
        return glfw.PRESS if key in self.down else glfw.RELEASE

    def get_clipboard_string(self, _window: object) -> bytes | None:
        return self.text

    def poll_events(self) -> None:
        self.calls.append("poll_events")
        if self.undecodable is not None:
            self.undecodable.decode()


@pytest.fixture
def desktop(monkeypatch: pytest.MonkeyPatch) -> Glfw:
    desktop = Glfw()
    monkeypatch.setattr(glfw_window, "glfw", desktop)
    monkeypatch.setattr(glfw_window, "handle_x_errors", lambda: None)
    monkeypatch.setattr(glfw_window, "window_context", SimpleNamespace)
    return desktop


def opened(size: Size = (640, 480)) -> GlfwWindow:
    return GlfwWindow("ashe-live", size)


def test_its_opengl_is_one_that_macos_has_and_its_pictures_wait_for_the_display(desktop: Glfw) -> None:
    """Which has 3.3 in a forward-compatible core profile alone."""
    opened()
    wanted = {
        glfw.CONTEXT_VERSION_MAJOR: 3,
        glfw.CONTEXT_VERSION_MINOR: 3,
        glfw.OPENGL_PROFILE: glfw.OPENGL_CORE_PROFILE,
        glfw.OPENGL_FORWARD_COMPAT: True,
    }
    assert desktop.hints.items() >= wanted.items()
    made_current = desktop.calls.index("make_context_current")
    assert "swap_interval" in desktop.calls[made_current:]
    assert "show_window" in desktop.calls


def press(desktop: Glfw, key: int, *actions: int, held: int = 0) -> None:
    for action in actions:
        desktop.on["key"](None, key, 0, action, held)


def test_a_key_asks_once_and_while_it_is_held_for_what_goes_on(desktop: Glfw) -> None:
    window = opened()
    held = glfw.PRESS, glfw.REPEAT, glfw.REPEAT, glfw.RELEASE
    press(desktop, glfw.KEY_SPACE, *held)
    press(desktop, glfw.KEY_F9, *held)
    press(desktop, glfw.KEY_LEFT, *held, held=glfw.MOD_CONTROL)
    assert window.take_requests(0.0) == [Request(Command.ESTIMATE), *[Request(Command.MOVE_LIGHT, (-1, 0))] * 3]
    assert window.take_requests(0.0) == []


def test_it_waits_for_events_where_it_is_to_and_only_there(desktop: Glfw) -> None:
    """An unchanged picture would else keep a core busy."""
    window, waits = opened(), ("wait_events_timeout", "poll_events")
    for wait_s in (0.1, 0.0):
        window.take_requests(wait_s)
    assert [call for call in desktop.calls if call in waits] == list(waits)


def test_letters_are_known_by_what_stands_on_the_key(desktop: Glfw) -> None:
    window = opened()
    press(desktop, glfw.KEY_L, glfw.PRESS)
    press(desktop, glfw.KEY_S, glfw.PRESS, held=glfw.MOD_SHIFT)
    desktop.labels = {glfw.KEY_Y: "z", glfw.KEY_Z: "y"}  # German
    press(desktop, glfw.KEY_Y, glfw.PRESS, held=glfw.MOD_CONTROL)
    assert window.take_requests(0.0) == [
        Request(each) for each in (Command.TOGGLE_LIGHT, Command.CUT_OUT, Command.UNDO)
    ]


def test_a_press_is_where_the_mouse_was_then_and_of_moves_in_a_row_the_last_counts(desktop: Glfw) -> None:
    window = opened()
    move, button = desktop.on["cursor_pos"], desktop.on["mouse_button"]
    move(None, 10.0, 10.0)
    move(None, 20.0, 10.0)
    button(None, LEFT, glfw.PRESS, glfw.MOD_SHIFT)
    move(None, 30.0, 10.0)
    move(None, 40.0, 15.0)
    button(None, LEFT, glfw.RELEASE, 0)
    assert window.take_mouse() == [
        MouseEvent(MOVED, 20.0, 10.0),
        MouseEvent(PRESSED, 20.0, 10.0, shift=True),
        MouseEvent(MOVED, 40.0, 15.0, shift=True),
        MouseEvent(RELEASED, 40.0, 15.0),
    ]
    assert window.take_mouse() == []


def test_the_mouse_is_where_the_pointer_is_before_it_has_moved(desktop: Glfw) -> None:
    window = opened()
    desktop.on["mouse_button"](None, LEFT, glfw.PRESS, 0)
    assert window.take_mouse() == [MouseEvent(PRESSED, 7.0, 9.0)]


def test_the_right_button_opens_the_menu_as_it_goes_down_and_the_middle_one_does_nothing(desktop: Glfw) -> None:
    window = opened()
    made = []
    for button, action in ((MIDDLE, glfw.PRESS), (MIDDLE, glfw.RELEASE), (RIGHT, glfw.PRESS), (RIGHT, glfw.RELEASE)):
        desktop.on["mouse_button"](None, button, action, 0)
        made.append(window.take_mouse())
    assert made == [[], [], [MouseEvent(MouseAction.MENU, 7.0, 9.0)], []]


def test_on_a_dense_display_the_mouse_is_in_pixels_of_the_picture(desktop: Glfw) -> None:
    desktop.density = 2
    window = opened()
    desktop.on["cursor_pos"](None, 320.0, 240.0)
    assert window.take_mouse() == [MouseEvent(MOVED, 640.0, 480.0)]
    assert (window.screen.size, window.screen.content_scale) == ((1280, 960), 2.0)


@pytest.mark.parametrize("shift", [(), (glfw.KEY_LEFT_SHIFT,), (glfw.KEY_RIGHT_SHIFT,)])
@pytest.mark.parametrize("alt", [(), (glfw.KEY_LEFT_ALT,), (glfw.KEY_RIGHT_ALT,)])
def test_the_wheel_knows_which_keys_are_held(desktop: Glfw, shift: tuple[int, ...], alt: tuple[int, ...]) -> None:
    """Also sideways, as macOS scrolls with Shift."""
    window = opened()
    desktop.down = {*shift, *alt}
    for x, y in ((0.0, -1.5), (2.0, 0.0)):
        desktop.on["scroll"](None, x, y)
    assert window.take_mouse() == [
        MouseEvent(MouseAction.SCROLLED, 7.0, 9.0, bool(shift), notches, bool(alt)) for notches in (-1.5, 2.0)
    ]


def test_dropped_files_are_opened_whatever_their_names(desktop: Glfw) -> None:
    window = opened()
    desktop.on["drop"](None, ["a.glb", "b.glb"])
    assert window.take_requests(0.0) == [Request(Command.OPEN, Files(("a.glb", "b.glb")))]
    desktop.undecodable = b"k\xfcche.mp4"
    assert window.take_requests(0.0) == [Request(Command.OPEN, Files((os.fsdecode(b"k\xfcche.mp4"),)))]


def test_the_clipboard_may_hold_text_anything_else_or_nothing(desktop: Glfw) -> None:
    window = opened()
    for held, text in ((b"K\xc3\xbcche.mp4", "Küche.mp4"), (b"\xff", "\ufffd"), (None, "")):
        desktop.text = held
        assert window.clipboard == text


@pytest.mark.parametrize(
    ("place", "monitor"),
    [
        ((100, 50), PRIMARY),
        ((1500, 300), PRIMARY),  # 420 of its 640 columns
        ((1700, 300), PROJECTOR),
        ((2000, 300), PROJECTOR),
        ((-5000, 0), PRIMARY),  # on none, as where a desktop does not tell
    ],
)
def test_it_fills_the_monitor_that_it_is_on_and_comes_back_to_its_place(
    desktop: Glfw, place: tuple[int, int], monitor: tuple[int, ...]
) -> None:
    window = opened()
    desktop.place = before = (*place, 640, 480)
    assert window.refresh_rate_hz == monitor[4]
    window.toggle_fullscreen()
    assert window.is_fullscreen
    assert desktop.fills == monitor
    assert window.screen.size == monitor[2:4]
    window.toggle_fullscreen()
    assert not window.is_fullscreen
    assert desktop.place == before


def test_without_a_monitor_it_stays_as_it_is(desktop: Glfw) -> None:
    window = opened()
    desktop.monitors = []
    window.toggle_fullscreen()
    assert not window.is_fullscreen
    assert window.refresh_rate_hz == 60
    desktop.monitors = [(0, 0, 1920, 1080, 0)]  # a virtual one that has no rate
    assert window.refresh_rate_hz == 60


@pytest.mark.parametrize(
    ("asked", "magnifies", "has"),
    [
        ((640, 480), 1, (640, 480)),
        ((3840, 2160), 1, (1778, 1000)),
        ((400, 2000), 1, (200, 1000)),
        ((3000, 500), 1, (1920, 320)),
        ((640, 480), 2, (1280, 960)),
        ((1280, 720), 2, (1778, 1000)),
    ],
)
def test_it_is_no_larger_than_the_desktop_has_room_for(desktop: Glfw, asked: Size, magnifies: int, has: Size) -> None:
    desktop.bar_px, desktop.magnifies = 80, magnifies
    assert opened(asked).screen.size == pytest.approx(has, abs=1)


@pytest.mark.parametrize("monitors", [[], [(0, 0, 0, 0, 60)]], ids=["none", "one that does not say how large it is"])
def test_it_is_as_large_as_was_asked_for_where_nobody_knows_the_desktop_s_size(
    desktop: Glfw, monitors: list[tuple[int, ...]]
) -> None:
    desktop.monitors = monitors
    assert opened((640, 480)).screen.size == (640, 480)


def test_where_no_window_can_be_opened_it_is_said_why(desktop: Glfw) -> None:
    desktop.opens = False
    with pytest.raises(UserError, match=r"OpenGL 3\.3 \(no such thing\)"):
        opened()
    assert desktop.calls.count("terminate") == 1
    desktop.starts = False
    with pytest.raises(UserError, match=r"cannot open a window \(no such thing\)"):
        opened()


def test_a_window_without_a_context_goes_again(desktop: Glfw, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails() -> None:
        raise UserError("this OpenGL is too old", "update the graphics driver")

    monkeypatch.setattr(glfw_window, "window_context", fails)
    with pytest.raises(UserError, match="too old"):
        opened()
    assert desktop.calls[-2:] == ["destroy_window", "terminate"]


def test_it_is_closed_once(desktop: Glfw) -> None:
    with opened() as window:
        window.close()
    assert desktop.calls.count("destroy_window") == desktop.calls.count("terminate") == 1
