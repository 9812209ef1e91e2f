"""Tells whether a quadrilateral of the picture shows a marker's whole print and the paper around it."""

from dataclasses import replace

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import mean_side_px
from ashe_live.tracking.edges.edge_profiles import Light, LightPatch
from ashe_live.tracking.edges.print_shade import PrintShade, Shade

# Width of the paper around the square that is compared as well: a share of the border's width, and at most a share of
# the side length.
PAPER = 0.5
MOST_PAPER = 1 / 12
# The picture is averaged over this many samples: a sharp edge between two samples would not show where it is.
AVERAGED = 1.5
# The print is compared at several blurs of these standard deviations, in samples.
BLURS = (0.0, 1.5, 3.0, 4.5)
# Least correlation of a print: whole prints reach it however they are blurred, the most similar other things do not.
MIN_LIKENESS = 0.83
# Largest difference of a cell from its print, as a share of the contrast: a shadow's edge makes half, a cell of another
# marker all of it.
MOST_AMISS = 0.75
UNIT = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


class PrintLikeness:
    """Samples the picture in the frame of one marker's print, and compares; made once for all pictures."""

    def __init__(self, print_grey: Image, border: float, least_likeness: float = MIN_LIKENESS) -> None:
        """`print_grey` (n, n): the whole black square, from which every sample is taken; `border` over its side."""
        self._cells = round(1 / border)
        self._least_likeness = least_likeness
        n = len(print_grey)
        self._margin = max(1, round(min(PAPER * border, MOST_PAPER) * n))
        self._side = n + 2 * self._margin
        padded = np.pad(print_grey.astype(np.float64) / 255, self._margin, constant_values=1.0)
        # As the samples of a sharp picture are.
        self._sharp = _averaged(padded)
        blurred = [self._sharp if sigma == 0 else cv2.GaussianBlur(self._sharp, (0, 0), sigma) for sigma in BLURS]
        self.shade = PrintShade(self._sharp, round(border * n), self._margin)
        self._prints = np.stack([normalised(np.asarray(one, dtype=np.float64).ravel()) for one in blurred])

    def sampled(self, view: LightPatch, corners_px: Float, shade: Shade | None = None) -> Light:
        """(n, n) of the light in the print's frame, of the square at ideal `corners_px` (4, 2).

        shade: a shadow on the print, which is removed from the samples; None where there is none.
        """
        samples = self._warped(view, corners_px)
        return samples if shade is None else shade.removed_from(samples)

    def _warped(self, view: LightPatch, corners_px: Float) -> Light:
        """As `sampled`, with the shadow that may be on it."""
        n = self._side - 2 * self._margin
        # In indices of the samples.
        ends = (UNIT * n + self._margin - 0.5).astype(np.float32)
        H = cv2.getPerspectiveTransform(ends, (corners_px - view.origin_px).astype(np.float32))
        if not view.is_distorted:
            return np.asarray(
                cv2.warpPerspective(
                    view.light,
                    H,
                    (self._side, self._side),
                    flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                    borderMode=cv2.BORDER_REPLICATE,
                ),
                dtype=np.float32,
            )
        index = np.arange(self._side)
        x, y, w = (a * index[None] + b * index[:, None] + c for a, b, c in H)
        ideal = np.stack([x / w, y / w], axis=-1).reshape(-1, 2) + view.origin_px
        source = (view.source_px(ideal) - view.origin_px).astype(np.float32).T.reshape(2, self._side, self._side)
        samples = cv2.remap(view.light, source[0], source[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(samples, dtype=np.float32)

    def blurred(self, view: LightPatch, corners_px: Float) -> LightPatch:
        """The view averaged over what lies between a few samples of the square at `corners_px` (4, 2)."""
        n = self._side - 2 * self._margin
        width = _odd(AVERAGED * mean_side_px(corners_px) / n)
        if width <= 1:
            return view
        return replace(view, light=np.asarray(cv2.blur(view.light, (width, width)), dtype=np.float32))

    def is_print(self, samples: Light) -> bool:
        """Whether samples look like the whole print and the paper around it, and each of its cells like itself.

        By the correlation at the blur that fits best, of the square roots of both: as in an encoded picture, a shadow
        over a part of the print then counts less.
        """
        seen = normalised(np.sqrt(samples.ravel()))
        correlations = self._prints @ seen
        best = int(correlations.argmax())
        likeness = float(correlations[best])
        if likeness < self._least_likeness:
            return False
        whole = slice(self._margin, self._side - self._margin)
        amiss = (seen / likeness - self._prints[best]).reshape(self._side, self._side)[whole, whole]
        cells = np.abs(cv2.resize(amiss, (self._cells, self._cells), interpolation=cv2.INTER_AREA))
        return float(cells.max()) <= MOST_AMISS * float(np.ptp(self._prints[0]))


def with_white_grown(print_grey: Image, share: float) -> Image:
    """(n, n) the print (n, n) with its white, and that of the paper around it, grown by this share of the side."""
    n, fine = len(print_grey), 8
    grown = round(share * n * fine)
    enlarged = np.repeat(np.repeat(print_grey, fine, axis=0), fine, axis=1)
    padded = np.pad(enlarged, grown, constant_values=255)
    wider = cv2.dilate(padded, np.ones((2 * grown + 1, 2 * grown + 1), np.uint8))
    within = slice(grown, grown + n * fine)
    return np.asarray(cv2.resize(wider[within, within], (n, n), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _averaged(picture: Float) -> Float:
    """Over AVERAGED samples, as `blurred` does to the picture."""
    fine = 5
    enlarged = np.repeat(np.repeat(picture, fine, axis=0), fine, axis=1)
    width = _odd(AVERAGED * fine)
    return np.asarray(cv2.blur(enlarged, (width, width))[fine // 2 :: fine, fine // 2 :: fine], dtype=np.float64)


def _odd(width: float) -> int:
    """The odd number next to `width`: an even window would move the picture by half a pixel."""
    return 2 * max(0, round((width - 1) / 2)) + 1


def normalised(values: Float | Light) -> Light:
    """`values` about their mean, of length 1: products of two such are correlations."""
    centred = values.astype(np.float32) - np.float32(values.mean())
    return np.asarray(centred / np.float32(max(float(np.linalg.norm(centred)), 1e-12)))
