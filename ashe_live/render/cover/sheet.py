"""Finds the marker's sheet in the plane: the paper around the square, whatever its size, and the sheet's shadow."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ashe_live.core.arrays import Float32, Mask
from ashe_live.core.colour import REC709_LUMINANCE

# Names that end in SIDES are lengths in sides of the marker.
LEAST_HALF_SIDES = 0.5 + 0.1  # of the square and a margin, used where paper cannot be told from the ground
MOST_HALF_SIDES = 2.3  # from the marker's middle; the corners of an A4 page with a marker of 8 cm are within it
PAGE_HALF_SIDES = 1.0  # what reaches farther is a page, whose unseen end may be anywhere
RING_SIDES = (0.55, 0.6)  # distances from the marker's middle between which there is paper
SAME_LOG = 0.35  # largest difference of paper from that ring, in logarithms of linear RGB
# Largest difference between the sums of opposite sides' logarithms of light, along x and along y, of paper whose light
# changes evenly.
UNEVEN_LOG = 0.05
CONVEX = 0.85  # least share of its convex hull that a sheet fills
# If ground of the colour of paper touches the sheet, each side is sought by itself, along lines that begin within
# ALONG_SIDES of its middle: paper ends where it differs by OTHER_LOG (a logarithm) over LASTING_SIDES, along a straight
# line from which half of the places are less than STRAIGHT_SIDES away, as outlines of things seldom are.
ALONG_SIDES, OTHER_LOG, LASTING_SIDES, STRAIGHT_SIDES = 0.45, 0.2, 0.08, 0.015
# If no side is seen, the edge of white paper on a white table is a faint step, over LASTING_SIDES as well, or else a
# fine line, over FAINT_SIDES: in the median of the lines FAINT_LOG more than what the paper differs from itself by.
FAINT_LOG, FAINT_SIDES = 0.03, 0.02
LINE_SIDES = 0.04  # width of printed lines, which part the paper
EDGE_SIDES = 0.05  # width of a sheet's rim with its curl and the picture's blur
THROWN_SIDES = 0.22  # reach of a curled sheet's own shadow
WIDE_SIDES = 0.02  # radius of the largest dark speckles of the ground
DARKER = 0.75  # brightness of that shadow over that of the ground around it, at most
THING_SIDES = 0.06  # radius of discs that fit into what is dark beyond that reach as well: a thing, or its shadow


@dataclass(frozen=True, slots=True, eq=False)
class SheetMasks:
    """What is covered of a rectified picture (n, n) of the plane."""

    mask: Mask  # (n, n) the sheet with its rim and its own shadow, or the square with a margin
    surroundings: Mask  # (n, n) what goes on under the cover: the page alone, if it is the square on a page


def sheet_of(lit: Float32, is_ground: Mask, side_px: float) -> SheetMasks:
    """The sheet in a rectified picture (n, n, 3) of the plane, linear RGB.

    is_ground: (n, n) seen, lit alike. side_px: the marker's side; the marker is in the middle. Where the paper cannot
    be told from the ground, it is a rectangle, or the square with a margin if none of its sides is seen.
    """
    x, y = _places(len(lit), side_px)
    away = np.maximum(np.abs(x), np.abs(y))
    least = away < LEAST_HALF_SIDES
    ring = (away > RING_SIDES[0]) & (away < RING_SIDES[1])
    unlike = np.abs(_from_paper(lit, ring, x, y)).max(axis=2)
    alike = (unlike < SAME_LOG) & (away < MOST_HALF_SIDES) | least
    opened = cv2.morphologyEx(alike.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2)))
    paper_there = _joined(cv2.morphologyEx(opened, cv2.MORPH_CLOSE, _disc(LINE_SIDES * side_px)) > 0, least)
    sheet, surroundings = _hull(paper_there), np.ones_like(least)
    if sheet[away > MOST_HALF_SIDES - 2 / side_px].any() or paper_there.sum() < CONVEX * sheet.sum():
        rectangle = _rectangle(np.where(is_ground, unlike, 0), float(np.median(unlike[ring])), side_px)
        sheet = least | rectangle
        # Else colours and lines of the ground beyond the page would be continued on it.
        if not rectangle.any() and paper_there[is_ground & (away > PAGE_HALF_SIDES)].any():
            surroundings = cv2.erode(paper_there.astype(np.uint8), _disc(EDGE_SIDES * side_px)) > 0
    brightness = lit @ REC709_LUMINANCE.astype(np.float32)
    return SheetMasks(_with_own_shadow(sheet, brightness, is_ground, side_px), surroundings)


def _places(size: int, side_px: float) -> tuple[Float32, Float32]:
    """(n, n) x and y in sides of the marker."""
    steps = ((np.arange(size) + 0.5 - size / 2) / side_px).astype(np.float32)
    x, y = np.meshgrid(steps, -steps)
    return x, y


def _from_paper(lit: Float32, ring: Mask, x: Float32, y: Float32) -> Float32:
    """(n, n, 3) logarithm of light over that of the paper in the ring (n, n), whose change from side to side goes on.

    So the fall of a lamp's light, by which ground is unlike paper farther away, ends no sheet.
    """
    logs = np.log(np.maximum(lit, 1e-3))
    near, far = RING_SIDES
    right, left, above, below = (np.median(logs[ring & (outwards > near)], axis=0) for outwards in (x, -x, y, -y))
    # What changes evenly has the same sum along both axes; a shadow on one side does not.
    if np.abs(right + left - above - below).max() < UNEVEN_LOG:
        across, up = (np.clip(z, -1, 1)[..., None] / (near + far) for z in (x, y))
        logs = logs - across * (right - left) - up * (above - below)
    return np.asarray(logs - np.median(logs[ring], axis=0), np.float32)


def _with_own_shadow(sheet: Mask, brightness: Float32, is_ground: Mask, side_px: float) -> Mask:
    """(n, n) the sheet with its rim, and with the shadow that its curled edges cast on the ground beside it."""
    grown = cv2.dilate(sheet.astype(np.uint8), _disc(EDGE_SIDES * side_px)) > 0
    near = cv2.dilate(sheet.astype(np.uint8), _disc(THROWN_SIDES * side_px)) > 0
    beside = near & ~grown & is_ground
    if not beside.any():
        return grown
    dark = ~sheet & (brightness < DARKER * np.median(brightness[beside]))
    dark &= near & ~_reaching_beyond(dark, near, side_px)
    touching = cv2.morphologyEx((dark | grown).astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3)))
    # Between the sheet and a wide shadow may lie a rim of paper, where the paper is not told from the ground.
    wide = cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_OPEN, _disc(WIDE_SIDES * side_px))
    reaching = cv2.morphologyEx(wide | grown.astype(np.uint8), cv2.MORPH_CLOSE, _disc(EDGE_SIDES * side_px))
    thrown = _joined((touching | reaching) > 0, sheet)
    return grown | (cv2.dilate(thrown.astype(np.uint8), _disc(EDGE_SIDES * side_px)) > 0)


def _reaching_beyond(dark: Mask, near: Mask, side_px: float) -> Mask:
    """(n, n) the broad parts of what is dark that go on where the sheet throws no shadow, beyond `near`; with rims."""
    disc = _disc(THING_SIDES * side_px)
    broad = cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_OPEN, disc) > 0
    beyond = _joined(broad, broad & ~near)
    return dark & (cv2.dilate(beyond.astype(np.uint8), disc) > 0)


def _rectangle(unlike: Float32, of_paper: float, side_px: float) -> Mask:
    """(n, n) the rectangle that ends where most lines outwards leave the paper; empty if none of its sides is seen.

    unlike: (n, n) difference from the paper, 0 where no ground is seen; of_paper: the paper's own. A side that is not
    seen is taken to be as far away as the others of a small sheet; of a page only a part would be covered by that, and
    it is empty.
    """
    n = len(unlike)
    across = [_lines_across(np.rot90(unlike, -turns), side_px) for turns in range(4)]  # right, above, left, below
    ends = [_clear_end(lines, side_px) for lines in across]
    for length in (LASTING_SIDES, FAINT_SIDES):
        if all(end is None for end in ends):
            ends = [_faint_end(lines, of_paper, length, side_px) for lines in across]
    known = [end for end in ends if end is not None]
    mask = np.zeros(unlike.shape, np.bool_)
    is_open_page = len(known) < len(ends) and max(known, default=0) > (PAGE_HALF_SIDES - RING_SIDES[1]) * side_px
    if known and not is_open_page:
        first, usual = n // 2 + round(RING_SIDES[1] * side_px), round(float(np.median(known)))
        right, above, left, below = (first + (usual if end is None else end) for end in ends)
        mask[n - above : below, n - left : right] = True
    return mask


def _lines_across(unlike: Float32, side_px: float) -> Float32:
    """(lines, pixels) outwards to the right, from the paper beside the square to as far as a sheet may reach."""
    middle, along, lasting = len(unlike) // 2, round(ALONG_SIDES * side_px), max(1, round(LASTING_SIDES * side_px))
    first, last = (middle + round(sides * side_px) for sides in (RING_SIDES[1], MOST_HALF_SIDES))
    return unlike[middle - along : middle + along, first : last + lasting]


def _clear_end(lines: Float32, side_px: float) -> int | None:
    """Pixels along the lines (k, p) to where the paper ends; None where most do not end, or not on a straight line."""
    length = max(1, round(LASTING_SIDES * side_px))
    end = _first_lasting(np.median(lines, axis=0) > OTHER_LOG, length)
    if end is None:
        return None
    lasts = np.asarray(sliding_window_view(lines > OTHER_LOG, length, axis=1).all(axis=2))
    ended = np.flatnonzero(lasts.any(axis=1))
    if 2 * len(ended) < len(lines):  # speckles, that differ from the paper in half of all places, but nowhere for long
        return None
    places = np.column_stack([ended, lasts[ended].argmax(axis=1)]).astype(np.float32)
    along_x, along_y, x, y = cv2.fitLine(places, cv2.DIST_L1, 0, 0.01, 0.01).ravel()
    away = np.abs((places - (x, y)) @ (-along_y, along_x))
    return end if np.median(away) < max(1.0, STRAIGHT_SIDES * side_px) else None


def _faint_end(lines: Float32, of_paper: float, lasting_sides: float, side_px: float) -> int | None:
    """As `_clear_end`, where paper and ground are alike: beyond the end begins no other thing."""
    unlike = np.median(lines, axis=0)
    end = _first_lasting(unlike > of_paper + FAINT_LOG, max(1, round(lasting_sides * side_px)))
    beyond = round(LASTING_SIDES * side_px)
    return end if end is not None and unlike[min(end + beyond, len(unlike) - 1)] < OTHER_LOG else None


def _first_lasting(holds: Mask, length: int) -> int | None:
    """The first of `length` places (p,) one after another at which something holds."""
    lasts = sliding_window_view(holds, length).all(axis=1)
    return int(lasts.argmax()) if lasts.any() else None


def _joined(mask: Mask, seed: Mask) -> Mask:
    """The parts of `mask` that touch `seed`, which is part of it as a rule."""
    _, labels = cv2.connectedComponents((mask | seed).astype(np.uint8))
    return np.isin(labels, np.unique(labels[seed])) & (mask | seed)


def _hull(mask: Mask) -> Mask:
    hull = cv2.convexHull(cv2.findNonZero(mask.astype(np.uint8)))
    filled = np.zeros(mask.shape, np.uint8)
    cv2.fillConvexPoly(filled, hull, 1)
    return filled > 0


def _disc(radius: float) -> Any:  # (k, k) uint8, as OpenCV types it
    reach = max(1, round(radius))
    return cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
