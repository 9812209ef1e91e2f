"""Recognises the marker that a square shows: all cells together are correlated with every print in every rotation.

OpenCV decides cell by cell, and gives up if blur or a shadow makes a single cell doubtful. All cells together still
distinguish the marker from the others of its dictionary.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image

# Least correlation, at fine and at coarse corners (the right marker reaches 0.7 under a blur as wide as its cells); and
# least lead over the second best.
MIN_CORRELATION, MIN_COARSE_CORRELATION = 0.6, 0.3
MIN_LEAD = 0.12
# Largest brightness of the border, from 0 (the cells' black) to 1 (their white).
BORDER_LEVEL = 0.4
# Least difference of encoded grey levels between the cells' black and white.
MIN_CONTRAST = 10.0
# Positions in a cell, from 0 to 1, at which it is sampled.
PLACES = (0.3, 0.7)


class CellReader:
    """Reads squares of `cells` x `cells` inside a border one cell wide."""

    def __init__(self, dictionary: cv2.aruco.Dictionary, marker_id: int) -> None:
        self.cells: int = dictionary.markerSize
        prints = [
            cv2.aruco.generateImageMarker(dictionary, number, self.cells + 2)[1:-1, 1:-1] > 0
            for number in range(len(dictionary.bytesList))
        ]
        turned = np.stack([np.rot90(prints, turns, axes=(1, 2)) for turns in range(4)], axis=1).astype(np.float64)
        self._prints = _normalised(turned.reshape(-1, self.cells**2))  # marker 0 in its four rotations, marker 1, ...
        self._own = slice(4 * marker_id, 4 * marker_id + 4)

    def turns(self, grey: Image, corners_px: Float) -> int | None:
        """By how many quarter turns the square at `corners_px` (4, 2) shows the marker; None when it does not."""
        read = self._read(grey, corners_px)
        if read is None:
            return None
        correlations: Float = self._prints @ read
        turns = int(np.argmax(correlations[self._own]))
        own = correlations[self._own][turns]
        correlations[self._own] = -1
        is_own = own >= MIN_CORRELATION and own >= correlations.max() + MIN_LEAD
        return turns if is_own else None

    def may_be(self, grey: Image, corners_px: Float) -> bool:
        """Whether a closer look at the square within coarse corners is worth its time."""
        read = self._read(grey, corners_px)
        return read is not None and bool((self._prints[self._own] @ read).max() >= MIN_COARSE_CORRELATION)

    def _read(self, grey: Image, corners_px: Float) -> Float | None:
        """The cells' light, normalised; None without contrast or without a dark border."""
        levels = _cell_levels(grey, corners_px, self.cells + 2)
        inside = levels[1:-1, 1:-1]
        border = np.concatenate([levels[0], levels[-1], levels[1:-1, 0], levels[1:-1, -1]])
        dark, light = float(inside.min()), float(inside.max())
        if light - dark < MIN_CONTRAST or np.median(border) > dark + BORDER_LEVEL * (light - dark):
            return None
        return np.asarray(_normalised(inside.reshape(1, -1))[0])


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
