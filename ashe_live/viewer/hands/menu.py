"""A menu at the pointer, opened by the right mouse button: what the keys do, for whoever does not know them yet."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from ashe_live.core.arrays import Image, frozen_view
from ashe_live.core.camera import Size
from ashe_live.process.messages import printable
from ashe_live.render.hud import FONT_PT, MIN_FONT_PX, SMALLER, RowLayout, Rows, fits, in_two, row_layout, rows_plate
from ashe_live.render.scene import Overlay, one_pixel
from ashe_live.render.screen import Screen
from ashe_live.viewer.hands.controls import BINDINGS
from ashe_live.viewer.hands.help import LEGIBLE_PT
from ashe_live.viewer.hands.requests import Command, MouseAction, MouseEvent, Request

OFFERED = (
    Command.ESTIMATE,
    Command.EMPTY_TABLE,
    Command.AUTOMATIC,
    Command.TOGGLE_LIGHT,
    Command.TOGGLE_STEPS,
    Command.FOLLOW_OTHER,
    Command.FIELD_OF_VIEW,
    Command.NEXT_CAMERA,
    Command.COVER_MARKER,
    Command.BEFORE_AFTER,
    Command.ADD_MODEL,
    Command.NEXT_IN_HAND,
    Command.REMOVE_MODEL,
    Command.TURN_UP,
    Command.STOP_MOTION,
    Command.UNDO,
    Command.RESET,
    Command.PAUSE,
    Command.RESTART,
    Command.LOOP,
    Command.OPEN,
    Command.SNAPSHOT,
    Command.CUT_OUT,
    Command.KEEP_LIGHT,
    Command.RECORD,
    Command.MIRROR,
    Command.QUALITY,
    Command.FULLSCREEN,
    Command.TOGGLE_HUD,
    Command.HELP,
)
POINTED_AT_SRGBA = (246, 246, 242, 56)
CHOSEN, OTHER = ">", " "
MORE = "more"
LONGEST_NAME = 40  # letters of a model's name: a longer one would make those of all entries small
CELLS = 3  # columns of text that an entry has: the mark, what it does, its keys
HIGHEST = 0.6  # of the window: a higher menu stands in two columns, if these fit beside each other
LARGEST = 0.6  # of the window's area: a larger menu is written in smaller letters, as the picture should be seen


@dataclass(frozen=True, slots=True)
class Entry:
    """One row."""

    text: str
    keys: str  # the keys that do the same
    request: Request | None  # None: shows the entries for which there was no room
    is_chosen: bool = False


def entries_for(models: Sequence[str], chosen: int) -> tuple[Entry, ...]:
    """The models by name, the one at `chosen` marked, then the commands as the table of keys words them."""
    bindings = {binding.command: binding for binding in BINDINGS}
    first = [
        Entry(printable(name, LONGEST_NAME), key, Request(Command.CHOOSE_MODEL, at), is_chosen=at == chosen)
        for at, (name, key) in enumerate(zip(models, bindings[Command.CHOOSE_MODEL].keys, strict=False))
    ]
    # Where a command can be asked for in several ways, the last one listed is a key.
    rest = [Entry(bindings[each].help, bindings[each].shown.split(", ")[-1], Request(each)) for each in OFFERED]
    return tuple(first + rest)


@dataclass(frozen=True, slots=True)
class _Opened:
    entries: tuple[Entry, ...]  # that are shown
    later: tuple[Entry, ...]  # all, in the order of the next page
    at_px: tuple[float, float]  # the pointer, as it was opened
    screen: Screen
    font_px: float
    left: int
    top: int
    rows: Rows
    layout: RowLayout

    def at(self, x_px: float, y_px: float) -> int | None:
        """The number of the entry at a place of the framebuffer."""
        if not 0 <= x_px - self.left < self.layout.size[0]:
            return None
        row = int((y_px - self.top - self.layout.padding) // self.layout.line)
        column = sum(x_px - self.left >= begin for begin in self._begins[1:])
        number = row + column * len(self.rows)
        return number if 0 <= row < len(self.rows) and number < len(self.entries) else None

    def place_of(self, number: int) -> tuple[int, int, Size]:
        """Left, top and size of an entry's bar."""
        column, row = divmod(number, len(self.rows))
        begin, end = [*self._begins, self.layout.size[0]][column : column + 2]
        top = self.top + self.layout.padding + row * self.layout.line
        return self.left + begin, top, (end - begin, self.layout.line)

    @property
    def _begins(self) -> list[int]:
        """Where each column of entries begins, from the plate's left edge: in the middle of the gap before it."""
        widths, gap = self.layout.column_widths, self.layout.column_gap
        ends = [
            self.layout.padding + sum(widths[:cell]) + cell * gap - gap // 2
            for cell in range(CELLS, len(widths), CELLS)
        ]
        return [0, *ends]

    def holds(self, x_px: float, y_px: float) -> bool:
        width, height = self.layout.size
        return 0 <= x_px - self.left < width and 0 <= y_px - self.top < height


class Menu:
    """Opened, pointed at and chosen from by the mouse alone."""

    def __init__(self) -> None:
        self._opened: _Opened | None = None
        self._pointed_at: int | None = None
        self._request: Request | None = None
        self._drawn: tuple[_Opened, int | None, tuple[Overlay, ...]] | None = None
        self._swallows_release = False

    @property
    def is_open(self) -> bool:
        return self._opened is not None

    def close(self) -> None:
        self._opened = None

    def take_request(self) -> Request | None:
        """The request that was chosen, returned once."""
        request, self._request = self._request, None
        return request

    def take_mouse(self, event: MouseEvent, entries: Callable[[], tuple[Entry, ...]], screen: Screen) -> bool:
        """Opens by the right button, chooses by the left one; False for what concerns the picture below.

        A press beside the menu closes it and does nothing else. `entries` is called when it opens.
        """
        if event.action is MouseAction.MENU:
            self._opened = _placed(entries(), (event.x_px, event.y_px), screen)
            self._pointed_at = None
            return True
        if event.action is MouseAction.RELEASED:
            # The button may have been pressed before the menu opened: then this ends what that began, such as a drag.
            is_own, self._swallows_release = self._swallows_release, False
            return is_own
        if self._opened is None:
            return False
        if self._opened.screen != screen:  # made for another window
            self.close()
            return False
        self._pointed_at = self._opened.at(event.x_px, event.y_px)
        if event.action is MouseAction.PRESSED:
            self._swallows_release = True
            if self._pointed_at is not None:
                self._request = self._opened.entries[self._pointed_at].request
                if self._request is None:
                    self._opened = _placed(self._opened.later, self._opened.at_px, screen)
                    self._pointed_at = None
                    return True
            if self._pointed_at is not None or not self._opened.holds(event.x_px, event.y_px):
                self.close()
        return True

    def overlays(self, screen: Screen) -> tuple[Overlay, ...]:
        """The menu's parts, the same objects while nothing changes; none while it is closed.

        It closes when the window has another size than it was made for.
        """
        if self._opened is not None and self._opened.screen != screen:
            self.close()
        opened = self._opened
        if opened is None:
            return ()
        if self._drawn is None or self._drawn[0] is not opened or self._drawn[1] != self._pointed_at:
            plate = Overlay(_plate(opened.rows, opened.font_px), opened.left, opened.top)
            shown: tuple[Overlay, ...] = (plate,)
            if self._pointed_at is not None:
                shown += (Overlay(one_pixel(POINTED_AT_SRGBA), *opened.place_of(self._pointed_at)),)
            self._drawn = opened, self._pointed_at, shown
        return self._drawn[2]


def _placed(entries: tuple[Entry, ...], at_px: tuple[float, float], screen: Screen) -> _Opened:
    """The menu with a corner at the pointer, or as near as it fits; in smaller letters where it would be too large.

    In a window too small for all entries in legible letters: the first ones, and one that leads to the others.
    """
    size = screen.size
    one, shown, font_px = _rows(entries), entries, FONT_PT * screen.content_scale
    rows = one if row_layout(one, font_px).size[1] <= HIGHEST * size[1] else in_two(one)
    legible_px = max(MIN_FONT_PX, LEGIBLE_PT * screen.content_scale)
    while font_px > legible_px and not (fits(rows, font_px, size, gap=0) and _leaves_room(rows, font_px, size)):
        font_px = max(legible_px, SMALLER * font_px)
    if not fits(rows, font_px, size, gap=0):
        while font_px > MIN_FONT_PX and row_layout(one, font_px).size[0] > size[0]:
            font_px = max(MIN_FONT_PX, SMALLER * font_px)
        layout = row_layout(one, font_px)
        count = max(1, (size[1] - 2 * layout.padding) // layout.line - 1)
        shown = (*entries[:count], Entry(MORE, "", None)) if count < len(entries) else entries
        rows = _rows(shown)
    layout = row_layout(rows, font_px)
    left, top = (max(0, min(round(at), whole - own)) for at, whole, own in zip(at_px, size, layout.size, strict=True))
    later = (*entries[len(shown) - 1 :], *entries[: len(shown) - 1])
    return _Opened(shown, later, at_px, screen, font_px, left, top, rows, layout)


def _leaves_room(rows: Rows, font_px: float, size: Size) -> bool:
    width, height = row_layout(rows, font_px).size
    return width * height <= LARGEST * size[0] * size[1]


def _rows(entries: tuple[Entry, ...]) -> Rows:
    return tuple((CHOSEN if entry.is_chosen else OTHER, entry.text, entry.keys) for entry in entries)


@lru_cache(maxsize=1)
def _plate(rows: Rows, font_px: float) -> Image:
    return frozen_view(rows_plate(rows, font_px))
