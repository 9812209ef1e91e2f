"""A square as measured in the picture: its corners, their uncertainty, and whether they can be those of a square."""

import math
from dataclasses import dataclass, field

import numpy as np

from ashe_live.core.arrays import Float, Mask

MIN_SIDE_PX = 4.0
# Sine of the sharpest angle that counts as a corner.
MIN_SINE = 0.05
# Curled paper may move a corner by FLAT plus CURL_PER_BOW times the bow of the edges, and by at most CURL: all over the
# side length. In a real clip edges bow by 0.012 where corners are 0.02 to 0.03 off the pose.
CURL, FLAT, CURL_PER_BOW = 0.03, 0.004, 2.4


@dataclass(frozen=True, slots=True)
class FittedSquare:
    """A square's corners and their uncertainty."""

    corners_px: Float  # (4, 2) ideal pixels, in the order that was asked for
    by_side: Float  # (4, 8, 8) 1 / px^2, whose sum over the sides is the inverse covariance of corners_px.ravel()
    seen: Mask = field(default_factory=lambda: np.ones(4, dtype=bool))  # (4,) an unseen side is where it was guessed
    bows: Float | None = None  # (4,) sagittas of the sides over their lengths; None: edges were not measured
    correlated_px: float = 0.0  # standard deviation of a side's ends due to scatter that is correlated along it
    bleed_px: float | None = None  # outward displacement of all sides, taken out of corners_px; None: unknown
    aligned_sigma: float = 0.0  # `AlignmentStep.sigma` when the print was last aligned and no side was off; 0: never

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
        """How far curled paper may move a corner, over the side."""
        return CURL if self.bows is None else _curl(float(self.bows.max()))

    @property
    def curl_of_two_sides(self) -> float:
        """The same by the second largest bow: a single side may be bowed by something that lies over it."""
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
