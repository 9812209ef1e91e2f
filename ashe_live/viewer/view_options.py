"""What of the picture is shown, as keys and options choose: parts to compare with the video, arrow, steps, text."""

from ashe_live.core.types import TrackedFrame
from ashe_live.viewer.hands.help import Help

WHOLE, VIDEO_ALONE = "the model and its shadow", "the video alone"
SPLIT = "the video alone in one half"
SHADOW_ALONE = "the shadow without its model"
PARTS = WHOLE, "the model without its shadow", SHADOW_ALONE, VIDEO_ALONE, SPLIT  # in the order of key B


class ViewOptions:
    """Changes nothing of what is known or stands on the table."""

    def __init__(self) -> None:
        self.shows_light = False  # as an arrow or a bulb
        self.shows_steps = False  # to the estimate, or its masks
        self.shows_hud = True
        self.wants_cover: bool | None = None  # None: nobody has chosen
        self.is_mirrored = False  # in the window only: what is saved is as the camera sees it
        self.parts = WHOLE
        self.help = Help()

    def covers_marker(self, tracked: TrackedFrame | None) -> bool:
        """Whether ground is painted over the marker: as chosen; if nobody chose, over a sheet and not over a body."""
        marker = None if tracked is None else tracked.marker
        return self.wants_cover if self.wants_cover is not None else marker is None or marker.body is None

    def next_parts(self) -> str:
        """Shows the next of `PARTS`, which it returns."""
        self.parts = PARTS[(PARTS.index(self.parts) + 1) % len(PARTS)]
        return self.parts
