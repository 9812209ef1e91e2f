"""Continues ground that repeats itself across a hole: checks, tiles, bricks, weaves and prints.

The pattern inside the hole is the ground beside it, shifted by a vector of the pattern's lattice. The median over
several shifts is taken, as a single one may bring a stain or a fold, with the fine texture of one of them. (He and Sun,
"Statistics of patch offsets for image completion", ECCV 2012, choose one shift for every pixel.)
"""

from itertools import combinations
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Mask, cross_2d
from ashe_live.render.cover.inpainting.masked import HOLE_FROM, KNOWN_FROM, Box, blurred_within, box_around, reduced

Indices = NDArray[np.intp]
# Of the lattice.
MOST_CONTRASTS = 3.0  # contrast is clipped at this multiple of its median, lest a glint outweighs all ground
REPEATS = 0.22  # least correlation of the ground with itself, shifted; that of a table of white tiles is 0.4
LEAST_OVERLAP = 0.15  # least share of the visible ground that overlaps itself when shifted
APART_PX = 3  # least distance between two peaks
NOT_ALONG = 0.35  # least sine of the angle between a cell's two shifts: grain and joints repeat in one direction only
MOST_PEAKS = 16  # number of peaks among which a cell is sought
AS_CLEAR = 0.8  # the smallest cell with at least this share of the best cell's correlation is chosen
FARTHEST = 4  # steps of the lattice, in both directions
# Of what is continued by it. "Sides" below is the length of a side of the marker.
SIDE_PX = 26.0  # length of a side in the coarse picture, in which shifts are found
LEVEL_SIDES = 0.2  # standard deviation of a blur that removes the pattern, and keeps sheen and folds
MOST_SHIFTS = 24  # number used: those by which the ground beside the hole continues best
BESIDE_SIDES = 0.5  # width of that ground
FEATHER_SIDES = 0.15  # distance from the border of usable ground at which its weight reaches 1
LEAST_WEIGHT = 0.1  # from which it is used at all
ALIKE_SIDES = 0.1  # standard deviation of a blur of the misfit by which the shift for fine texture is chosen
FINE_SIDES = 0.02  # standard deviation of the blur that separates fine texture


class Pattern(NamedTuple):
    """The ground as its pattern predicts it, in the hole and beside it."""

    contrast: Float32  # (n, n, 3) over the ground's level
    is_there: Mask  # (n, n)


def pattern_of(contrast: Float32, trusted: Mask, hole: Mask, side_px: float) -> Pattern | None:
    """The ground's pattern, or None if it does not repeat, or in one direction only.

    contrast: (n, n, 3) detail over the ground's level, so that a pattern in the shade is like that in the light.
    trusted: (n, n) where it is that of the ground. hole: (n, n) where the pattern is wanted. side_px: the marker's
    side.
    """
    n = len(trusted)
    size = min(n, round(n * SIDE_PX / side_px))
    scale = n / size
    coarse = reduced(np.where(trusted[..., None], contrast, 0), size)
    share, hole_share = reduced(trusted, size), reduced(hole, size)
    seen = np.asarray(share > KNOWN_FROM)
    structure = _structure_of(coarse, seen, LEVEL_SIDES * SIDE_PX)
    shifts = _repeated_shifts(structure, seen)
    if not len(shifts):
        return None
    around = box_around(hole_share > HOLE_FROM, round(BESIDE_SIDES * SIDE_PX))
    alike = np.array([_correlation(structure, seen, around, shift) for shift in shifts])
    kept = np.argsort(-alike)[: min(MOST_SHIFTS, int((alike > REPEATS).sum()))]
    if not len(kept):
        return None
    box = box_around(hole, round(FEATHER_SIDES * side_px))
    pattern, is_there = np.zeros_like(contrast), np.zeros_like(trusted)
    pattern[box], is_there[box] = _moved_into(box, contrast, trusted, shifts[kept] * scale, side_px)
    return Pattern(pattern, is_there)


def _structure_of(contrast: Float32, seen: Mask, level_px: float) -> Float32:
    """(m, m, 3) of the ground without what changes slowly, and with nothing that stands out by itself.

    contrast: (m, m, 3) of the ground, where it is seen (m, m). level_px: standard deviation of a blur that leaves sheen
    and folds, and no pattern.
    """
    shown = np.where(seen[..., None], contrast - blurred_within(contrast, seen.astype(np.float32), level_px), 0)
    strength = np.linalg.norm(shown, axis=2)
    most = MOST_CONTRASTS * float(np.median(strength[seen])) if seen.any() else 0.0
    return np.asarray(shown * np.minimum(1, most / np.maximum(strength, 1e-9))[..., None], np.float32)


def _repeated_shifts(structure: Float32, seen: Mask) -> Float:
    """(k, 2) shifts, x and y in pixels, of a lattice by which the ground (m, m, 3) repeats; (0, 2) where it does not.

    seen: (m, m) where it is seen.
    """
    weight = seen.astype(np.float64)
    overlap = _correlated(weight, weight) / max(weight.sum(), 1)
    alike = np.where(overlap > LEAST_OVERLAP, _autocorrelation(structure.astype(np.float64), weight), 0.0)
    is_peak = (alike == cv2.dilate(alike, np.ones((2 * APART_PX + 1,) * 2))) & (alike > REPEATS)
    is_peak[[0, -1]] = is_peak[:, [0, -1]] = False
    peaks = np.array([_summit(alike, *each) for each in np.argwhere(is_peak)]).reshape(-1, 2) - len(seen)
    far = np.linalg.norm(peaks, axis=1) > APART_PX
    peaks, strength = peaks[far], alike[is_peak][far]
    # A far shift is compared by less ground, and its neighbours in the lattice, which confirm a cell, lie outside.
    likeliest = np.argsort(-strength * overlap[is_peak][far])[:MOST_PEAKS]
    cell = _cell(peaks, strength, likeliest)
    if cell is None:
        return np.zeros((0, 2))
    steps = np.mgrid[-FARTHEST : FARTHEST + 1, -FARTHEST : FARTHEST + 1].reshape(2, -1).T
    nodes = [_near(peaks, strength, at) for at in steps @ cell]
    return np.asarray(peaks[sorted({at for at in nodes if at is not None})])


def _autocorrelation(structure: Float, seen: Float) -> Float:
    """(2 m + 1, 2 m + 1) correlation of the ground with itself, moved by rows and columns from -m to m."""
    product = sum(_correlated(each, each) for each in np.moveaxis(structure, 2, 0))
    energy = _correlated(np.square(structure).sum(axis=2), seen)
    return np.asarray(2 * product / np.maximum(energy + energy[::-1, ::-1], 1e-9))


def _cell(peaks: Float, strength: Float, sought: Indices) -> Float | None:
    """(2, 2) two of the shifts `sought` whose sum and difference are shifts as well; the smallest clear cell."""
    cells = []
    for one, other in combinations(sought, 2):
        a, b = peaks[one], peaks[other]
        area = abs(float(cross_2d(a, b)))
        corners = [_near(peaks, strength, each) for each in (a + b, a - b)]
        if area > NOT_ALONG * np.linalg.norm(a) * np.linalg.norm(b) and None not in corners:
            cells.append((min(strength[[one, other, *corners]]), area, np.array([a, b])))
    if not cells:
        return None
    clearest = max(together for together, _, _ in cells)
    clear = [(area, cell) for together, area, cell in cells if together > AS_CLEAR * clearest]
    return min(clear, key=lambda each: each[0])[1]


def _near(peaks: Float, strength: Float, at: Float) -> int | None:
    """The number of the peak (k, 2) at a node of the lattice, the stronger one of two."""
    near = np.flatnonzero(np.linalg.norm(peaks - at, axis=1) < APART_PX)
    return int(near[strength[near].argmax()]) if len(near) else None


def _summit(heights: Float, row: int, column: int) -> Float:
    """(2,) x and y of a peak to a part of a pixel: the tops of the parabolas through it and its neighbours."""
    there = []
    for low, high in (
        (heights[row, column - 1], heights[row, column + 1]),
        (heights[row - 1, column], heights[row + 1, column]),
    ):
        bend = float(low + high - 2 * heights[row, column])
        there.append(0.5 * float(low - high) / bend if bend < 0 else 0.0)
    return np.array([column, row]) + np.clip(there, -0.5, 0.5)


def _correlated(one: Float, other: Float) -> Float:
    """(2 m + 1, 2 m + 1) sums of one (m, m) times the other (m, m), moved by rows and columns from -m to m."""
    m = len(one)
    size = cv2.getOptimalDFTSize(2 * m + 1)
    spectrum = np.conj(np.fft.rfft2(one, (size, size))) * np.fft.rfft2(other, (size, size))
    around = np.arange(-m, m + 1)
    return np.asarray(np.fft.irfft2(spectrum, (size, size))[np.ix_(around, around)])


def _correlation(structure: Float32, seen: Mask, box: Box, shift: Float) -> float:
    """Correlation of ground and shifted ground in a box; 0 if too little of both is seen."""
    moved, there = (_moved(each, shift, box) for each in (structure, seen.astype(np.float32)))
    both = seen[box] & (there > 0.99)
    if both.sum() < LEAST_OVERLAP * seen[box].sum():
        return 0.0
    here, moved = structure[box][both], moved[both]
    return 2 * float((here * moved).sum()) / max(float(np.square(here).sum() + np.square(moved).sum()), 1e-9)


def _moved(picture: Float32, shift: Float, box: Box) -> Float32:
    """The picture's values at the pixels of a box moved by `shift` (x, y); 0 beyond the picture's border."""
    size = box[1].stop - box[1].start, box[0].stop - box[0].start
    to_source = np.column_stack([np.eye(2), (shift[0] + box[1].start, shift[1] + box[0].start)])
    return np.asarray(
        cv2.warpAffine(picture, to_source, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP), np.float32
    )


def _moved_into(box: Box, contrast: Float32, trusted: Mask, shifts: Float, side_px: float) -> tuple[Float32, Mask]:
    """The ground moved into a box of the picture by shifts (k, 2): their median, and where there is one.

    The median of all that show a place, as shadows and things lie on some. It gets the fine texture of the shift
    that is most like it around there, and farthest inside its ground.
    """
    inside = cv2.copyMakeBorder(trusted.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    inside = cv2.distanceTransform(inside, cv2.DIST_L2, 5)[1:-1, 1:-1] / np.float32(FEATHER_SIDES * side_px)
    moved = np.array([_moved(contrast, shift, box) for shift in shifts])
    weights = np.array([_moved(np.minimum(inside, 1), shift, box) for shift in shifts])
    is_seen: Mask = weights > LEAST_WEIGHT
    if not is_seen.any():
        return np.zeros_like(moved[0]), is_seen[0]
    median = _median(moved, is_seen)
    squares = np.square(moved - median).sum(axis=3)
    unlike = np.array([cv2.GaussianBlur(each, (0, 0), ALIKE_SIDES * side_px) for each in squares])
    fitness = np.where(is_seen, weights / (unlike + max(float(np.median(unlike[is_seen])), 1e-9)), 0)
    # Fine texture alone of each of them, so that there is no step from one to the next.
    fine = np.array([each - cv2.GaussianBlur(each, (0, 0), FINE_SIDES * side_px) for each in moved - median])
    finer = np.take_along_axis(fine, fitness.argmax(axis=0)[None, ..., None], 0)[0]
    return np.asarray(median + finer, np.float32), np.asarray(is_seen.any(axis=0))


def _median(several: Float32, is_seen: Mask) -> Float32:
    """(h, w, 3) of several (k, h, w, 3) where they are seen (k, h, w); 0 where none is."""
    count = is_seen.sum(axis=0)
    ordered = np.sort(np.where(is_seen[..., None], several, np.inf), axis=0)
    lower, upper = (
        np.take_along_axis(ordered, np.maximum(at, 0)[None, ..., None], 0)[0] for at in ((count - 1) // 2, count // 2)
    )
    is_there = count[..., None] > 0
    return np.asarray(0.5 * (np.where(is_there, lower, 0) + np.where(is_there, upper, 0)), np.float32)
