"""Fits straight lines to the points measured along a square's sides, and intersects them in its corners."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from ashe_live.core.arrays import Float, Mask, cross_2d

# Points farther than this from the line have no weight (Tukey's biweight).
OUTLIER_PX = 1.5
# The window is this many times as wide in each iteration: good points may be far from the first guess of the line.
SCALES = 8.0, 4.0, 2.0, 1.0
# Least standard deviation assumed of a point.
MIN_SIGMA_PX = 0.01

# The amplitudes of these Legendre polynomials along an edge measure its slowly varying scatter. Orders 0 and 1 are the
# line and 2 is the bow; at order 6 a wave is still a few pixels long on a small marker.
SLOW_ORDERS = 3, 4, 5, 6

# Each corner's neighbours along the outline; np.roll would take ten times as long, and this runs in every frame.
NEXT, BEFORE = np.array([1, 2, 3, 0]), np.array([3, 0, 1, 2])


@dataclass(frozen=True, slots=True, eq=False)
class SideLines:
    """Lines along n sides, as offsets outwards from these."""

    ends_px: Float  # (n, 2) offsets of a side's two ends
    covariances_px2: Float  # (n, 2, 2) of these, as if the noise of pixels were independent
    bows_px: Float  # (n,) by how much the middle is off the line between the ends, at least 0
    # (n,) what scatter correlated along the side adds to the variance of either end; as it is estimated without bias,
    # it may be negative.
    correlated_px2: Float


def robust_lines(places: Float, offsets: Float, weights: Float, lengths_px: Float, seen: Mask) -> SideLines:
    """Lines by least squares reweighted with Tukey's biweight.

    places: (m,) along every side, 0 at its first and 1 at its second end. offsets, weights: (n, m) pixels outwards
    there, and 0 where there is no edge. A side that is not `seen`, (n,), stays where it is, with a huge covariance.
    """
    # The first line goes through the middle of the offsets, so that a few wrong ones do not carry it away.
    at_start, slope = _medians(offsets, weights > 0), np.zeros(len(offsets))
    powers = np.column_stack([np.ones_like(places), places, places**2])
    residuals = offsets - at_start[:, None]
    # Where all offsets are close together the wider windows keep everything, and change nothing.
    is_close = float((weights * np.abs(residuals)).max()) <= OUTLIER_PX
    for scale in SCALES[-2:] if is_close else SCALES:
        kept = weights * np.maximum(1 - (residuals / (scale * OUTLIER_PX)) ** 2, 0) ** 2
        mass, first, second = (kept @ powers).T
        mass = np.maximum(mass, 1e-9)
        place, offset = first / mass, (kept * offsets).sum(axis=1) / mass
        moment = np.maximum(second - mass * place**2, 1e-9)
        slope = ((kept * offsets) @ places - first * offset) / moment
        at_start = offset - slope * place
        residuals = offsets - at_start[:, None] - slope[:, None] * places
    # Curled paper bows an edge alike in every frame: that is no noise.
    from_place = places - place[:, None]
    bow = from_place**2 - moment[:, None] / mass[:, None]
    bowed = (kept * bow * residuals).sum(axis=1) / np.maximum((kept * bow**2).sum(axis=1), 1e-9)
    residuals = residuals - bowed[:, None] * bow
    variance = (kept * residuals**2).sum(axis=1) / mass + MIN_SIGMA_PX**2
    # Samples less than a pixel apart see the same pixels.
    variance *= np.maximum(1, len(places) / (np.ptp(places) * lengths_px))
    arms = np.column_stack([-place, 1 - place])
    by_variance = 1 / mass[:, None, None] + arms[:, :, None] * arms[:, None] / moment[:, None, None]
    covariances = variance[:, None, None] * by_variance
    # Independent scatter has the same variance in all orthonormal polynomials; correlated scatter more in slow ones.
    slow = ((kept * residuals) @ _slow_polynomials(len(places))) ** 2
    correlated_px2 = (slow.mean(axis=1) * len(places) / mass - variance) * by_variance[:, (0, 1), (0, 1)].mean(axis=1)
    return SideLines(
        ends_px=np.where(seen[:, None], np.column_stack([at_start, at_start + slope]), 0.0),
        covariances_px2=np.where(seen[:, None, None], covariances, 1e4 * np.eye(2)),
        bows_px=np.where(seen, np.abs(bowed) / 4, 0.0),
        correlated_px2=correlated_px2,
    )


@lru_cache(maxsize=8)
def _slow_polynomials(count: int) -> Float:
    """(count, 4) orthonormal polynomials of SLOW_ORDERS over `count` even places."""
    basis, _ = np.linalg.qr(legendre.legvander(np.linspace(-1, 1, count), max(SLOW_ORDERS)))
    return np.ascontiguousarray(basis[:, SLOW_ORDERS])


def information_by_side(outwards: Float, covariances: Float) -> Float:
    """(n, 4, 8, 8) information that each side gives about the corners of n squares.

    A side measures its two ends along its normal `outwards` (n, 4, 2), with covariances (n, 4, 2, 2).
    """
    by_corners = np.zeros((len(outwards), 4, 2, 8))
    for side in range(4):
        by_corners[:, side, 0, 2 * side : 2 * side + 2] = outwards[:, side]
        by_corners[:, side, 1, 2 * NEXT[side] : 2 * NEXT[side] + 2] = outwards[:, side]
    return np.asarray(by_corners.swapaxes(2, 3) @ np.linalg.inv(covariances) @ by_corners)


def _medians(values: Float, counts: Mask) -> Float:
    """Median of each row's values that count; 0 where none does."""
    ordered = np.sort(np.where(counts, values, np.inf), axis=1)
    numbers = counts.sum(axis=1)
    rows = np.arange(len(values))
    medians = (ordered[rows, (numbers - 1) // 2] + ordered[rows, numbers // 2]) / 2
    return np.where(numbers > 0, medians, 0.0)


def meeting_points(starts: Float, directions: Float) -> Float:
    """(n, 4, 2) where each side's line meets the one before it in n squares; NaN when they are parallel."""
    before, towards = starts[:, BEFORE], directions[:, BEFORE]
    cross = cross_2d(towards, directions)
    gap = starts - before
    cross = np.where(np.abs(cross) > 1e-9, cross, np.nan)
    way = cross_2d(gap, directions) / cross
    return np.asarray(before + way[..., None] * towards)
