"""Markers with a picture inside a black border, identified by normalised correlation in four rotations.

The method of ARToolKit (Kato and Billinghurst, 1999), on candidates from `quads`.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image
from ashe_live.tracking.edges.corners import refined_corners
from ashe_live.tracking.edges.print_alignment import PrintAlignment
from ashe_live.tracking.edges.quads import (
    MIN_SIDE_PX,
    SMALL_WINDOW_PX,
    dark_quads,
    half_seen_quads,
    ink_quads,
    on_lighter,
    without_repeats,
)

# Side of the square, in samples, at which candidate and pattern are compared.
SAMPLES = 32
# Photos and clips of the right pattern give 0.69 to 0.98, another pattern 0.35, the likest ArUco marker 0.65.
MIN_CORRELATION = 0.66
MAX_SELF_CORRELATION = 0.9
# Largest brightness of the border, from 0 (the content's dark) to 1 (its light); coarse corners include some paper.
BORDER_LEVEL, COARSE_BORDER_LEVEL = 0.35, 0.5
# Least difference of grey levels between the dark and the light of the content.
MIN_CONTRAST = 10
EDGE_SAMPLES = 16
# Least correlation of a tracked square with the whole print.
MIN_LIKENESS = 0.8
# Samples along the side at which the print is aligned: two are in the narrowest border.
ALIGNED_SAMPLES = 48
# Error of the print's edges after it has been scaled to so few samples, over the side: a tenth of a sample.
EDGE_ERROR = 0.1 / ALIGNED_SAMPLES


class PatternMarker:
    """A black square with a picture inside: from an ARToolKit pattern file, or from the print itself."""

    def __init__(self, spec: str, print_grey: Image, is_exact: bool = True) -> None:
        """`print_grey` (n, n): the whole black square, border included; `is_exact`: its content is where it is printed.

        Raises ValueError when it has no dark border, no contrast, or looks the same turned.
        """
        self.spec = spec
        self._print = print_grey
        samples = cv2.resize(print_grey, (SAMPLES, SAMPLES), interpolation=cv2.INTER_AREA).astype(np.float64)
        self._inside = _inside_of_border(samples)
        # A pattern file is a picture that someone took: its content may lie a sample off.
        self._grown = slice(self._inside.start - 1, self._inside.stop + 1)
        content = samples[self._inside, self._inside].astype(np.float32)
        # Item k is the content turned counter-clockwise by k quarter turns.
        self._turned = [np.rot90(content, turns).copy() for turns in range(4)]
        if max(_correlation(content, turned) for turned in self._turned[1:]) > MAX_SELF_CORRELATION:
            raise ValueError("it looks the same when it is turned")
        self.alignment = PrintAlignment(
            self.bitmap(ALIGNED_SAMPLES), self._inside.start / SAMPLES, is_exact, MIN_LIKENESS, EDGE_ERROR
        )

    def find(self, grey: Image, min_side_px: float = MIN_SIDE_PX, thorough: bool = True) -> list[Float]:
        """See Marker.find; the one that correlates best first."""
        quads = dark_quads(grey, min_side_px)
        if thorough:
            quads += [*dark_quads(grey, min_side_px, SMALL_WINDOW_PX), *ink_quads(grey, min_side_px)]
        found = self._among(grey, quads)
        if thorough and not found:
            found = self._among(grey, on_lighter(grey, half_seen_quads(grey, min_side_px)))
        return found

    def bitmap(self, side_px: int) -> Image:
        """See Marker.bitmap."""
        if side_px < SAMPLES:
            raise ValueError(f"{side_px} pixels are too few for a pattern of {SAMPLES}")
        shrinks = side_px < len(self._print)
        interpolation = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(self._print, (side_px, side_px), interpolation=interpolation), dtype=np.uint8)

    def _among(self, grey: Image, quads: list[Float]) -> list[Float]:
        """Those of `quads` that show it, in the print's order, the one that correlates best first."""
        found = []
        for quad in quads:
            correlation, corners = self._compare(grey, quad)
            if correlation >= MIN_CORRELATION:
                found.append((correlation, corners))
        found.sort(key=lambda one: one[0], reverse=True)
        return without_repeats([corners for _, corners in found])

    def _compare(self, grey: Image, quad: Float) -> tuple[float, Float]:
        """The best correlation in [-1, 1] over the four rotations, and the corners in the print's order."""
        if not self._has_dark_border(_rectified(grey, quad), COARSE_BORDER_LEVEL):
            return -1.0, quad
        corners = refined_corners(grey, quad, EDGE_SAMPLES)
        samples = _rectified(grey, corners)
        if not self._has_dark_border(samples, BORDER_LEVEL):
            return -1.0, quad
        seen = samples[self._grown, self._grown].astype(np.float32)
        correlations = [_correlation(seen, turned) for turned in self._turned]
        turns = int(np.argmax(correlations))
        # Turned counter-clockwise, the print's top-left corner lies `turns` places before the quad's first one.
        return correlations[turns], np.roll(corners, turns, axis=0)

    def _has_dark_border(self, samples: Float, level: float) -> bool:
        border = np.ones(samples.shape, dtype=bool)
        border[self._inside, self._inside] = False
        dark, light = np.percentile(samples[~border], (5, 90))
        return bool(light - dark >= MIN_CONTRAST and np.median(samples[border]) <= dark + level * (light - dark))


def _rectified(grey: Image, quad: Float) -> Float:
    """(SAMPLES, SAMPLES) grey values of the square within `quad`, each the mean of four."""
    side = 2 * SAMPLES
    square = np.array([(0, 0), (side, 0), (side, side), (0, side)], dtype=np.float32) - np.float32(0.5)
    homography = cv2.getPerspectiveTransform(quad.astype(np.float32), square)
    fine = cv2.warpPerspective(grey, homography, (side, side), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return cv2.resize(fine, (SAMPLES, SAMPLES), interpolation=cv2.INTER_AREA).astype(np.float64)


def _inside_of_border(samples: Float) -> slice:
    """The rows, and equally the columns, of the smallest centred square that holds all that is not dark."""
    dark, light = float(samples.min()), float(samples.max())
    if light - dark < 64:
        raise ValueError("it has hardly any contrast")
    rows, columns = np.nonzero(samples > (dark + light) / 2)
    border = int(min(rows.min(), columns.min(), SAMPLES - 1 - rows.max(), SAMPLES - 1 - columns.max()))
    if border < 2:
        raise ValueError("it has no black border")
    return slice(border, SAMPLES - border)


def _correlation(seen: NDArray[np.float32], pattern: NDArray[np.float32]) -> float:
    """Normalised correlation at the best place of `pattern` within `seen`, which is as large or a little larger."""
    return float(np.nan_to_num(cv2.matchTemplate(seen, pattern, cv2.TM_CCOEFF_NORMED)).max())
