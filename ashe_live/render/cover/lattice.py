"""Finds the lattice of shifts by which the ground repeats, among the peaks of its autocorrelation."""

from itertools import combinations

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Float32, Mask
from ashe_live.render.cover.masked import blurred_within

Indices = NDArray[np.intp]
MOST_CONTRASTS = 3.0  # contrast is clipped at this multiple of its median, lest a glint outweighs all ground
REPEATS = 0.22  # least correlation of the ground with itself, shifted; that of a table of white tiles is 0.4
LEAST_OVERLAP = 0.15  # least share of the visible ground that overlaps itself when shifted
APART_PX = 3  # least distance between two peaks
NOT_ALONG = 0.35  # least sine of the angle between a cell's two shifts: grain and joints repeat in one direction only
MOST_PEAKS = 16  # number of peaks among which a cell is sought
AS_CLEAR = 0.8  # the smallest cell with at least this share of the best cell's correlation is chosen
FARTHEST = 4  # steps of the lattice, in both directions


def structure_of(contrast: Float32, seen: Mask, level_px: float) -> Float32:
    """(m, m, 3) of the ground without what changes slowly, and with nothing that stands out by itself.

    contrast: (m, m, 3) of the ground, where it is seen (m, m). level_px: standard deviation of a blur that leaves sheen
    and folds, and no pattern.
    """
    shown = np.where(seen[..., None], contrast - blurred_within(contrast, seen.astype(np.float32), level_px), 0)
    strength = np.linalg.norm(shown, axis=2)
    most = MOST_CONTRASTS * float(np.median(strength[seen])) if seen.any() else 0.0
    return np.asarray(shown * np.minimum(1, most / np.maximum(strength, 1e-9))[..., None], np.float32)


def repeated_shifts(structure: Float32, seen: Mask) -> Float:
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
    # Of a far shift less ground tells, and its neighbours in the lattice, by which a cell is known, lie outside.
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
        area = abs(a[0] * b[1] - a[1] * b[0])
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
