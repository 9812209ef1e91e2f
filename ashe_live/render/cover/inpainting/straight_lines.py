"""Continues straight joints, seams and grain across a hole in the ground.

Copied patches would break such a line at the hole's border, where everybody sees it. The ground is turned so that the
lines of one direction are rows (those of the Radon transform). A row whose mean colour is the same on both sides of the
hole belongs to a line, and is drawn across. A person marks these structures in Sun, Yuan, Jia, Shum, "Image completion
with structure propagation", SIGGRAPH 2005.
"""

from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Float32, Mask, distinct
from ashe_live.render.cover.inpainting.masked import blurred_within
from ashe_live.render.cover.inpainting.turned_rows import GroundDetail, TurnedRows

# "Sides" below is the length of a side of the marker.
SIDE_PX, FINE_SIDE_PX = 26.0, 256.0  # length of a side in the pictures in which lines are found, and drawn
SMOOTH_PX = 0.8  # standard deviation of a blur that keeps lines thinner than a row from aliasing when they are turned
# Between the directions that are tried, around the best of them, and around that of a seam, which is drawn to a pixel.
STEP_DEG, FINER_STEP_DEG, FINEST_STEP_DEG = 1.0, 0.25, 0.1
# Two directions of lines differ by less than the first angle (grain winds) or by more than the second (joints cross).
# The shading of broad grain resembles bands in the directions between.
WAVY_DEG, CROSSING_DEG = 4.0, 30.0
NEAR_ROWS = 2  # rows of the coarse picture by which a line that is found there may be elsewhere
MOST_DIRECTIONS = 16  # examined one after the other, each without the lines found before
SEAMS = 2  # number of these whose strongest line is drawn in its own direction to FINEST_STEP_DEG


def straight_lines(detail: Float32, hole: Mask, is_ground: Mask, side_px: float) -> Float32:
    """(n, n, 3) contribution of straight lines to the detail in the hole (n, n) and beside it.

    detail: (n, n, 3) roots of linear RGB less the ground's shading. is_ground: (n, n) visible ground. side_px: the
    marker's side.
    """
    ground = GroundDetail(detail, hole, is_ground, side_px)
    coarse, fine = (
        ground.reduced(min(len(hole), round(len(hole) * each / side_px))) for each in (SIDE_PX, FINE_SIDE_PX)
    )
    coarse = _smoothed(coarse, SMOOTH_PX)
    lines, drawn = np.zeros_like(coarse.detail), np.zeros_like(fine.detail)
    for number, direction in enumerate(_telling_directions(coarse)):
        nearby = direction + np.arange(-STEP_DEG, STEP_DEG + 1e-9, FINER_STEP_DEG)
        # A seam may run a degree beside the grain, whose many lines would have it turned into their direction.
        for alone in (True, False):
            left = coarse.without(lines)
            turned = (TurnedRows(left, each) for each in nearby)
            rows = max(turned, key=lambda each: each.highest if alone else each.energy)
            chosen = rows.strongest if alone else rows.is_line
            if not chosen.any():
                break
            lines = _stronger(lines, rows.drawn(chosen))
            rest = fine.without(drawn)
            if alone and number < SEAMS:
                finer, chosen = _along(rest, rows, chosen)
            else:
                finer = TurnedRows(rest, rows.direction_deg)
                chosen = finer.those_of(rows, chosen)
            drawn = _stronger(drawn, finer.drawn(chosen))
    return np.asarray(cv2.resize(drawn, hole.shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)


def _smoothed(ground: GroundDetail, sigma_px: float) -> GroundDetail:
    """The ground with its detail blurred, as far as it is seen."""
    smooth = blurred_within(ground.detail, ground.seen.astype(np.float32), sigma_px)
    return replace(ground, detail=np.where(ground.seen[..., None], smooth, np.float32(0)))


def _along(fine: GroundDetail, coarse: TurnedRows, chosen: Mask) -> tuple[TurnedRows, Mask]:
    """The ground turned to the direction of a line that lies in the rows `chosen` of a coarser one; and its rows."""
    beside = cv2.dilate(chosen.astype(np.uint8)[:, None], np.ones((2 * NEAR_ROWS + 1, 1), np.uint8))[:, 0] > 0
    nearby = coarse.direction_deg + np.arange(-STEP_DEG, STEP_DEG + 1e-9, FINEST_STEP_DEG)
    half = fine.reduced(max(1, len(fine.hole) // 2))
    turned = (TurnedRows(half, each) for each in nearby)
    best = max(turned, key=lambda each: each.energy_of(each.those_of(coarse, beside)))
    rows = TurnedRows(fine, best.direction_deg)
    return rows, rows.lines_at(rows.those_of(coarse, beside)) | rows.those_of(coarse, chosen)


def _telling_directions(ground: GroundDetail) -> Float:
    """(k,) degrees: local maxima of the lines' energy over the directions, the largest first."""
    directions = np.arange(0.0, 180.0, STEP_DEG)
    energies = np.array([TurnedRows(ground, each).energy for each in directions])
    is_peak = (energies > 0) & (energies >= np.roll(energies, 1)) & (energies > np.roll(energies, -1))
    peaks = np.flatnonzero(is_peak)

    def resemble(direction: float, other: float) -> bool:
        return WAVY_DEG <= abs((direction - other + 90) % 180 - 90) <= CROSSING_DEG

    return np.array(distinct(directions[peaks[np.argsort(-energies[peaks])]], resemble, MOST_DIRECTIONS))


def _stronger(one: Float32, other: Float32) -> Float32:
    """The stronger of two lines where they cross, as their contrasts do not add up."""
    return np.where((np.abs(other).sum(axis=2) > np.abs(one).sum(axis=2))[..., None], other, one)
