"""Locates a marker's corners by what is printed inside it, for sides that something lies over.

Lucas and Kanade's alignment in its inverse compositional form (Baker and Matthews, "Lucas-Kanade 20 years on", IJCV
2004). The picture, sampled in the print's own frame, is a linear combination of the print (its gain), an offset, a
gradient of the light, a common displacement of all edges (bleeding, see corner_errors.py) and the displacements of the
four corners. All of these are known beforehand, so that a step is the product of a constant matrix and the samples.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import mean_side_px
from ashe_live.tracking.edges.edge_profiles import Light, LightPatch
from ashe_live.tracking.edges.print_likeness import (
    AVERAGED,
    MIN_LIKENESS,
    UNIT,
    PrintLikeness,
    normalised,
    with_white_grown,
)
from ashe_live.tracking.edges.print_shade import Shade
from ashe_live.tracking.edges.squares import is_front_of_square

# The inside includes this share of the border's width: the border's inner edge carries half of the information about
# the corners, and a finger may lie over the rest.
RING = 0.3
# A print with almost nothing inside (4x4_50:17 is a single white block) does not locate its corners: it is used to
# recognise the marker alone, and must then match by SURE_LIKENESS. A print counts as such if a single sample that is
# wrong by its whole contrast would move a corner by more than MOST_SPREAD of the side length.
MOST_SPREAD, SURE_LIKENESS = 0.2, 0.96
# A measured bleed of a larger standard deviation is discarded. A print seen whole gives a few hundredths of a pixel; a
# strip over it, or a reflection in the glass before it, resembles a large bleed but leaves far more unexplained.
MOST_BLEED_SIGMA_PX = 0.07
STEPS = 12  # at most
SMALL_STEP = 1e-3  # of the side length: the alignment has converged
MIN_SIGMA_PX = 0.05
LARGE_STEP = 0.08  # of the side length: the linearisation does not hold farther than this
GROWN = (0.02, 0.035, 0.05)  # shares of the side by which clipped white grows beyond what is linear in the bleed
OUTWARDS = np.sign(UNIT - 0.5)


@dataclass(frozen=True, slots=True)
class AlignmentStep:
    """One step of the alignment, by the samples within a square."""

    shift: Float  # (4, 2) from the square's corners towards the print's, in units of the print's side, x right, y down
    covariance: Float  # (8, 8) of shift.ravel()
    sigma: float  # the largest standard deviation in it
    inside: float  # correlation in [-1, 1] of the samples inside the border with the print
    bleed_px: float | None  # displacement of all edges towards white; None where it cannot be measured


@dataclass(frozen=True, slots=True, eq=False)
class _Linear:
    """What samples depend on linearly, near a print: its gain, the four corners' displacements (x and y of each), an
    offset, a gradient of the light, and bleeding.
    """

    columns: Light  # (m, 13) derivatives of each sample
    solver: Light  # (13, m) the coefficients by least squares
    spread: Float  # (13, 13) covariance of the coefficients for samples of variance 1

    @classmethod
    def of(cls, columns: Float | Light) -> "_Linear":
        exact = columns.astype(np.float64)
        spread = np.linalg.inv(exact.T @ exact + 1e-9 * np.eye(exact.shape[1]))
        return cls(columns.astype(np.float32), (spread @ exact.T).astype(np.float32), np.asarray(spread))

    @property
    def largest_spread(self) -> float:
        """Of a corner's coordinates."""
        return float(np.diag(self.spread)[1:9].max())


class AlignedCorners(NamedTuple):
    """The corners as the print's inside locates them."""

    corners_px: Float  # (4, 2) ideal pixels
    information: Float  # (8, 8) inverse covariance of corners_px.ravel(), 1 / px^2
    last: AlignmentStep


class PrintAlignment(PrintLikeness):
    """Aligns one marker's print; made once, as it holds what does not depend on the picture."""

    def __init__(
        self,
        print_grey: Image,
        border: float,
        tells_place: bool = True,
        least_likeness: float = MIN_LIKENESS,
        edge_error: float = 0.0,
    ) -> None:
        """`print_grey` (n, n): the whole black square, from which every sample is taken; `border` over its side.

        `tells_place`: whether the inside was printed exactly where `print_grey` has it. `edge_error`: how far edges may
        be off in `print_grey`, over the side.
        """
        super().__init__(print_grey, border, least_likeness)
        self._print_grey, self._border, self._edge_error = print_grey, border, edge_error
        n = len(print_grey)
        places = (np.arange(self._side) + 0.5 - self._margin) / n
        y, x = np.meshgrid(places, places, indexing="ij")
        sharp = self._sharp
        ring = (1 - RING) * border
        within = (np.minimum(x, y) > ring) & (np.maximum(x, y) < 1 - ring)
        self._inside = np.flatnonzero(within)
        dy, dx = n * np.gradient(sharp, axis=0), n * np.gradient(sharp, axis=1)
        moved = (np.stack([dx, dy], axis=-1)[..., None, :] @ _by_entries(x, y))[..., 0, :] @ ENTRIES_BY_CORNERS
        even, bleed = np.ones_like(x), np.hypot(dx, dy)
        columns = np.dstack([sharp, -moved, even, x, y, bleed]).reshape(-1, 13)[self._inside]
        self._whole = _Linear.of(columns)
        # All four corners outwards by one, and with them the edges inside, towards their white.
        together = columns[:, 1:9] @ -OUTWARDS.ravel() - columns[:, 12]
        one_shift = np.column_stack([columns[:, 0], columns[:, 9:12], together])
        self._one_shift = one_shift.astype(np.float32)
        self._bleed_solver, self._bleed_spread = _bleed_solved(one_shift)
        self._tells_bleed = tells_place
        self.tells_place = tells_place and math.sqrt(self._whole.largest_spread) <= MOST_SPREAD
        if tells_place and not self.tells_place:
            self._least_likeness = SURE_LIKENESS

    @cached_property
    def overexposed(self) -> list[tuple[float, "PrintAlignment"]]:
        """By what shares of the side white may have grown, and the print grown so; none without exact edges."""
        shares = GROWN if self._tells_bleed else ()
        own = self._border, True, self._least_likeness, self._edge_error
        return [(share, PrintAlignment(with_white_grown(self._print_grey, share), *own)) for share in shares]

    def bleed_px(self, samples: Light, side_px: float, shade: Shade | None = None) -> float | None:
        """How far outwards all four sides of a square are displaced; None where it cannot be measured.

        Measured by the edges inside, from samples within the square: a tone curve other than sRGB's, clipped white, or
        ink that has spread displaces all edges towards white alike. shade: as in `look`.
        """
        inside, columns = samples.ravel()[self._inside], self._one_shift
        solver, spread = self._bleed_solver, self._bleed_spread
        if shade is not None:
            kept = ~shade.edge.ravel()[self._inside]
            inside, columns = inside[kept], columns[kept]
            solver, spread = _bleed_solved(columns.astype(np.float64))
        coefficients = solver @ inside
        gain = float(coefficients[0])
        if gain <= 0 or not self._tells_bleed:
            return None
        variance = self._variance(inside - columns @ coefficients, len(coefficients), side_px) / gain**2
        return self._believed_px(float(coefficients[4]) / gain, variance * spread, side_px)

    def look(self, samples: Light, side_px: float, shade: Shade | None = None) -> AlignmentStep | None:
        """One step from samples taken where the print is thought to be; None where nothing of it is seen.

        shade: that was removed from the samples, whose edge says nothing.
        """
        inside, linear = samples.ravel()[self._inside], self._whole
        if shade is not None:
            kept = ~shade.edge.ravel()[self._inside]
            inside, linear = inside[kept], _Linear.of(linear.columns[kept])
        coefficients = linear.solver @ inside
        gain = float(coefficients[0])
        total = float(((inside - inside.mean()) ** 2).sum())
        if gain <= 0 or total <= 0:
            return None
        variance = self._variance(inside - linear.columns @ coefficients, len(coefficients), side_px) / gain**2
        own = normalised(linear.columns[:, 0])
        return AlignmentStep(
            (coefficients[1:9] / gain).astype(np.float64).reshape(4, 2),
            variance * linear.spread[1:9, 1:9],
            math.sqrt(variance * linear.largest_spread),
            float(own @ normalised(inside)),
            self._believed_px(-float(coefficients[12]) / gain, variance * float(linear.spread[12, 12]), side_px),
        )

    def _variance(self, left: Light, unknowns: int, side_px: float) -> float:
        """Variance of a sample by the residuals of a fit, as if samples were independent."""
        # Neighbouring samples see the same pixels.
        per_sample_px = side_px / (self._side - 2 * self._margin)
        alike = max(AVERAGED, 2 / per_sample_px) ** 2
        return float(left @ left) / max(1, len(left) - unknowns) * alike

    def _believed_px(self, bleed: float, variance: float, side_px: float) -> float | None:
        """A bleed (over the side, with its variance) in pixels, less the error of the print's own edges; or None."""
        if math.sqrt(variance) * side_px > MOST_BLEED_SIGMA_PX:
            return None
        return math.copysign(max(abs(bleed) - self._edge_error, 0.0), bleed) * side_px

    def aligned(
        self, view: LightPatch, corners_px: Float, first: AlignmentStep | None, shade: Shade | None = None
    ) -> AlignedCorners | None:
        """From near `corners_px` (4, 2) to where the inside of the print has them; None where it leads nowhere.

        `view` as from `blurred`; `first`: what `look` says of the samples within `corners_px`; `shade` as in `sampled`.
        """
        corners, step = corners_px, first
        for _ in range(STEPS):
            if step is None:
                return None
            largest = float(np.abs(step.shift).max())
            corners, by_unit = _moved(corners, step.shift * min(1.0, LARGE_STEP / max(largest, 1e-12)))
            if not is_front_of_square(corners):
                return None
            if largest < SMALL_STEP:
                covariance = by_unit @ step.covariance @ by_unit.T
                information = np.linalg.inv(covariance + MIN_SIGMA_PX**2 * np.eye(8))
                return AlignedCorners(corners, np.asarray(information, dtype=np.float64), step)
            step = self.look(self.sampled(view, corners, shade), mean_side_px(corners), shade)
        return None


def _by_entries(x: Float, y: Float) -> Float:
    """(..., 2, 8) derivatives of where a homography near the identity takes places x, y (...), by its first entries."""
    none, one = np.zeros_like(x), np.ones_like(x)
    across = np.stack([x, y, one, none, none, none, -x * x, -x * y], axis=-1)
    down = np.stack([none, none, none, x, y, one, -x * y, -y * y], axis=-1)
    return np.stack([across, down], axis=-2)


ENTRIES_BY_CORNERS = np.linalg.inv(_by_entries(*UNIT.T).reshape(8, 8))  # by the displacements of the unit square's


def in_units(corners_px: Float, others_px: Float) -> Float:
    """(4, 2) how far `others_px` lie from `corners_px` (4, 2) in the frame of the latter, in units of its side."""
    H = cv2.getPerspectiveTransform(corners_px.astype(np.float32), UNIT.astype(np.float32))
    there = np.column_stack([others_px, np.ones(4)]) @ H.T
    return np.asarray(there[:, :2] / there[:, 2:] - UNIT)


def _moved(corners_px: Float, shift: Float) -> tuple[Float, Float]:
    """Corners after a `shift` in units of the print, and the (8, 8) derivatives of pixels by such units."""
    H = cv2.getPerspectiveTransform(UNIT.astype(np.float32), corners_px.astype(np.float32))
    there = np.column_stack([UNIT + shift, np.ones(4)]) @ H.T
    derivatives = np.zeros((8, 8))
    for corner, (x, y, w) in enumerate(np.column_stack([UNIT, np.ones(4)]) @ H.T):
        block = slice(2 * corner, 2 * corner + 2)
        derivatives[block, block] = (H[:2, :2] - np.outer((x / w, y / w), H[2, :2])) / w
    return np.asarray(there[:, :2] / there[:, 2:], dtype=np.float64), derivatives


def _bleed_solved(one_shift: Float) -> tuple[Light, float]:
    """(5, m) least squares of samples (m,) by `one_shift` (m, 5), whose last is the displacement of all edges together;
    and that one's variance for samples of variance 1.
    """
    spread = np.linalg.inv(one_shift.T @ one_shift + 1e-9 * np.eye(5))
    return np.linalg.pinv(one_shift).astype(np.float32), float(spread[4, 4])
