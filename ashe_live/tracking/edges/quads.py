"""Finds dark quadrilaterals on lighter surroundings, which may be black squares in perspective."""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image, distinct
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.square import side_lengths_px

# Window and offset of the adaptive threshold. Chosen by photos and renders, all of whose squares one threshold finds;
# the small window is for small squares beside a shadow.
WINDOW_PX, SMALL_WINDOW_PX = 51, 15
DARKER_BY = 10
MIN_SIDE_PX = 12
# Scaled about its centre by the first factor, a square's outline runs on paper; by the second, on ink.
PAPER_AT, RIM_AT = 1.2, 0.82
# Where paper is even if hardly any is left around the square, and the grey level from which on it may be clipped: a
# camera's white balance, or its curve, may take as much from it.
NARROW_PAPER_AT, CLIPPED_LEVEL = 1.1, 220
# The paper's grey level is more than MIN_RATIO times the ink's plus MIN_DIFFERENCE.
MIN_RATIO, MIN_DIFFERENCE = 1.15, 5.0
# Ink has less than this share of the light of the brightest thing near it: less than paper has in a shadow that leaves
# more than that of the light. And the window, in pixels, that is near enough to tell ink's border.
INK_SHARE, NEAR_WINDOW_PX = 1 / 9, 25
# A side may bulge by this share of the perimeter before it counts as two.
MAX_BULGE = 0.04
# Where nothing else is found, the whole picture is parted at levels that each are so many times the one before: ink and
# paper in one light lie farther apart.
LEVELS = 12.0 * 1.4 ** np.arange(9)
# Least side of a square that something lies over, and least share of it that is still enclosed by what is seen of it.
MIN_COVERED_SIDE_PX, LEAST_ENCLOSED = 16.0, 0.85
# The convex hull of an outline is a polygon of corners that differ from it by this share of its perimeter.
# A square has at most so many with two corners cut off; things of any shape, of which there are many, have more.
HULL_BULGE, MOST_CORNERS = 0.02, 6
# A side is prolonged by at most this many of its lengths to where it meets the one after the next.
MOST_PROLONGED = 1.5
# For each grey level of the brightest thing, the level below which something near it may be ink.
LEVEL_OF_INK = np.searchsorted(LINEAR_FROM_SRGB_8BIT, INK_SHARE * LINEAR_FROM_SRGB_8BIT).astype(np.uint8)


def dark_quads(grey: Image, min_side_px: float = MIN_SIDE_PX, window_px: int = WINDOW_PX) -> list[Float]:
    """Corners (4, 2), clockwise in the picture, of every convex dark quadrilateral in `grey` (h, w).

    Its longer extent in x or y is at least `min_side_px`, its shortest side half of that.

    Only outer outlines count, as the local threshold turns a large black square into a ring, whose hole is no square.
    """
    if min(grey.shape) < min_side_px / 2:
        return []
    dark = cv2.adaptiveThreshold(
        cv2.blur(grey, (3, 3)), 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, window_px, DARKER_BY
    )
    return _quads(np.asarray(dark, dtype=np.uint8), min_side_px)


def ink_quads(grey: Image, min_side_px: float = MIN_SIDE_PX) -> list[Float]:
    """As `dark_quads`, of what is as dark beside its surroundings as ink, which paper in a shadow is not.

    Where a deep shadow's edge crosses a marker, paper in the shade is darker than the mean of both around it.
    """
    if min(grey.shape) < min_side_px / 2:
        return []
    return _quads(ink_in(grey, NEAR_WINDOW_PX), min_side_px)


def ink_in(grey: Image, window_px: int) -> Image:
    """(h, w) 255 where `grey` (h, w) is as dark as ink beside the brightest within half of `window_px`, 0 elsewhere."""
    smooth = np.asarray(cv2.blur(grey, (3, 3)), dtype=np.uint8)
    brightest = cv2.dilate(smooth, np.ones((window_px, window_px), np.uint8))
    return np.asarray(cv2.compare(smooth, cv2.LUT(brightest, LEVEL_OF_INK), cv2.CMP_LT), dtype=np.uint8)


def half_seen_quads(grey: Image, min_side_px: float = MIN_SIDE_PX) -> list[Float]:
    """As `dark_quads`, of squares over whose outline something lies, and of those wholly in a shadow that ends near by.

    A finger over a side opens the outline, but its convex hull remains. Where a shadow ends on the paper around a
    print, this is the outline to a threshold that asks what is near; in the shadow alone some level is between ink and
    paper. For pictures in which nothing else is found.
    """
    if min(grey.shape) < min_side_px / 2:
        return []
    smooth = cv2.blur(grey, (3, 3))
    darkest, brightest, _, _ = cv2.minMaxLoc(smooth)
    if brightest - darkest < DARKER_BY:
        return []
    near = cv2.adaptiveThreshold(
        smooth, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, SMALL_WINDOW_PX, DARKER_BY
    )
    quads = _quads(np.asarray(near, dtype=np.uint8), min_side_px)
    levels = LEVELS[(darkest < LEVELS) & (brightest >= LEVELS)]
    for dark in (ink_in(grey, NEAR_WINDOW_PX), *(cv2.compare(smooth, level, cv2.CMP_LT) for level in levels)):
        for outline in _outlines(np.asarray(dark, dtype=np.uint8)):
            quad = _quad(outline, min_side_px)
            if quad is None:
                quad = _hull_quad(outline, max(min_side_px, MIN_COVERED_SIDE_PX))
            if quad is not None:
                quads.append(quad)
    return quads


def _quads(dark: Image, min_side_px: float) -> list[Float]:
    """The quadrilaterals among the outlines of what is not 0 in `dark` (h, w)."""
    quads = (_quad(outline, min_side_px) for outline in _outlines(dark))
    return [quad for quad in quads if quad is not None]


def _outlines(dark: Image) -> list[NDArray[Any]]:
    """The outer outlines (n, 1, 2) of what is not 0 in `dark` (h, w)."""
    outlines, hierarchy = cv2.findContours(dark, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    if hierarchy is None:
        return []
    parents = hierarchy.reshape(-1, 4)[:, 3]
    return [outline for outline, parent in zip(outlines, parents, strict=True) if parent < 0]


def _quad(outline: NDArray[Any], min_side_px: float) -> Float | None:
    if len(outline) < 4 or max(cv2.boundingRect(outline)[2:]) < min_side_px:
        return None
    polygon = cv2.approxPolyDP(outline, MAX_BULGE * cv2.arcLength(outline, True), True)
    if len(polygon) != 4 or not cv2.isContourConvex(polygon):
        return None
    return _clockwise(polygon.reshape(4, 2).astype(np.float64), min_side_px)


def _hull_quad(outline: NDArray[Any], min_side_px: float) -> Float | None:
    """The quadrilateral around the convex hull of an outline with a notch, a gap or a corner cut off; None if that
    fills too little of it.
    """
    _, _, width, height = cv2.boundingRect(outline)
    if max(width, height) < min_side_px or min(width, height) < min_side_px / 2:
        return None
    hull = cv2.convexHull(outline)
    polygon = cv2.approxPolyDP(hull, HULL_BULGE * cv2.arcLength(hull, True), True).reshape(-1, 2)
    if not 4 <= len(polygon) <= MOST_CORNERS:
        return None
    corners: list[tuple[float, float]] | None = [(float(x), float(y)) for x, y in polygon]
    while corners is not None and len(corners) > 4:
        corners = _with_a_corner_less(corners)
    if corners is None:
        return None
    quad = np.array(corners)
    if cv2.contourArea(hull) < LEAST_ENCLOSED * cv2.contourArea(quad.astype(np.float32)):
        return None
    return _clockwise(quad, min_side_px)


def _with_a_corner_less(corners: list[tuple[float, float]]) -> list[tuple[float, float]] | None:
    """A convex polygon one of whose sides, where a corner is cut off, is replaced by it; None where there is none.

    It is the side beyond which its neighbours meet around the least area.
    """
    # Plain numbers, as so few corners are too few for arrays to be fast.
    count, best = len(corners), None
    for first in range(count):
        (x0, y0), (x1, y1) = corners[first - 1], corners[first]
        (x2, y2), (x3, y3) = corners[(first + 1) % count], corners[(first + 2) % count]
        before, side, beyond = (x1 - x0, y1 - y0), (x2 - x1, y2 - y1), (x3 - x2, y3 - y2)
        turn = before[0] * beyond[1] - before[1] * beyond[0]
        way = (side[0] * beyond[1] - side[1] * beyond[0]) / turn if turn else -1.0
        added = abs(way * (before[0] * side[1] - before[1] * side[0]))
        if 0 <= way < MOST_PROLONGED and (best is None or added < best[0]):
            best = added, first, (x1 + way * before[0], y1 + way * before[1])
    if best is None:
        return None
    _, first, corner = best
    after = (first + 1) % count
    return [corner if number == first else each for number, each in enumerate(corners) if number != after]


def _clockwise(corners: Float, min_side_px: float) -> Float | None:
    """`corners` (4, 2) clockwise in the picture; None where a side is too short."""
    if side_lengths_px(corners).min() < min_side_px / 2:
        return None
    # The picture's y points down, so a positive area is clockwise to the eye.
    return corners if cv2.contourArea(corners.astype(np.float32), oriented=True) > 0 else corners[::-1].copy()


def on_lighter(grey: Image, quads: list[Float], is_clipped: bool = False) -> list[Float]:
    """Those of `quads` (4, 2) in (h, w) uint8 whose rim is much darker than their surroundings, as ink on paper is.

    is_clipped: those on surroundings that are as bright as a picture can be, of which ink may be little darker, as a
    lens's haze lies over it. There paper is as bright as ground, and may be narrow; every side must be darker.
    """
    if not quads:
        return []
    corners = np.array(quads)
    centres = corners.mean(axis=1, keepdims=True)
    places = np.array((0.2, 0.5, 0.8))[:, None]
    sides = (corners[:, :, None] * (1 - places) + np.roll(corners, -1, axis=1)[:, :, None] * places).reshape(-1, 12, 2)

    def levels(scale: float) -> Float:
        x, y = np.moveaxis((centres + scale * (sides - centres)).astype(np.float32), 2, 0)
        samples = cv2.remap(grey, x.copy(), y.copy(), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return samples.astype(np.float64)

    if is_clipped:
        paper, rim = (levels(scale).reshape(-1, 4, 3).mean(axis=2) for scale in (NARROW_PAPER_AT, RIM_AT))
        is_ink = ((paper > rim + MIN_DIFFERENCE) & (paper >= CLIPPED_LEVEL)).all(axis=1)
    else:
        is_ink = levels(PAPER_AT).mean(axis=1) > MIN_RATIO * levels(RIM_AT).mean(axis=1) + MIN_DIFFERENCE
    return [quad for quad, keep in zip(quads, is_ink, strict=True) if keep]


def without_repeats(quads: list[Float]) -> list[Float]:
    """The quads (4, 2) without those that lie where an earlier one does."""

    def lies_on(quad: Float, other: Float) -> bool:
        return bool(np.abs(other.mean(axis=0) - quad.mean(axis=0)).max() <= np.ptp(other, axis=0).max() / 4)

    return distinct(quads, lies_on)
