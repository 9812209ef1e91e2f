"""What of the picture is shown, as keys and options choose: parts to compare with the video, arrow, steps, text."""

from enum import Enum

from ashe_live.core.types import TrackedFrame
from ashe_live.viewer.hands.help import Help
from ashe_live.viewer.hands.requests import Command
from ashe_live.viewer.notice import Notice


class ShownParts(Enum):
    """Which of models and shadows are in the picture, in the order of key B."""

    # The values are in the files of --as-shown, and stay when notices are worded anew.
    WHOLE = "the model and its shadow"
    MODEL_ALONE = "the model without its shadow"
    SHADOW_ALONE = "the shadow without its model"
    VIDEO_ALONE = "the video alone"
    SPLIT = "the video alone in one half"

    @property
    def shows_model(self) -> bool:
        return self not in (ShownParts.SHADOW_ALONE, ShownParts.VIDEO_ALONE)

    @property
    def casts_shadow(self) -> bool:
        return self not in (ShownParts.MODEL_ALONE, ShownParts.VIDEO_ALONE)

    @property
    def is_split(self) -> bool:
        """Whether one half of the picture shows the video alone."""
        return self is ShownParts.SPLIT


WHOLE = ShownParts.WHOLE  # at first, and after a reset
NEXT_PARTS = "B goes on"
NOTHING_TO_COVER = "no marker in view that C could show or cover"
MARKER_SHOWN = "the marker is shown: C covers it"


class ViewOptions:
    """Changes nothing of what is known or stands on the table."""

    def __init__(self, notice: Notice) -> None:
        self._notice = notice
        self.shows_light = False  # as an arrow or a bulb
        self.shows_steps = False  # to the estimate, or its masks
        self.shows_hud = True
        self.wants_cover: bool | None = None  # None: nobody has chosen
        self.cover_is_drawn = True  # in the last picture, if it is wanted; so too where nobody reports it
        self.is_mirrored = False  # in the window only: what is saved is as the camera sees it
        self.parts = WHOLE
        self.help = Help()

    @property
    def has_time_bar(self) -> bool:
        """Whether there is room for one: not beside the help, nor where nothing is written."""
        return self.shows_hud and not self.help.is_shown

    def handle(self, command: Command, tracked: TrackedFrame | None, now_s: float) -> bool:
        """Handles a command that only changes this; returns False for any other. `tracked`: the frame shown."""
        match command:
            case Command.MIRROR:
                self.is_mirrored = not self.is_mirrored
            case Command.HELP:
                self.help.turn()
            case Command.TOGGLE_HUD:
                self.shows_hud = not self.shows_hud
            case Command.COVER_MARKER:
                self._show_or_cover(tracked, now_s)
            case Command.BEFORE_AFTER:
                self._show_next_parts(now_s)
            case _:
                return False
        return True

    def covers_marker(self, tracked: TrackedFrame | None) -> bool:
        """Whether ground is painted over the marker: as chosen; if nobody chose, over a sheet and not over a body."""
        marker = None if tracked is None else tracked.marker
        return self.wants_cover if self.wants_cover is not None else marker is None or marker.body is None

    def vacates_body(self, tracked: TrackedFrame | None) -> bool:
        """Whether models may take the place of a body that the marker is on: once the ground over it is drawn."""
        return self.covers_marker(tracked) and self.cover_is_drawn

    @property
    def parts_line(self) -> str | None:
        """What is shown, as long as that is less than all: snapshots and recordings have no more either."""
        return None if self.parts is WHOLE else f"{self.parts.value}: {NEXT_PARTS}"

    def _show_or_cover(self, tracked: TrackedFrame | None, now_s: float) -> None:
        if tracked is None or tracked.marker is None:
            self._notice.say(NOTHING_TO_COVER, now_s)
            return
        self.wants_cover = not self.covers_marker(tracked)
        if self.wants_cover:
            for said in (NOTHING_TO_COVER, MARKER_SHOWN):
                self._notice.withdraw(said)
        else:  # the picture does not tell where the ground over the marker is still being made
            self._notice.say(MARKER_SHOWN, now_s)

    def _show_next_parts(self, now_s: float) -> None:
        in_order = list(ShownParts)
        self.parts = in_order[(in_order.index(self.parts) + 1) % len(in_order)]
        if self.parts is WHOLE:
            self._notice.say(f"{WHOLE.value}: {NEXT_PARTS}", now_s)
        else:  # which `parts_line` says for as long as it is so
            self._notice.withdraw(WHOLE.value)
