"""Checks that the four sides measured are the print's own, as a finger along an edge shows a straight edge too.

A finger moves the side that it covers and no other. The remaining sides and the print's inside still agree, and give
the pose.
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.square import mean_side_px
from ashe_live.tracking.edges.corner_errors import corrected, grown
from ashe_live.tracking.edges.corners import LAST_REACH_PX, fitted_squares
from ashe_live.tracking.edges.edge_profiles import Light, LightPatch
from ashe_live.tracking.edges.print_alignment import AlignedCorners, AlignmentStep, PrintAlignment, in_units
from ashe_live.tracking.edges.print_shade import Shade
from ashe_live.tracking.edges.squares import FittedSquare, is_front_of_square

# Least correlation between the print's inside and the picture for the inside to be trusted while a side is covered.
MIN_INSIDE = 0.85
# A side counts as covered if it differs from where the inside puts it by more than TOLERANCE (a share of the side
# length) plus SIGMAS standard deviations of the alignment.
TOLERANCE, SIGMAS = 0.008, 3.0
# A single alignment step is trusted if its standard deviation is below SURE_SIGMA (a share of the side length). It is
# also trusted if it exceeds that of the last full alignment by no more than the factor AS_ALIGNED: what it leaves
# unexplained is then due to the view's slant and blur, as it was there.
SURE_SIGMA = 0.004
AS_ALIGNED = 1.1
# Up to MOST_COVERED sides may be covered. If a corner is outside the picture, LEAST_SEEN sides must be seen, which just
# determine the pose.
MOST_COVERED, LEAST_SEEN = 2, 3
# A finger cannot cover three sides: if more than MOST_COVERED are off, the paper is bent or a shadow misleads the
# inside. The square is kept, with a larger uncertainty, if no corner is off by more than this share of the side length.
MOST_BENT = 0.12
# Least linear light of white that counts as clipped: a camera's white balance, or its curve, may take as much from it.
CLIPPED = 0.75
# For each side, the indices of its two ends in corners.ravel() (x, y, x, y, ...), of the coordinate across the side.
ACROSS_SIDES = np.array([(1, 3), (2, 4), (5, 7), (6, 0)])


class _Verdict(NamedTuple):
    """What is left of a square once it is compared with the print."""

    square: FittedSquare | None  # without the sides that are not the print's; None where the print is not
    is_whole: bool = False  # whether all sides are where the print's inside is


def verified_square(
    square: FittedSquare, view: LightPatch, alignment: PrintAlignment, samples: int, aligned_sigma: float = 0.0
) -> FittedSquare | None:
    """`square` as it is, or without the sides that are not the print's; None when it is not the print.

    `view` and `samples` as in fitted_squares; `aligned_sigma` as the frame before had it.
    """
    seen = _PrintSeen.within(square, view, alignment, samples)
    verdict = _verified(square, seen, aligned_sigma)
    if verdict.is_whole:
        return verdict.square
    if (in_penumbra := seen.in_penumbra) is not None:
        # What covers a side or bends the paper may be the border of a shadow.
        without_shadow = _verified(square, in_penumbra, aligned_sigma)
        if without_shadow.is_whole or verdict.square is None:
            verdict = without_shadow
    return _overexposed(square, seen) if verdict.square is None and seen.is_clipped else verdict.square


def _overexposed(square: FittedSquare, seen: "_PrintSeen") -> FittedSquare | None:
    """As `verified_square`, where white is clipped and so has grown: sides lie within the print's.

    Of the shares by which it may have grown that one counts which the edges inside confirm best.
    """
    best = None
    for share, alignment in seen.alignment.overexposed:
        whole = grown(square, share * seen.side_px)
        found, is_whole = _verified(whole, _PrintSeen.within(whole, seen.view, alignment, seen.edge_samples), 0.0)
        if found is None or not is_whole or found.bleed_px is None:
            continue
        if best is None or best.bleed_px is None or abs(found.bleed_px) < abs(best.bleed_px):
            best = found
    return best


def _verified(square: FittedSquare, seen: "_PrintSeen", aligned_sigma: float) -> _Verdict:
    """As `verified_square`, by what is `seen` within the square."""
    alignment = seen.alignment
    if leaves_frame(square, seen.view):
        return _Verdict(square, True) if seen.is_print and square.sides_seen >= LEAST_SEEN else _Verdict(None)
    if not alignment.tells_place:
        is_print = seen.is_print and square.sides_seen == 4
        return _Verdict(corrected(square, seen.bleed_px), True) if is_print else _Verdict(None)
    tolerance = max(TOLERANCE, square.curl_of_two_sides)
    step = alignment.look(seen.samples, seen.side_px, seen.shade)
    even = None if step is None else _confirmed(square, seen, step, tolerance, aligned_sigma)
    if even is not None:
        confirmed = dataclasses.replace(even, aligned_sigma=aligned_sigma)
        return _Verdict(confirmed, True) if seen.is_print else _Verdict(None)
    # A single step did not confirm all sides, so that the inside is aligned to the end.
    inside = alignment.aligned(seen.blurred, square.corners_px, step, seen.shade)
    if inside is None or inside.last.inside < MIN_INSIDE:
        return _Verdict(None)
    return _by_inside(square, inside, seen, tolerance)


def _by_inside(square: FittedSquare, inside: AlignedCorners, seen: "_PrintSeen", tolerance: float) -> _Verdict:
    """As `_verified`, by where the whole alignment has the `inside` of the print."""
    alignment, is_print = seen.alignment, seen.is_print
    square, off = _compared(square, inside, tolerance)
    if off.sum() > MOST_COVERED:
        # Edges other than the print's were measured, as those of its paper on a bright floor. Measure again where the
        # inside puts them.
        (again,) = fitted_squares([seen.view], [inside.corners_px], seen.edge_samples, most_reach_px=LAST_REACH_PX)
        if again is not None:
            square, off = _compared(again, inside, tolerance)
            is_print = alignment.is_print(alignment.sampled(seen.blurred, square.corners_px, seen.shade))
    if off.any() and off.sum() <= MOST_COVERED:
        return _Verdict(_without_covered(square, inside, off))
    if not is_print:
        return _Verdict(None)
    if not off.any():
        return _Verdict(dataclasses.replace(square, aligned_sigma=inside.last.sigma), True)
    return _Verdict(_as_bent(square, inside, MOST_BENT * seen.side_px))


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class _PrintSeen:
    """What the picture shows within a square that may be the print."""

    alignment: PrintAlignment
    view: LightPatch
    edge_samples: int  # along each side, where its edge is measured
    blurred: LightPatch
    shaded: Light  # (n, n) samples as they are
    samples: Light  # (n, n) without the shade
    shade: Shade | None
    side_px: float

    @staticmethod
    def within(square: FittedSquare, view: LightPatch, alignment: PrintAlignment, edge_samples: int) -> "_PrintSeen":
        blurred = alignment.blurred(view, square.corners_px)
        samples, side_px = alignment.sampled(blurred, square.corners_px), mean_side_px(square.corners_px)
        seen = _PrintSeen(
            alignment=alignment,
            view=view,
            edge_samples=edge_samples,
            blurred=blurred,
            shaded=samples,
            samples=samples,
            shade=None,
            side_px=side_px,
        )
        return seen.without(alignment.shade.on(samples))

    def without(self, shade: Shade | None) -> "_PrintSeen":
        """The same without a shadow."""
        if shade is None:
            return self
        return dataclasses.replace(self, samples=shade.removed_from(self.shaded), shade=shade)

    @property
    def in_penumbra(self) -> "_PrintSeen | None":
        """The same without the border of a shadow, however wide; None where there is none."""
        shade = self.alignment.shade.penumbra_on(self.shaded)
        return None if shade is None else self.without(shade)

    @property
    def is_clipped(self) -> bool:
        """Whether most of what should be white is as bright as a picture can be."""
        return float(np.median(self.alignment.shade.white_of(self.shaded))) >= CLIPPED

    @property
    def is_print(self) -> bool:
        return self.alignment.is_print(self.samples)

    @property
    def bleed_px(self) -> float | None:
        return self.alignment.bleed_px(self.samples, self.side_px, self.shade)


def _confirmed(
    square: FittedSquare, seen: _PrintSeen, step: AlignmentStep, tolerance: float, aligned_sigma: float
) -> FittedSquare | None:
    """The square corrected for bleeding, if a single step of its alignment is certain and moves no side; else None."""
    # Where the print is elsewhere, it explains the samples badly, and a single step is uncertain.
    is_sure = step.sigma <= SURE_SIGMA
    is_as_aligned = step.sigma <= AS_ALIGNED * aligned_sigma and step.inside >= MIN_INSIDE
    if square.sides_seen < 4 or not (is_sure or is_as_aligned):
        return None
    even = corrected(square, seen.bleed_px if is_sure else step.bleed_px)
    left = step.shift - in_units(even.corners_px, square.corners_px)
    return None if _off(left, step, tolerance).any() else even


def _compared(square: FittedSquare, inside: AlignedCorners, tolerance: float) -> tuple[FittedSquare, Mask]:
    """The square corrected for bleeding; and (4,) which of its sides are unseen, or not where the inside puts them."""
    even = corrected(square, inside.last.bleed_px)
    return even, _off(in_units(inside.corners_px, even.corners_px), inside.last, tolerance) | ~even.seen


def _without_covered(square: FittedSquare, inside: AlignedCorners, off: Mask) -> FittedSquare | None:
    """The square by its inside and the sides that are not `off` (4,); None if the result is no square."""
    sides = square.by_side[~off].sum(axis=0)
    total = sides + inside.information
    corners = np.linalg.solve(
        total, sides @ square.corners_px.ravel() + inside.information @ inside.corners_px.ravel()
    ).reshape(4, 2)
    if not is_front_of_square(corners):
        return None
    by_side = square.by_side.copy()
    by_side[off] = inside.information / off.sum()
    return dataclasses.replace(square, corners_px=corners, by_side=by_side, seen=~off)


def _as_bent(square: FittedSquare, inside: AlignedCorners, most_px: float) -> FittedSquare | None:
    """The square with a larger uncertainty, if all of it is seen and the paper may just be bent; see MOST_BENT."""
    astray_px = float(np.linalg.norm(inside.corners_px - square.corners_px, axis=1).max())
    if square.sides_seen < 4 or astray_px > most_px:
        return None
    return dataclasses.replace(square, by_side=_no_surer(square.by_side, astray_px))


def _no_surer(by_side: Float, sigma_px: float) -> Float:
    """(4, 8, 8) as `by_side`, with independent noise of `sigma_px` added to each coordinate of the corners."""
    total = by_side.sum(axis=0)
    shared = np.linalg.solve(np.eye(8) + sigma_px**2 * total, total)
    return np.asarray(np.tile(0.125 * (shared + shared.T), (4, 1, 1)))


def leaves_frame(square: FittedSquare, view: LightPatch) -> bool:
    """Whether a corner lies beyond the camera's picture."""
    assert view.camera is not None
    source_px = view.source_px(square.corners_px)
    return bool(((source_px < 0) | (source_px > np.subtract(view.camera.size, 1))).any())


def _off(shift: Float, step: AlignmentStep, tolerance: float) -> Mask:
    """(4,) whether a `shift` (4, 2) of the corners, in sides, moves each side by more than its tolerance."""
    allowed = tolerance + SIGMAS * np.sqrt(np.diag(step.covariance))
    return np.asarray((np.abs(shift.ravel()) > allowed)[ACROSS_SIDES].any(axis=1))
