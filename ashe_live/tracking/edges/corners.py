"""Sub-pixel corners of a black square: straight lines are fitted to its four edges, and intersected.

A whole edge carries far more information than the few pixels around a corner, and is still there when the paper's
corner curls up. Edges are measured in linear light, where blur does not move them (in the encoded picture it moves them
into the black), and in ideal pixels (see `lens`), in which they are straight.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.edge_lines import NEXT, information_by_side, meeting_points, robust_lines
from ashe_live.tracking.edges.edge_profiles import FROM_INSIDE, LightPatch, edge_offsets, linear_light
from ashe_live.tracking.edges.squares import FittedSquare, is_front_of_square, region_around

# An edge is sampled between these fractions of its side.
ALONG_FROM, ALONG_TO = 0.06, 0.94
# It is sampled to this distance on both sides, as a share of the square's extent across it: less than the width of a
# border or margin, which is an eighth.
REACH_RATIO = 0.08
MIN_REACH_PX, LAST_REACH_PX = 2.0, 4.0
OFF_BY_PX = 1.0  # as coarse corners may be
MORE_SEARCHES = 3
LEAST_SAMPLES = 8
# Each search reaches less far than the one before by this factor, to a few of its sampling steps.
NARROWING = 5.0
# A side counts as seen if at least this fraction of its samples shows an edge.
MIN_SEEN = 0.4
# Half width of the window around an edge's steepest place in which its position is measured. For a sharp edge it is a
# share SPREAD_RATIO of the square's extent, so that a small marker's cells stay outside, within limits in pixels; for a
# blurred edge it is WIDTHS standard deviations of the rise.
SHARP_SPREADS_PX, SPREAD_RATIO = (1.0, 2.0), 1 / 12
WIDTHS = 2.2
# An edge is measured again if the window that it needs is wider by more than this factor.
SLACK = 1.25


def refined_corners(grey: Image, corners_px: Float, samples: int) -> Float:
    """(4, 2) corners of the black square in `grey` (h, w), from coarse corners that may be OFF_BY_PX off.

    `samples` is the number of places measured along each edge. A side without a visible edge stays as it was.
    """
    if not is_front_of_square(corners_px):
        return corners_px
    region = region_around(corners_px, 2 * OFF_BY_PX + MIN_REACH_PX, REACH_RATIO, grey.shape)
    if region is None:
        return corners_px
    (left, top), (right, bottom) = region
    light = linear_light(grey[top:bottom, left:right])
    (fitted,) = fitted_squares([LightPatch(light, None, np.array((left, top)))], [corners_px], samples)
    return corners_px if fitted is None else fitted.corners_px


def fitted_squares(
    views: Sequence[LightPatch],
    corners_px: Sequence[Float],
    samples: int,
    off_by_px: float = OFF_BY_PX,
    most_reach_px: float = math.inf,
) -> list[FittedSquare | None]:
    """The black squares near `corners_px` (4, 2) each, ideal pixels that may be `off_by_px` off, each in its own part
    of the picture.

    `samples` is the number of places measured along each edge, which is searched for within `most_reach_px` of the
    side. None if the corners are no square, or if the square found is too far from them. A side that shows no edge
    stays as it was, with next to no information.

    Squares whose corners are nearly right are measured together, as setting up a measurement takes longer than the few
    hundred samples of a square.
    """
    squares = [
        _Windows.around(corners, off_by_px, most_reach_px) if is_front_of_square(corners) else None
        for corners in corners_px
    ]
    asked = [(number, square) for number, square in enumerate(squares) if square is not None]
    near = [one for one in asked if one[1].reaches_px.max() <= LAST_REACH_PX]
    # A wide search is followed by a narrow one, which measures.
    searches = [(near, samples)] if near else []
    searches += [([one], max(LEAST_SAMPLES, samples // 2)) for one in asked if one not in near]
    fitted: list[FittedSquare | None] = [None] * len(squares)
    for together, first_samples in searches:
        seen = _fitted([views[number] for number, _ in together], [first for _, first in together], first_samples)
        for (number, first), (square, widths) in zip(together, seen, strict=True):
            fitted[number] = _narrowed(views[number], first, square, widths, samples)
    return fitted


@dataclass(frozen=True, slots=True, eq=False)
class _Windows:
    """The windows in which the edges of a square are searched for and measured."""

    corners_px: Float  # (4, 2) ideal pixels
    reaches_px: Float  # (4,) to either side
    spreads_px: Float  # (4,) half widths in which an edge's position is measured
    sharp_px: Float  # (4,) the least such half widths, for sharp edges

    @classmethod
    def around(cls, corners_px: Float, off_by_px: float, most_reach_px: float) -> "_Windows":
        lengths = side_lengths_px(corners_px)
        extents = abs(cv2.contourArea(corners_px.astype(np.float32))) / lengths
        reaches = np.maximum(REACH_RATIO * extents, max(MIN_REACH_PX, 1.5 * off_by_px))
        reaches = np.minimum(reaches, most_reach_px)
        sharp = np.clip(SPREAD_RATIO * extents, *SHARP_SPREADS_PX)
        return cls(corners_px, reaches, np.maximum(sharp, reaches / 4), sharp)


def _narrowed(
    view: LightPatch, first: _Windows, fitted: FittedSquare, widths: Float, samples: int
) -> FittedSquare | None:
    """The square `fitted` by the `first` search, measured again in windows that suit the edges' `widths` (4,)."""
    reaches, sharp, spreads = first.reaches_px, first.sharp_px, first.spreads_px
    narrowed = reaches
    for _ in range(MORE_SEARCHES):
        if not is_front_of_square(fitted.corners_px):
            return None
        wanted = np.clip(WIDTHS * widths, sharp, reaches)
        last_reaches = np.minimum(reaches, np.maximum(LAST_REACH_PX, wanted))
        if (narrowed <= last_reaches).all() and (wanted <= SLACK * spreads).all():
            break
        narrowed, spreads = np.maximum(narrowed / NARROWING, last_reaches), np.maximum(wanted, narrowed / NARROWING / 4)
        ((fitted, widths),) = _fitted([view], [_Windows(fitted.corners_px, narrowed, spreads, sharp)], samples)
    if not is_front_of_square(fitted.corners_px):
        return None
    astray = np.linalg.norm(fitted.corners_px - first.corners_px, axis=1).max() > 4 * reaches.max()
    return None if astray else fitted


def _fitted(views: Sequence[LightPatch], squares: Sequence[_Windows], samples: int) -> list[tuple[FittedSquare, Float]]:
    """Each square by lines fitted to the edges near its sides, and the standard deviations (4,) of the edges' blur."""
    # The four sides of all squares, one after the other.
    corners_px = np.array([square.corners_px for square in squares])
    parts = [slice(4 * number, 4 * number + 4) for number in range(len(squares))]
    starts = corners_px.reshape(-1, 2)
    sides = (corners_px[:, NEXT] - corners_px).reshape(-1, 2)
    lengths = np.linalg.norm(sides, axis=1)
    along = sides / lengths[:, None]
    # Clockwise in the picture, so the outside is to the left of the way along a side.
    outwards = np.column_stack([along[:, 1], -along[:, 0]])

    # Where the light rises from black to white in windows across them, and the lines through these places.
    reaches_px = np.concatenate([square.reaches_px for square in squares])
    spreads_px = np.concatenate([square.spreads_px for square in squares])
    places = np.linspace(ALONG_FROM, ALONG_TO, samples)
    x, y = (
        starts[:, axis, None]
        + places * sides[:, axis, None]
        + FROM_INSIDE[:, None, None] * (reaches_px * outwards[:, axis])[:, None]
        for axis in (0, 1)
    )
    light = [view.at(x[:, part], y[:, part]) for view, part in zip(views, parts, strict=True)]
    values = np.concatenate(light, axis=1) if len(light) > 1 else light[0]
    offsets, weights, widths = edge_offsets(values, reaches_px, spreads_px)
    seen = weights.sum(axis=1) >= MIN_SEEN * samples
    lines = robust_lines(places, offsets, weights, lengths, seen)

    # The corners are where these lines meet.
    ends = lines.ends_px
    directions = sides + (ends[:, 1:] - ends[:, :1]) * outwards
    shape = corners_px.shape
    corners = meeting_points((starts + ends[:, :1] * outwards).reshape(shape), directions.reshape(shape))
    information = information_by_side(outwards.reshape(shape), lines.covariances_px2.reshape(-1, 4, 2, 2))
    bows = lines.bows_px / lengths
    fitted = []
    for number, part in enumerate(parts):
        mean_px2 = float(lines.correlated_px2[part][seen[part]].mean()) if seen[part].any() else 0.0
        square = FittedSquare(
            corners[number], information[number], seen[part], bows[part], math.sqrt(max(0.0, mean_px2))
        )
        fitted.append((square, widths[part]))
    return fitted
