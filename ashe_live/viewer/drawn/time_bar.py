"""The time bar at the window's bottom: the position in a clip, and where a click seeks to."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from PIL import Image as PillowImage
from PIL import ImageDraw

from ashe_live.core.arrays import Image, frozen_view
from ashe_live.render.hud import PLATE_SRGBA, TEXT_SRGBA, bleed_px, text_ink, text_width
from ashe_live.render.scene import Overlay, one_pixel
from ashe_live.render.screen import Screen

HEIGHT_PT, LINE_PT, KNOB_PT, FONT_PT, GAP_PT = 26, 4, 12, 13, 10
# Within this distance above the bar the pointer makes it appear, and a press counts as one on the bar.
NEAR_PT = 14
# A narrower window only has room for the line and the time.
WIDE_PT = 460
REST_SRGBA = (150, 150, 146, 200)
SUPERSAMPLING = 4
MOST_FPS = 60  # of a clip all of whose frames' numbers have room, which is that of four digits at least


@dataclass(frozen=True, slots=True)
class Moment:
    """The content of the bar."""

    time_s: float
    duration_s: float
    frame: int | None = None  # its number, while the clip stands still
    speed: float = 1.0
    loops: bool = False


@dataclass(frozen=True, slots=True)
class Bar:
    """The bar's layout, in pixels of the framebuffer."""

    screen: Screen
    height: int
    left: int  # of the line
    right: int
    near_from: int  # the pointer is near below this

    def is_near(self, y_px: float) -> bool:
        return self.near_from <= y_px <= self.screen.size[1]

    def share_at(self, x_px: float) -> float:
        """The position in the clip at a place on the line: 0 at its start and before, 1 at its end and beyond."""
        return min(1.0, max(0.0, (x_px - self.left) / max(1, self.right - self.left)))


def bar_at(screen: Screen, duration_s: float) -> Bar:
    """The bar's layout at the bottom of the window, for a clip of this length. Its text at its longest has room."""
    (width, bottom), height, gap = screen.size, screen.px(HEIGHT_PT), screen.px(GAP_PT)
    last = Moment(duration_s, duration_s, max(1000, int(MOST_FPS * duration_s)), speed=0.25, loops=True)
    left = 2 * gap + text_width(f"{text_of(last, _is_wide(screen))} ", FONT_PT * screen.content_scale)
    return Bar(screen, height, left, max(left + 1, width - 2 * gap), bottom - height - screen.px(NEAR_PT))


def _is_wide(screen: Screen) -> bool:
    return screen.size[0] >= WIDE_PT * screen.content_scale


class TimeBar:
    """Draws the bar. Parts that have not changed stay the same objects, so that they are not uploaded again."""

    def __init__(self) -> None:
        self._plate, self._rest, self._played = (
            one_pixel(srgba) for srgba in ((*PLATE_SRGBA[:3], 210), REST_SRGBA, TEXT_SRGBA)
        )
        self._text: tuple[str, float, Image] | None = None
        self._last: tuple[tuple[Moment, Screen], tuple[Overlay, ...]] | None = None

    def overlays(self, moment: Moment, screen: Screen) -> tuple[Overlay, ...]:
        """The bar's parts: the same objects as before where nothing has changed."""
        asked = moment, screen
        if self._last is None or self._last[0] != asked:
            self._last = asked, self._drawn(*asked)
        return self._last[1]

    def _drawn(self, moment: Moment, screen: Screen) -> tuple[Overlay, ...]:
        bar = bar_at(screen, moment.duration_s)
        line = max(1, screen.px(LINE_PT))
        top = screen.size[1] - bar.height
        middle = top + bar.height // 2
        line_top = middle - line // 2
        share = min(1.0, max(0.0, moment.time_s / moment.duration_s)) if moment.duration_s > 0 else 0.0
        at = round(bar.left + share * (bar.right - bar.left))
        text = self._written(text_of(moment, _is_wide(screen)), screen.content_scale)
        knob = _knob(screen.px(KNOB_PT))
        return (
            Overlay(self._plate, 0, top, (screen.size[0], bar.height)),
            Overlay(text, screen.px(GAP_PT), middle - text.shape[0] // 2),
            Overlay(self._rest, bar.left, line_top, (bar.right - bar.left, line)),
            Overlay(self._played, bar.left, line_top, (max(1, at - bar.left), line)),
            Overlay(knob, at - knob.shape[1] // 2, middle - knob.shape[0] // 2),
        )

    def _written(self, text: str, content_scale: float) -> Image:
        if self._text is None or self._text[:2] != (text, content_scale):
            self._text = text, content_scale, _writing(text, content_scale)
        return self._text[2]


def text_of(moment: Moment, is_wide: bool) -> str:
    """The position, with tenths of seconds while it stands still; in a wide window also frame, speed and loop."""
    still = moment.frame is not None
    parts = [f"{clock(moment.time_s, still)} / {clock(moment.duration_s, still)}"]
    if is_wide:
        parts += [f"frame {moment.frame}"] if still else []
        parts += [" ".join([f"{moment.speed:g}x"] * (moment.speed != 1) + ["loop"] * moment.loops)]
    return "   ".join(part for part in parts if part)


def clock(time_s: float, with_tenths: bool) -> str:
    """Minutes and seconds, rounded down."""
    tenths = int(time_s * 10 + 1e-6)
    minutes, seconds = divmod(tenths // 10, 60)
    return f"{minutes}:{seconds:02d}" + (f".{tenths % 10}" if with_tenths else "")


@lru_cache(maxsize=2)
def _knob(diameter: int) -> Image:
    """(h, w, 4) uint8: a disc with smooth edges."""
    side = SUPERSAMPLING * diameter
    disc = PillowImage.new("L", (side, side))
    ImageDraw.Draw(disc).ellipse((0, 0, side - 1, side - 1), fill=255)
    picture = np.empty((diameter, diameter, 4), np.uint8)
    picture[..., :3] = TEXT_SRGBA[:3]
    picture[..., 3] = np.asarray(disc.resize((diameter, diameter), PillowImage.Resampling.BOX))
    return frozen_view(picture)


def _writing(text: str, content_scale: float) -> Image:
    """(h, w, 4) uint8: the text without a background."""
    font_px = FONT_PT * content_scale
    # It begins where the text does, as nothing reaches far out of digits.
    ink = np.asarray(text_ink(text, font_px, round(1.4 * font_px)))[:, bleed_px(font_px) :]
    picture = np.empty((*ink.shape, 4), np.uint8)
    picture[..., :3] = TEXT_SRGBA[:3]
    picture[..., 3] = ink
    return frozen_view(picture)
