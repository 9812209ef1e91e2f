"""The window on the screen, by GLFW, with an OpenGL 3.3 core context; it turns key events into requests."""

import os
from dataclasses import replace
from typing import Any, Self

from ashe_live.core.camera import Size
from ashe_live.errors import UserError
from ashe_live.process.messages import printable
from ashe_live.render.gl.offscreen import window_context
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.controls import COMMAND_BY_GESTURE, HELD, REPEATED, REQUEST_BY_KEY, request_for
from ashe_live.viewer.hands.requests import Files, Gesture, MouseAction, MouseEvent, Request
from ashe_live.viewer.windows.glfw_library import glfw
from ashe_live.viewer.windows.window import Presentable
from ashe_live.viewer.windows.x_errors import handle_x_errors

BOUND_NAMES = {key.rpartition("+")[2] for key in REQUEST_BY_KEY}
# Names without a GLFW key code are printed on a key in some layouts only, and are recognised by the label.
NAME_BY_GLFW_KEY = {getattr(glfw, f"KEY_{name}"): name for name in BOUND_NAMES if hasattr(glfw, f"KEY_{name}")}
# Cmd as well, as macOS keeps some of Ctrl's keys to itself.
MODIFIERS = (glfw.MOD_CONTROL | glfw.MOD_SUPER, glfw.MOD_ALT, glfw.MOD_SHIFT)


class GlfwWindow:
    """A Window. Used by the main thread only (macOS insists on it)."""

    def __init__(self, title: str, size: Size) -> None:
        """Raises UserError when there is no display or no OpenGL 3.3."""
        self._window = _hidden_window(title, size)
        # Where windows are measured in pixels (X11, Windows), a high-density display's is larger than was asked for.
        magnified = glfw.get_window_size(self._window)
        if (fitting := _fitting(magnified)) != magnified:
            glfw.set_window_size(self._window, *fitting)
        glfw.show_window(self._window)
        self._windowed = (*glfw.get_window_pos(self._window), *glfw.get_window_size(self._window))
        self._requests: list[Request] = []
        self._mouse: list[MouseEvent] = []
        self._shift = False
        self._cursor: tuple[float, float] = glfw.get_cursor_pos(self._window)
        glfw.set_key_callback(self._window, self._on_key)
        glfw.set_cursor_pos_callback(self._window, self._on_move)
        glfw.set_mouse_button_callback(self._window, self._on_button)
        glfw.set_drop_callback(self._window, self._on_drop)  # type: ignore[arg-type]  # the stub types the C function
        glfw.set_scroll_callback(self._window, self._on_scroll)
        glfw.make_context_current(self._window)
        glfw.swap_interval(1)
        try:
            self.context = window_context()
        except UserError:
            self.close()
            raise

    @property
    def screen(self) -> Screen:
        # In pixels: a high-density display has several for each of the window's own units.
        width, height = glfw.get_framebuffer_size(self._window)
        return Screen.readable((int(width), int(height)), float(glfw.get_window_content_scale(self._window)[0]))

    @property
    def refresh_rate_hz(self) -> float:
        monitor = self._monitor()
        mode = glfw.get_video_mode(monitor) if monitor else None
        return float(mode.refresh_rate) if mode and mode.refresh_rate > 0 else 60.0

    def take_requests(self, wait_s: float) -> list[Request]:
        try:
            if wait_s > 0:
                glfw.wait_events_timeout(wait_s)
            else:
                glfw.poll_events()
        except UnicodeDecodeError as error:  # pyGLFW takes the names of dropped files for UTF-8: this one is not
            self._on_drop(None, [os.fsdecode(error.object)])
        requests, self._requests = self._requests, []
        return requests

    def take_mouse(self) -> list[MouseEvent]:
        events, self._mouse = self._mouse, []
        return events

    @property
    def clipboard(self) -> str:
        no_window: Any = None  # GLFW has one clipboard for all
        text: Any = glfw.get_clipboard_string(no_window)  # bytes, whatever the stub says
        return text.decode(errors="replace") if text else ""

    def set_title(self, title: str) -> None:
        glfw.set_window_title(self._window, printable(title))

    @property
    def is_closing(self) -> bool:
        return bool(glfw.window_should_close(self._window))

    def present(self, picture: Presentable) -> None:
        picture.present(self.context.screen)

    def swap(self) -> None:
        glfw.swap_buffers(self._window)

    @property
    def is_fullscreen(self) -> bool:
        return bool(glfw.get_window_monitor(self._window))

    def toggle_fullscreen(self) -> None:
        windowed: Any = None
        if glfw.get_window_monitor(self._window):
            glfw.set_window_monitor(self._window, windowed, *self._windowed, 0)
            return
        if not (monitor := self._monitor()):
            return  # unplugged: GLFW would end the process
        self._windowed = (*glfw.get_window_pos(self._window), *glfw.get_window_size(self._window))
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(self._window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def close(self) -> None:
        if self._window:
            glfw.destroy_window(self._window)
            self._window = None
            glfw.terminate()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _monitor(self) -> Any:
        """The one that the window fills, or the one with the most of it; the primary where none is known to have any.

        None where all are unplugged.
        """
        if monitor := glfw.get_window_monitor(self._window):
            return monitor
        left, top = glfw.get_window_pos(self._window)
        width, height = glfw.get_window_size(self._window)

        def area_on(monitor: Any) -> int:
            x, y = glfw.get_monitor_pos(monitor)
            mode = glfw.get_video_mode(monitor)
            if not mode:
                return 0
            across = min(left + width, x + mode.size.width) - max(left, x)
            down = min(top + height, y + mode.size.height) - max(top, y)
            return max(0, across) * max(0, down)

        return max(glfw.get_monitors() or (), key=area_on, default=None)  # the primary is the first

    def _on_key(self, _window: object, key: int, scancode: int, action: int, modifiers: int) -> None:
        self._shift = bool(modifiers & glfw.MOD_SHIFT)
        label = glfw.get_key_name(key, scancode) or ""
        request = request_for(label, NAME_BY_GLFW_KEY.get(key), held(modifiers))
        if request is None:
            return
        if action == glfw.PRESS or (action == glfw.REPEAT and request.command in REPEATED):
            self._requests.append(request)

    def _on_move(self, _window: object, x: float, y: float) -> None:
        if self._mouse and self._mouse[-1].action is MouseAction.MOVED:
            del self._mouse[-1]
        self._cursor = x, y
        self._mouse.append(self._mouse_event(MouseAction.MOVED))

    def _on_button(self, _window: object, button: int, action: int, modifiers: int) -> None:
        if button == glfw.MOUSE_BUTTON_LEFT:
            self._shift = bool(modifiers & glfw.MOD_SHIFT)
            kind = MouseAction.PRESSED if action == glfw.PRESS else MouseAction.RELEASED
            self._mouse.append(self._mouse_event(kind))
        elif button == glfw.MOUSE_BUTTON_RIGHT and action == glfw.PRESS:
            self._mouse.append(self._mouse_event(MouseAction.MENU))

    def _on_scroll(self, _window: object, x: float, y: float) -> None:
        # GLFW reports no modifiers here; and with Shift macOS scrolls sideways.
        self._shift = self._is_down(glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SHIFT)
        alt = self._is_down(glfw.KEY_LEFT_ALT, glfw.KEY_RIGHT_ALT)
        event = self._mouse_event(MouseAction.SCROLLED)
        self._mouse.append(replace(event, notches=y or x, alt=alt))

    def _is_down(self, *keys: int) -> bool:
        return any(glfw.get_key(self._window, key) == glfw.PRESS for key in keys)

    def _on_drop(self, _window: object, paths: list[str]) -> None:
        self._requests.append(Request(COMMAND_BY_GESTURE[Gesture.DROP], Files(tuple(paths))))

    def _mouse_event(self, action: MouseAction) -> MouseEvent:
        """An event at the position of the last move: asked for it, GLFW would report where the pointer is by now."""
        x, y = self._cursor
        (width, height), (width_px, height_px) = glfw.get_window_size(self._window), self.screen.size
        return MouseEvent(action, x * width_px / max(1, width), y * height_px / max(1, height), self._shift)


def held(modifiers: int) -> str:
    """GLFW's bits as the table of keys writes them."""
    return "".join(name for name, bits in zip(HELD, MODIFIERS, strict=True) if modifiers & bits)


def _hidden_window(title: str, size: Size) -> Any:
    """A new one of GLFW's. Raises UserError when there is no display or no OpenGL 3.3."""
    # Errors are read from return values; as warnings they would be printed a second time.
    glfw.ERROR_REPORTING = "ignore"
    if not glfw.init():
        raise UserError(f"cannot open a window ({_last_error()})", "start it on a screen, or with --headless")
    handle_x_errors()
    for hint, value in (
        (glfw.CONTEXT_VERSION_MAJOR, 3),
        (glfw.CONTEXT_VERSION_MINOR, 3),
        (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
        (glfw.OPENGL_FORWARD_COMPAT, True),
        (glfw.SCALE_TO_MONITOR, True),
        (glfw.VISIBLE, False),  # until it has its size
    ):
        glfw.window_hint(hint, value)
    window: Any = glfw.create_window(*_fitting(size), printable(title), None, None)
    if not window:
        message = _last_error()
        glfw.terminate()
        raise UserError(f"cannot open a window with OpenGL 3.3 ({message})", "update the graphics driver")
    return window


def _fitting(size: Size) -> Size:
    """`size` scaled down to what the screen has room for, in the same shape."""
    monitor = glfw.get_primary_monitor()
    if not monitor:
        return size
    _, _, width, height = glfw.get_monitor_workarea(monitor)
    scale = min(1.0, width / size[0], height / size[1]) if width > 0 and height > 0 else 1.0
    return max(1, int(size[0] * scale)), max(1, int(size[1] * scale))


def _last_error() -> str:
    message: Any = glfw.get_error()[1]  # bytes, whatever the stub says
    return message.decode(errors="replace") if message else "no reason given"
