"""A window's pixels, and how many of them make a point, the unit of letters and lines."""

import math
from dataclasses import dataclass, replace

from ashe_live.core.camera import Size

# Text is sized as if the picture were at most this high: a larger picture is seen as a whole, on a display or in print.
FULL_HEIGHT_PX = 1080


@dataclass(frozen=True, slots=True)
class Screen:
    """A framebuffer on a display."""

    size: Size  # width, height in pixels; 0x0 while the window is minimised
    content_scale: float = 1.0  # pixels a point

    @classmethod
    def readable(cls, size: Size, content_scale: float) -> "Screen":
        """With the scale that the display reports, or a larger one where it reports 1 for a 4K picture."""
        return cls(size, max(content_scale, math.floor(4 * size[1] / FULL_HEIGHT_PX) / 4))

    @property
    def is_minimised(self) -> bool:
        return min(self.size) < 1

    def px(self, length_pt: float) -> int:
        """A length in points, in whole pixels."""
        return round(length_pt * self.content_scale)

    def without_bottom(self, height_px: int) -> "Screen":
        """What is left above a strip of this height; at least a row of pixels."""
        return replace(self, size=(self.size[0], max(1, self.size[1] - height_px)))
