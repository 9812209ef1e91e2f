"""Continues ground that repeats itself across a hole: checks, tiles, bricks, weaves and prints.

The pattern inside the hole is the ground beside it, shifted by a vector of the pattern's lattice. The median over
several shifts is taken, as a single one may bring a stain or a fold, with the fine texture of one of them. (He and Sun,
"Statistics of patch offsets for image completion", ECCV 2012, choose one shift for every pixel.)
"""

from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.render.cover.lattice import LEAST_OVERLAP, REPEATS, repeated_shifts, structure_of
from ashe_live.render.cover.masked import HOLE_FROM, KNOWN_FROM, Box, box_around, reduced

# "Sides" below is the length of a side of the marker.
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
    structure = structure_of(coarse, seen, LEVEL_SIDES * SIDE_PX)
    shifts = repeated_shifts(structure, seen)
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
