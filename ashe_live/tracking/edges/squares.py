"""A square in the picture as it was measured: its corners, how sure they are, and whether they can be a square's."""

import math
from dataclasses import dataclass, field

import numpy as np

from ashe_live.core.arrays import Float, Mask

MIN_SIDE_PX = 4.0
# Of the two sides' product: the sine of the sharpest angle that still counts as a corner.
MIN_SINE = 0.05
# Curled paper moves corners by up to so much of its side; how much of that is likely tells the bow of its edges. On a
# real clip edges bow by 0.012 of their length where the corners miss the pose by 0.02 to 0.03.
CURL, FLAT, CURL_PER_BOW = 0.03, 0.004, 2.4


@dataclass(frozen=True, slots=True)
class FittedSquare:
    """A square's corners and how sure they are."""

    corners_px: Float  # (4, 2) ideal pixels, in the order that was asked for
    by_side: Float  # (4, 8, 8) what each side tells: summed, the inverse covariance of corners_px.ravel(), 1 / px^2
    seen: Mask = field(default_factory=lambda: np.ones(4, dtype=bool))  # (4,) an unseen side is where it was guessed
    bows: Float | None = None  # (4,) of the sides, over their lengths; None: edges were not looked at
    correlated_px: float = 0.0  # standard deviation of a side's ends by scatter that is correlated along it
    bleed_px: float | None = None  # by how much all sides lay outwards; corners_px allow for it. None: not known
    aligned_sigma: float = 0.0  # `Aligned.sigma` when the print was last aligned, with no side off; 0: it was not

    @classmethod
    def guessed(cls, corners_px: Float, sigma_px: float) -> "FittedSquare":
        """Corners (4, 2) that are good to `sigma_px`, however they were found."""
        return cls(corners_px, np.tile(np.eye(8) / (4 * sigma_px**2), (4, 1, 1)))

    @property
    def information(self) -> Float:
        """(8, 8) inverse covariance of corners_px.ravel(), 1 / px^2; noise alone."""
        return np.asarray(self.by_side.sum(axis=0))

    @property
    def sides_seen(self) -> int:
        return int(self.seen.sum())

    @property
    def curl(self) -> float:
        """What the paper's curl may move a corner by, over the side."""
        return CURL if self.bows is None else _curl(float(self.bows.max()))

    @property
    def curl_of_two_sides(self) -> float:
        """As far as two sides show it: what bows a single one may be something that lies over it."""
        return CURL if self.bows is None else _curl(float(np.sort(self.bows)[-2]))


def _curl(bow: float) -> float:
    return min(CURL, FLAT + CURL_PER_BOW * bow)


def is_front_of_square(corners_px: Float) -> bool:
    """Whether (4, 2) corners are finite, convex, clockwise in the picture, and neither tiny nor nearly on a line."""
    # Plain numbers, as four corners are too few for arrays to be fast; what is not finite fails every comparison.
    corners = corners_px.tolist()
    sides = [(x - x0, y - y0) for (x0, y0), (x, y) in zip(corners, corners[1:] + corners[:1], strict=True)]
    lengths = [math.hypot(x, y) for x, y in sides]
    return all(length >= MIN_SIDE_PX and length < math.inf for length in lengths) and all(
        sides[one][0] * sides[after][1] - sides[one][1] * sides[after][0] > MIN_SINE * lengths[one] * lengths[after]
        for one, after in enumerate((1, 2, 3, 0))
    )


def region_around(
    corners_px: Float, margin_px: float, margin_ratio: float, shape: tuple[int, ...]
) -> tuple[tuple[int, int], tuple[int, int]] | None:
    """Left and top, right and bottom (excluded) of the corners' box within a picture of `shape` (h, w, ...).

    It is grown on each side by `margin_px` and by `margin_ratio` of its longer side. None where less than two pixels of
    it, across or down, lie in the picture: there is nothing to interpolate between.
    """
    lower, upper = corners_px.min(axis=0), corners_px.max(axis=0)
    margin = margin_px + margin_ratio * float((upper - lower).max())
    left, top = np.floor(lower - margin).clip(0, shape[1::-1]).astype(int)
    right, bottom = np.ceil(upper + margin + 1).clip(0, shape[1::-1]).astype(int)
    if min(right - left, bottom - top) < 2:
        return None
    return (int(left), int(top)), (int(right), int(bottom))
