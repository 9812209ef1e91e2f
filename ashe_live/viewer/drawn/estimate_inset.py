"""An estimate, shown beside the model: the frozen frame with masks and fitted body, the light rose; or its steps."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.drawing.answer import answer_picture, rose_picture
from ashe_live.render.scene import Overlay
from ashe_live.viewer.estimates.light_watch import NewAnswer

WIDTH = 0.32  # of the inset, as a fraction of the window's
STEPS_WIDTH = 0.45  # the most for the sheet of steps, likewise
SCALES = (1.0, 0.8, 0.6)  # the inset takes the largest of these at which it covers no model
MARGIN_PX = 8
# Sets the inset apart from the video around it.
BORDER_PX = 2
BORDER_BGR = (242, 246, 246)


class Span(NamedTuple):
    """Pixels of the framebuffer, from its left and top edges."""

    left: int
    top: int
    right: int
    bottom: int


class Corner(NamedTuple):
    """Where an inset stands at the right edge, and how large it is."""

    is_at_top: bool = False
    scale: float = 1.0


CORNERS = tuple(Corner(is_at_top, scale) for scale in SCALES for is_at_top in (False, True))


class _Drawn(NamedTuple):
    """An inset as it was drawn for an answer in a window."""

    answer: NewAnswer
    size: Size
    is_mirrored: bool
    corner: Corner
    overlays: tuple[Overlay, ...]


class EstimateInset:
    """The inset of the last answer: the same objects until it has to move out of the model's way."""

    def __init__(self) -> None:
        self._drawn: _Drawn | None = None
        self._full_sizes: list[Size] = []  # of the parts at full scale

    def overlays(
        self, answer: NewAnswer, size: Size, models: Span | None, is_mirrored: bool = False
    ) -> tuple[Overlay, ...]:
        """As `inset_overlays`, in the first of CORNERS where it covers no model; if in none, at the smallest size."""
        drawn = self._drawn
        if drawn is None or drawn.answer is not answer or (drawn.size, drawn.is_mirrored) != (size, is_mirrored):
            drawn = _drawn(answer, size, is_mirrored, Corner())
            self._full_sizes = [overlay.shown_size for overlay in drawn.overlays]
        if models is not None and self._covers(models, size, drawn.corner):
            free = (corner for corner in CORNERS if not self._covers(models, size, corner))
            corner = next(free, Corner(scale=SCALES[-1]))
            if corner != drawn.corner:
                drawn = _drawn(answer, size, is_mirrored, corner)
        self._drawn = drawn
        return drawn.overlays

    def _covers(self, models: Span, size: Size, corner: Corner) -> bool:
        sizes = [(round(corner.scale * width), round(corner.scale * height)) for width, height in self._full_sizes]
        return any(
            models.left < x + width and x < models.right and models.top < y + height and y < models.bottom
            for (width, height), (x, y) in zip(sizes, _stacked(sizes, size, corner.is_at_top), strict=True)
        )


def _drawn(answer: NewAnswer, size: Size, is_mirrored: bool, corner: Corner) -> _Drawn:
    return _Drawn(answer, size, is_mirrored, corner, inset_overlays(answer, size, is_mirrored, corner))


def inset_overlays(
    answer: NewAnswer, size: Size, is_mirrored: bool = False, corner: Corner = CORNERS[0]
) -> tuple[Overlay, ...]:
    """For a framebuffer of `size`.

    With the sheet of the steps that led to the answer, this sheet; else the answer alone, and the light rose beside it.
    The answer is mirrored as the window is; the sheet and the rose, which is a map, have words in them.
    """
    estimate, frozen, steps_bgr = answer.estimate, answer.frozen, answer.steps_bgr
    if steps_bgr is not None:
        fitted = _size_in(size, STEPS_WIDTH, steps_bgr.shape[1::-1], corner.scale)
        sheet = np.asarray(cv2.resize(steps_bgr, fitted, interpolation=cv2.INTER_AREA), np.uint8)
        return _in_corner([sheet], size, corner)
    picture = answer_picture(estimate, frozen, _size_in(size, WIDTH, frozen.frame.size, corner.scale)[0])
    picture = np.ascontiguousarray(picture[:, ::-1]) if is_mirrored else picture
    if not estimate.lights:
        return _in_corner([picture], size, corner)
    both = _in_corner([picture, rose_picture(estimate, frozen, picture.shape[0])], size, corner)
    is_whole = all(0 <= part.top_px - MARGIN_PX <= size[1] - part.shown_size[1] - 2 * MARGIN_PX for part in both)
    return both if is_whole else _in_corner([picture], size, corner)  # a low window has no room for the rose


def _size_in(size: Size, most: float, picture: Size, scale: float) -> Size:
    """The size of a picture that is to be `most` of the window wide, or as high as it has room for, times `scale`."""
    (width, height), around = picture, 2 * (MARGIN_PX + BORDER_PX)
    scale *= max(0.0, min(most * size[0] / width, (size[1] - around) / height))
    return max(1, round(scale * width)), max(1, round(scale * height))


def _in_corner(pictures_bgr: Sequence[Image], size: Size, corner: Corner) -> tuple[Overlay, ...]:
    """The pictures with frames around them: the first in the corner, the others in a column with it."""
    edge = BORDER_PX
    framed = []
    for picture in pictures_bgr:
        bgr = cv2.copyMakeBorder(picture, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=BORDER_BGR)
        framed.append(np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGBA), np.uint8))
    places = _stacked([(rgba.shape[1], rgba.shape[0]) for rgba in framed], size, corner.is_at_top)
    return tuple(Overlay(rgba, left, top) for rgba, (left, top) in zip(framed, places, strict=True))


def _stacked(sizes: Sequence[Size], size: Size, is_at_top: bool) -> list[tuple[int, int]]:
    """The left and top of parts of these sizes, stacked along the right edge from the corner on."""
    places, used = [], MARGIN_PX
    for width, height in sizes:
        places.append((size[0] - width - MARGIN_PX, used if is_at_top else size[1] - height - used))
        used += height + MARGIN_PX
    return places
