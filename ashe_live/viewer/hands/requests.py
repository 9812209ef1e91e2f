"""The requests that a person can make of the viewer, and the mouse events."""

from dataclasses import dataclass
from enum import Enum, auto


class Command(Enum):
    """The requests that a person can make of the viewer."""

    CHOOSE_MODEL = auto()
    PREVIOUS_MODEL = auto()
    NEXT_MODEL = auto()
    ESTIMATE = auto()
    EMPTY_TABLE = auto()
    AUTOMATIC = auto()
    TOGGLE_LIGHT = auto()
    TOGGLE_STEPS = auto()
    COVER_MARKER = auto()
    PAUSE = auto()
    RESTART = auto()
    STEP = auto()
    SEEK = auto()
    SPEED = auto()
    LOOP = auto()
    SNAPSHOT = auto()
    CUT_OUT = auto()
    KEEP_LIGHT = auto()
    RECORD = auto()
    QUALITY = auto()
    FULLSCREEN = auto()
    MIRROR = auto()
    TOGGLE_HUD = auto()
    MOVE_LIGHT = auto()
    MOVE_MODEL = auto()
    SCALE_MODEL = auto()
    TURN_MODEL = auto()
    TURN_UP = auto()
    STOP_MOTION = auto()
    ADD_MODEL = auto()
    NEXT_IN_HAND = auto()
    REMOVE_MODEL = auto()
    BEFORE_AFTER = auto()
    LIGHT_STRENGTH = auto()
    LIGHT_SOFTNESS = auto()
    LIGHT_COLOUR = auto()
    LIGHT_DISTANCE = auto()
    FOLLOW_OTHER = auto()
    FIELD_OF_VIEW = auto()
    NEXT_CAMERA = auto()
    RESET = auto()
    OPEN = auto()
    HELP = auto()
    LEAVE = auto()
    UNDO = auto()


@dataclass(frozen=True, slots=True)
class Drag:
    """The mouse, moved while its button is down."""

    # Pixels from the left and top edges: of the framebuffer as the window gives them, of the video once converted.
    begin_px: tuple[float, float]
    now_px: tuple[float, float]
    is_first: bool  # this is the first move since the button went down


@dataclass(frozen=True, slots=True)
class Files:
    """The files that were dropped on the window together."""

    paths: tuple[str, ...]


Step = tuple[int, int]  # how many steps to the right, and how many up
Argument = int | float | Step | Drag | Files


@dataclass(frozen=True, slots=True)
class Request:
    """A command and, where it has one, its argument."""

    command: Command
    argument: Argument = 0

    @property
    def number(self) -> int:
        """The argument of a command that takes a whole number."""
        assert isinstance(self.argument, int)
        return self.argument


class Gesture(Enum):
    """Gestures of the mouse; drags and clicks are those of its left button."""

    DRAG = auto()
    SHIFT_DRAG = auto()
    WHEEL = auto()
    SHIFT_WHEEL = auto()
    ALT_WHEEL = auto()
    DOUBLE_CLICK = auto()
    DROP = auto()  # of files on the window


class MouseAction(Enum):
    """Kinds of mouse events."""

    MOVED = auto()
    PRESSED = auto()
    RELEASED = auto()
    SCROLLED = auto()
    MENU = auto()  # its right button went down


@dataclass(frozen=True, slots=True)
class MouseEvent:
    """One action of the mouse; a press or release is one of its left button."""

    action: MouseAction
    x_px: float  # from the left edge, in pixels of the framebuffer
    y_px: float  # from the top edge
    shift: bool = False
    notches: float = 0.0  # of the wheel, away from the hand
    alt: bool = False
