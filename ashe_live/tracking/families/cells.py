"""Recognises the marker that a square shows: all cells together are correlated with every print in every rotation.

OpenCV decides cell by cell, and gives up if blur or a shadow makes a single cell doubtful. All cells together still
distinguish the marker from the others of its dictionary.
"""

from functools import cache, cached_property
from math import comb

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image

# Least correlation, at fine and at coarse corners (the right marker reaches 0.7 under a blur as wide as its cells); and
# least lead over the second best.
MIN_CORRELATION, MIN_COARSE_CORRELATION = 0.6, 0.3
MIN_LEAD = 0.12
# Largest probability with which a square of random cells may be read as some marker of a dictionary: with 50 markers of
# 4 x 4 cells, the shortest code, it is 0.003 if no cell may be wrong.
CHANCE = 0.004
# Least correlation where nobody said which marker it is: a print of another family, with cells of another size, has up
# to 0.75 with the most similar of a thousand, in looked-at pictures of the generator (a study without a command).
MIN_CORRELATION_OF_ANY = 0.8
# Largest brightness of the border, from 0 (the cells' black) to 1 (their white).
BORDER_LEVEL = 0.4
# Least difference of encoded grey levels between the cells' black and white.
MIN_CONTRAST = 10.0
# Positions in a cell, from 0 to 1, at which it is sampled.
PLACES = (0.3, 0.7)


class CellReader:
    """Reads squares of `cells` x `cells` inside a border one cell wide as the prints of one dictionary."""

    def __init__(self, dictionary: cv2.aruco.Dictionary) -> None:
        self.cells: int = dictionary.markerSize
        prints = [
            cv2.aruco.generateImageMarker(dictionary, number, self.cells + 2)[1:-1, 1:-1] > 0
            for number in range(len(dictionary.bytesList))
        ]
        turned = np.stack([np.rot90(prints, turns, axes=(1, 2)) for turns in range(4)], axis=1).astype(np.float64)
        self._prints = _normalised(turned.reshape(-1, self.cells**2))  # marker 0 in its four rotations, marker 1, ...

    def turns(self, grey: Image, corners_px: Float, number: int) -> int | None:
        """By how many quarter turns the square at `corners_px` (4, 2) shows that marker; None when it does not."""
        correlations = self._correlations(grey, corners_px)
        if correlations is None:
            return None
        turns = int(np.argmax(correlations[number]))
        is_it = correlations[number, turns] >= MIN_CORRELATION and _lead(correlations, number) >= MIN_LEAD
        return turns if is_it else None

    def may_be(self, grey: Image, corners_px: Float, number: int) -> bool:
        """Whether a closer look at the square within coarse corners is worth its time."""
        correlations = self._correlations(grey, corners_px)
        return correlations is not None and bool(correlations[number].max() >= MIN_COARSE_CORRELATION)

    def number(self, grey: Image, corners_px: Float) -> int | None:
        """Which marker the square at `corners_px` (4, 2) shows; None where random cells would be as like to one."""
        correlations = self._correlations(grey, corners_px)
        if correlations is None:
            return None
        nearest = int(np.argmax(correlations.max(axis=1)))
        is_it = correlations[nearest].max() >= self._least_of_any and _lead(correlations, nearest) >= MIN_LEAD
        return nearest if is_it else None

    @cached_property
    def _least_of_any(self) -> float:
        """Least correlation that random cells have with any of the prints by a probability of CHANCE.

        With as many of n cells wrong, the correlation is 1 - 2 wrong / n. No cell may be wrong where that probability
        is higher even so.
        """
        alike, n = len(self._prints), self.cells**2
        wrong = 0
        while alike * sum(comb(n, k) for k in range(wrong + 2)) <= CHANCE * 2**n:
            wrong += 1
        return max(1 - (2 * wrong + 1) / n, MIN_CORRELATION_OF_ANY)

    def _correlations(self, grey: Image, corners_px: Float) -> Float | None:
        """(count, 4) of what is read with each print in each turn; None without contrast or without a dark border."""
        levels = _cell_levels(grey, corners_px, self.cells + 2)
        inside = levels[1:-1, 1:-1]
        border = np.concatenate([levels[0], levels[-1], levels[1:-1, 0], levels[1:-1, -1]])
        dark, light = float(inside.min()), float(inside.max())
        if light - dark < MIN_CONTRAST or np.median(border) > dark + BORDER_LEVEL * (light - dark):
            return None
        return np.asarray(self._prints @ _normalised(inside.reshape(1, -1))[0]).reshape(-1, 4)


@cache
def reader_of(dictionary: int) -> CellReader:
    """Of one of OpenCV's predefined dictionaries, by its number."""
    return CellReader(cv2.aruco.getPredefinedDictionary(dictionary))


def _lead(correlations: Float, number: int) -> float:
    """By how much a marker's correlation exceeds that of all others."""
    others = np.delete(correlations, number, axis=0)
    return float(correlations[number].max() - others.max())


def _cell_levels(grey: Image, corners_px: Float, cells: int) -> Float:
    """(cells, cells) mean grey levels within the square at `corners_px` (4, 2) in the picture."""
    places = (np.arange(cells)[:, None] + PLACES).ravel()
    unit = np.array([(0, 0), (cells, 0), (cells, cells), (0, cells)], dtype=np.float32)
    H = cv2.getPerspectiveTransform(unit, corners_px.astype(np.float32))
    x, y, w = (a * places[None] + b * places[:, None] + c for a, b, c in H)
    samples = cv2.remap(
        grey, (x / w).astype(np.float32), (y / w).astype(np.float32), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    k = len(PLACES)
    return np.asarray(samples.astype(np.float64).reshape(cells, k, cells, k).mean(axis=(1, 3)))


def _normalised(rows: Float) -> Float:
    """Each row (n,) without its mean, at length 1; zeros where it is flat."""
    centred = rows - rows.mean(axis=1, keepdims=True)
    return np.asarray(centred / np.maximum(np.linalg.norm(centred, axis=1, keepdims=True), 1e-9))
