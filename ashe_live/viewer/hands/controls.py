"""The table of all key and mouse bindings, from which the window acts and the help is written."""

from dataclasses import dataclass

from ashe_live.viewer.hands.requests import Argument, Command, Gesture, Request


@dataclass(frozen=True, slots=True)
class Binding:
    """Keys that ask for one command.

    A key is named by its label ("A", "+"), or as GLFW does, without KEY_ ("LEFT"). In front of it stand the modifiers
    that are held with it: CTRL+, ALT+, SHIFT+, in this order.
    """

    keys: tuple[str, ...]
    command: Command
    shown: str  # how the help writes the keys
    help: str
    arguments: tuple[Argument, ...] = ()  # of the command, one for each key; without any it is 0
    repeats: bool = False  # whether the command is repeated while the key is held
    gesture: Gesture | None = None  # a gesture of the mouse that asks for the same


HELD = CTRL, ALT, SHIFT = "CTRL+", "ALT+", "SHIFT+"
ARROWS = ("LEFT", "RIGHT", "DOWN", "UP")
STEPS = ((-1, 0), (1, 0), (0, -1), (0, 1))

BINDINGS = (
    Binding(tuple("123456789"), Command.CHOOSE_MODEL, "1 to 9", "choose the model", tuple(range(9))),
    Binding(("LEFT",), Command.PREVIOUS_MODEL, "Left", "previous model"),
    Binding(("RIGHT",), Command.NEXT_MODEL, "Right", "next model"),
    Binding(("SPACE",), Command.ESTIMATE, "Space", "estimate the light"),
    Binding((SHIFT + "SPACE",), Command.EMPTY_TABLE, "Shift+Space", "this is the empty table"),
    Binding(("A",), Command.AUTOMATIC, "A", "watch for a changed light"),
    Binding(("L",), Command.TOGGLE_LIGHT, "L", "show where the light is"),
    Binding(("D",), Command.TOGGLE_STEPS, "D", "show what was found"),
    Binding(("C",), Command.COVER_MARKER, "C", "cover or show the marker"),
    Binding(
        tuple(CTRL + arrow for arrow in ARROWS),
        Command.MOVE_LIGHT,
        "drag, Ctrl+arrows",
        "light by hand: where from",
        STEPS,
        repeats=True,
        gesture=Gesture.DRAG,
    ),
    Binding(
        (CTRL + "+", CTRL + "=", CTRL + "-", CTRL + "EQUAL", CTRL + "MINUS"),  # in some layouts + and = need Shift
        Command.LIGHT_STRENGTH,
        "Ctrl+ + -",
        "light: stronger, weaker",
        (1, 1, -1, 1, -1),
        repeats=True,
    ),
    Binding(
        (CTRL + "PAGE_UP", CTRL + "PAGE_DOWN"),
        Command.LIGHT_SOFTNESS,
        "Ctrl+Page Up, Down",
        "light: softer, sharper",
        (1, -1),
        repeats=True,
    ),
    Binding(
        (CTRL + "HOME", CTRL + "END", CTRL + "[", CTRL + "]"),  # many layouts have no brackets without a modifier
        Command.LIGHT_COLOUR,
        "Ctrl+Home, End",
        "light: warmer, cooler",
        (1, -1, 1, -1),
        repeats=True,
    ),
    Binding(
        (ALT + "PAGE_UP", ALT + "PAGE_DOWN"),
        Command.LIGHT_DISTANCE,
        "Alt+ wheel, Page Up, Down",
        "light: farther, nearer (a lamp)",
        (1, -1),
        repeats=True,
        gesture=Gesture.ALT_WHEEL,
    ),
    Binding(
        tuple(ALT + arrow for arrow in ARROWS),
        Command.MOVE_MODEL,
        "Shift+drag, Alt+arrows",
        "move the model on the table",
        STEPS,
        repeats=True,
        gesture=Gesture.SHIFT_DRAG,
    ),
    Binding(
        ("[", "]", "PAGE_UP", "PAGE_DOWN"),
        Command.TURN_MODEL,
        "Shift+wheel, [ ]",
        "turn the model",
        (1, -1, 1, -1),
        repeats=True,
        gesture=Gesture.SHIFT_WHEEL,
    ),
    Binding(("T", "INSERT"), Command.ADD_MODEL, "T", "one more model beside it"),
    Binding(("TAB",), Command.NEXT_IN_HAND, "Tab", "change the next of several"),
    Binding((SHIFT + "T", "DELETE"), Command.REMOVE_MODEL, "Shift+T, Delete", "take the model away"),
    Binding(("B",), Command.BEFORE_AFTER, "B", "before and after"),
    Binding(("U",), Command.TURN_UP, "U", "turn another side up"),
    Binding(("K",), Command.STOP_MOTION, "K", "stop a moving model"),
    Binding(
        ("+", "=", "-", "EQUAL", "MINUS", "HOME", "END"),  # French keyboards have the minus on the 6
        Command.SCALE_MODEL,
        "wheel, + -, Home, End",
        "model larger or smaller",
        (1, 1, -1, 1, -1, 1, -1),
        repeats=True,
        gesture=Gesture.WHEEL,
    ),
    Binding(
        ("BACKSPACE",),
        Command.RESET,
        "double click, Backspace",
        "light and model as before",
        gesture=Gesture.DOUBLE_CLICK,
    ),
    Binding((CTRL + "Z",), Command.UNDO, "Ctrl+Z", "undo what was done by hand"),
    Binding((CTRL + "V",), Command.OPEN, "drop a file, Ctrl+V", "open a model, clip or photo", gesture=Gesture.DROP),
    Binding(("M",), Command.FOLLOW_OTHER, "M", "follow another marker in view"),
    Binding(("G",), Command.FIELD_OF_VIEW, "G", "the camera's field of view"),
    Binding(("N",), Command.NEXT_CAMERA, "N", "another camera"),
    Binding(("P",), Command.PAUSE, "P", "pause"),
    Binding(("R",), Command.RESTART, "R", "start the clip again"),
    Binding((",", ".", "COMMA", "PERIOD"), Command.STEP, ", and .", "one frame back, one on", (-1, 1, -1, 1), True),
    Binding((SHIFT + "LEFT", SHIFT + "RIGHT"), Command.SEEK, "Shift+Left, Right", "5 seconds back, on", (-5, 5), True),
    Binding(("Z", "X"), Command.SPEED, "Z, X", "slower, faster", (-1, 1)),
    Binding(("O",), Command.LOOP, "O", "play again and again, or once"),
    Binding(("S",), Command.SNAPSHOT, "S", "save a snapshot (PNG)"),
    Binding((SHIFT + "S",), Command.CUT_OUT, "Shift+S", "save model and shadow alone"),
    Binding(("E",), Command.KEEP_LIGHT, "E", "save the light (HDR, JSON)"),
    Binding(("V",), Command.RECORD, "V", "start or stop a recording"),
    Binding(("Q",), Command.QUALITY, "Q", "quality of the picture"),
    Binding(("F",), Command.FULLSCREEN, "F", "fullscreen"),
    Binding(("I",), Command.TOGGLE_HUD, "I", "hide or show all text"),
    Binding(("W",), Command.MIRROR, "W", "as in a mirror, or as it is"),
    Binding(("H", "F1"), Command.HELP, "H or F1", "all keys"),
    Binding(("ESCAPE",), Command.LEAVE, "Esc", "go back, then quit"),
)

REQUEST_BY_KEY: dict[str, Request] = {
    key: Request(binding.command, argument)
    for binding in BINDINGS
    for key, argument in zip(binding.keys, binding.arguments or (0,) * len(binding.keys), strict=True)
}
COMMAND_BY_GESTURE = {binding.gesture: binding.command for binding in BINDINGS if binding.gesture is not None}
REPEATED = frozenset(binding.command for binding in BINDINGS if binding.repeats)


def request_for(label: str, place: str | None, held: str = "") -> Request | None:
    """What a key asks for. `label`: what is printed on it, or "". `place`: GLFW's name, which is that of a US keyboard.

    `held`: the modifiers of HELD that are down, joined. Letters are known by their label where that is Latin; number
    keys by their place, as some layouts print the digits on their upper half, and by what these have below them only
    where the digit asks for nothing. Shift changes nothing unless the table has a binding with it.
    """
    names = [label, place or ""]
    if label.isascii() and label.isalpha():
        names = [label.upper()]
    elif place is not None and place.isdecimal():
        names = [place, label]
    for modifiers in (held, held.replace(SHIFT, "")):
        for name in names:
            if (request := REQUEST_BY_KEY.get(modifiers + name)) is not None:
                return request
    return None


def help_rows() -> tuple[tuple[str, str], ...]:
    """Keys and what they do, row by row."""
    return (*((binding.shown, binding.help) for binding in BINDINGS), ("right click", "most of this in a menu"))
