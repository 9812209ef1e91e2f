"""The one table of keys: what the window obeys and what the help shows; and what the mouse tells."""

from dataclasses import dataclass
from enum import Enum, auto


class Command(Enum):
    """What a person can ask the viewer for."""

    CHOOSE_MODEL = auto()
    PREVIOUS_MODEL = auto()
    NEXT_MODEL = auto()
    ESTIMATE = auto()
    AUTOMATIC = auto()
    TOGGLE_LIGHT = auto()
    TOGGLE_MASKS = auto()
    PAUSE = auto()
    RESTART = auto()
    SNAPSHOT = auto()
    RECORD = auto()
    QUALITY = auto()
    FULLSCREEN = auto()
    TOGGLE_HUD = auto()
    HELP = auto()
    QUIT = auto()


@dataclass(frozen=True, slots=True)
class Request:
    """A command and, where it has one, its argument."""

    command: Command
    argument: int = 0


@dataclass(frozen=True, slots=True)
class Binding:
    """Keys, by GLFW's names without KEY_, that ask for one command."""

    keys: tuple[str, ...]  # after SHIFT where it is held, too
    command: Command
    shown: str  # how the help writes the keys
    help: str
    repeats: bool = False  # again and again while the key is held


class MouseAction(Enum):
    """What the mouse did."""

    MOVED = auto()
    PRESSED = auto()
    RELEASED = auto()


@dataclass(frozen=True, slots=True)
class MouseEvent:
    """One action of the mouse, of its left button where it is one of a button."""

    action: MouseAction
    x_px: float  # from the left edge, in pixels of the framebuffer
    y_px: float  # from the top edge
    shift: bool = False


SHIFT = "SHIFT+"

BINDINGS = (
    Binding(tuple("123456789"), Command.CHOOSE_MODEL, "1 to 9", "choose the model"),
    Binding(("LEFT",), Command.PREVIOUS_MODEL, "Left", "previous model"),
    Binding(("RIGHT",), Command.NEXT_MODEL, "Right", "next model"),
    Binding(("SPACE",), Command.ESTIMATE, "Space", "estimate the light from this frame"),
    Binding(("A",), Command.AUTOMATIC, "A", "estimate again and again, fused (--auto)"),
    Binding(("L",), Command.TOGGLE_LIGHT, "L", "show where the light is"),
    Binding(("D",), Command.TOGGLE_MASKS, "D", "show what the estimator saw"),
    Binding(("P",), Command.PAUSE, "P", "pause"),
    Binding(("R",), Command.RESTART, "R", "start the clip again"),
    Binding(("S",), Command.SNAPSHOT, "S", "save a snapshot (PNG)"),
    Binding(("V",), Command.RECORD, "V", "start or stop recording (MP4)"),
    Binding(("Q",), Command.QUALITY, "Q", "quality: fast, balanced, accurate, auto"),
    Binding(("F",), Command.FULLSCREEN, "F", "fullscreen"),
    Binding(("I",), Command.TOGGLE_HUD, "I", "hide or show all text"),
    Binding(("H", "F1"), Command.HELP, "H or F1", "this help"),
    Binding(("ESCAPE",), Command.QUIT, "Esc", "quit"),
)

REQUEST_BY_KEY: dict[str, Request] = {
    key: Request(binding.command, place if binding.command is Command.CHOOSE_MODEL else 0)
    for binding in BINDINGS
    for place, key in enumerate(binding.keys)
}
REPEATED = frozenset(binding.command for binding in BINDINGS if binding.repeats)


def request_for(key: str | None, shift: bool) -> Request | None:
    """What the key of that name asks for; with Shift the same as without, unless the table says otherwise."""
    if key is None:
        return None
    return (REQUEST_BY_KEY.get(SHIFT + key) if shift else None) or REQUEST_BY_KEY.get(key)


def help_rows() -> tuple[tuple[str, str], ...]:
    """Keys and what they do, row by row."""
    return tuple((binding.shown, binding.help) for binding in BINDINGS)
