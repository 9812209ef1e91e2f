"""Markers with a picture inside a black border, identified by normalised correlation in four rotations.

The method of ARToolKit (Kato and Billinghurst, 1999), on candidates from `quads`.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.tracking.quads import MIN_SIDE_PX, dark_quads

# Side of the square, in samples, at which candidate and pattern are compared.
SAMPLES = 32
# Real photos of the right pattern give 0.7 to 0.95, other things within a dark border at most 0.5.
MIN_CORRELATION = 0.6


class PatternMarker:
    """A black square with a picture inside: from an ARToolKit pattern file, or from the print itself."""

    def __init__(self, spec: str, print_grey: Image) -> None:
        """`print_grey` (n, n): the whole black square, border included.

        Raises ValueError when it has no dark border, no contrast, or looks the same turned.
        """
        self.spec = spec
        self._print = print_grey
        samples = cv2.resize(print_grey, (SAMPLES, SAMPLES), interpolation=cv2.INTER_AREA).astype(np.float64)
        self._inside = _inside_of_border(samples)
        content = samples[self._inside, self._inside]
        # Row k is the content turned counter-clockwise by k quarter turns.
        self._turned = np.stack([_standardised(np.rot90(content, turns)) for turns in range(4)])
        if (self._turned[1:] @ self._turned[0]).max() > 0.9:
            raise ValueError("it looks the same when it is turned")

    def find(self, grey: Image, min_side_px: float = MIN_SIDE_PX) -> Float | None:
        """See Marker.find; of several, the one that correlates best."""
        best: tuple[float, Float] | None = None
        for quad in dark_quads(grey, min_side_px):
            correlation, corners = self._compare(grey, quad)
            if correlation >= MIN_CORRELATION and (best is None or correlation > best[0]):
                best = correlation, corners
        return None if best is None else best[1]

    def bitmap(self, side_px: int) -> Image:
        """See Marker.bitmap."""
        if side_px < SAMPLES:
            raise ValueError(f"{side_px} pixels are too few for a pattern of {SAMPLES}")
        shrinks = side_px < len(self._print)
        interpolation = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
        return np.asarray(cv2.resize(self._print, (side_px, side_px), interpolation=interpolation), dtype=np.uint8)

    def _compare(self, grey: Image, quad: Float) -> tuple[float, Float]:
        """The best correlation in [-1, 1] over the four rotations, and the corners in the print's order."""
        samples = _rectified(grey, quad)
        content = samples[self._inside, self._inside]
        dark, light = np.percentile(content, (5, 90))
        border = np.ones(samples.shape, dtype=bool)
        border[self._inside, self._inside] = False
        if light - dark < 10 or np.percentile(samples[border], 90) > (dark + light) / 2:
            return -1.0, quad
        correlations = self._turned @ _standardised(content)
        turns = int(np.argmax(correlations))
        # Turned counter-clockwise, the print's top-left corner lies `turns` places before the quad's first one.
        return float(correlations[turns]), np.roll(quad, turns, axis=0)


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


def _standardised(content: Float) -> Float:
    """Flat, with mean 0 and length 1, so that a dot product is the normalised correlation."""
    flat = content.ravel() - content.mean()
    return np.asarray(flat / max(float(np.linalg.norm(flat)), 1e-9))
