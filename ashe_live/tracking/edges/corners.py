"""Sub-pixel corners of a black square: its four edges fitted by straight lines, and where these meet.

A whole edge says far more than the few pixels around a corner, and is still there when the paper's corner curls up.
Edges are measured in linear light, where blur moves none of them (in the encoded picture it eats into the black), and
in ideal pixels (see `lens`), where they are straight.
"""

import math

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.edge_lines import NEXT, information_by_side, meeting_points, robust_lines
from ashe_live.tracking.edges.edge_profiles import FROM_INSIDE, Light, LightView, edge_offsets, linear_light
from ashe_live.tracking.edges.squares import FittedSquare, is_front_of_square, region_around

# Where an edge is sampled along its side.
ALONG_FROM, ALONG_TO = 0.06, 0.94
# How far across, over the square's extent in that direction: within a border or margin of an eighth.
REACH_RATIO = 0.08
MIN_REACH_PX, LAST_REACH_PX = 2.0, 4.0
MORE_SEARCHES = 3
LEAST_SAMPLES = 8
# Each search reaches this much less far than the one before: a few of the steps between its samples.
NARROWING = 5.0
# Of a side's samples, how many must show an edge.
MIN_SEEN = 0.4
# What counts as one edge: so far to each side of the steepest place. As much as a sharp edge needs, less where a small
# marker's cells lie close, and more where motion has blurred it: so many standard deviations of its rise.
SHARP_SPREADS_PX, SPREAD_RATIO = (1.0, 2.0), 1 / 12
WIDTHS = 2.2
# How much wider an edge may be than its window before it is measured again.
SLACK = 1.25


def refined_corners(grey: Image, corners_px: Float, samples: int, off_by_px: float = 1.0) -> Float:
    """(4, 2) corners of the black square in `grey` (h, w), from coarse ones that may be `off_by_px` off.

    `samples` is how many places of each edge are measured. Where no edge is to be seen, a side stays as it was.
    """
    if not is_front_of_square(corners_px):
        return corners_px
    region = region_around(corners_px, 2 * off_by_px + MIN_REACH_PX, REACH_RATIO, grey.shape)
    if region is None:
        return corners_px
    (left, top), (right, bottom) = region
    light = linear_light(grey[top:bottom, left:right])
    fitted = fitted_square(light, corners_px, samples, off_by_px, origin_px=(left, top))
    return corners_px if fitted is None else fitted.corners_px


def fitted_square(
    light: Light,
    corners_px: Float,
    samples: int,
    off_by_px: float = 1.0,
    camera: Camera | None = None,
    origin_px: tuple[int, int] = (0, 0),
    most_reach_px: float = math.inf,
) -> FittedSquare | None:
    """The black square near `corners_px` (4, 2), ideal pixels of the whole picture that may be `off_by_px` off.

    `light` (h, w) is linear, and a part of the picture that begins at `origin_px`; a `camera` bends the way from ideal
    pixels to the picture's. Edges are looked for no farther than `most_reach_px` from the sides. None when the corners
    are no square or what was found is not the one that was asked for; where a side shows no edge it stays as it was
    and says next to nothing.
    """
    if not is_front_of_square(corners_px):
        return None
    lengths = side_lengths_px(corners_px)
    extents = abs(cv2.contourArea(corners_px.astype(np.float32))) / lengths
    reaches = np.maximum(REACH_RATIO * extents, max(MIN_REACH_PX, 1.5 * off_by_px))
    reaches = np.minimum(reaches, most_reach_px)
    view = LightView(light, camera, np.asarray(origin_px, dtype=np.float64))
    sharp = np.clip(SPREAD_RATIO * extents, *SHARP_SPREADS_PX)
    spreads = np.maximum(sharp, reaches / 4)
    # A wide search only leads to a narrow one, which measures.
    first_samples = samples if reaches.max() <= LAST_REACH_PX else max(LEAST_SAMPLES, samples // 2)
    fitted, widths = _fitted(view, corners_px, first_samples, reaches, spreads)
    narrowed = reaches
    for _ in range(MORE_SEARCHES):
        if not is_front_of_square(fitted.corners_px):
            return None
        wanted = np.clip(WIDTHS * widths, sharp, reaches)
        last_reaches = np.minimum(reaches, np.maximum(LAST_REACH_PX, wanted))
        if (narrowed <= last_reaches).all() and (wanted <= SLACK * spreads).all():
            break
        narrowed, spreads = np.maximum(narrowed / NARROWING, last_reaches), np.maximum(wanted, narrowed / NARROWING / 4)
        fitted, widths = _fitted(view, fitted.corners_px, samples, narrowed, spreads)
    if not is_front_of_square(fitted.corners_px):
        return None
    astray = np.linalg.norm(fitted.corners_px - corners_px, axis=1).max() > 4 * reaches.max()
    return None if astray else fitted


def _fitted(
    view: LightView, corners_px: Float, samples: int, reaches_px: Float, spreads_px: Float
) -> tuple[FittedSquare, Float]:
    """The lines through the edges found within `reaches_px` (4,) of the sides, where they meet, and the edges' blur."""
    sides = corners_px[NEXT] - corners_px
    lengths = np.linalg.norm(sides, axis=1)
    along = sides / lengths[:, None]
    # Clockwise in the picture, so the outside is to the left of the way along a side.
    outwards = np.column_stack([along[:, 1], -along[:, 0]])
    places = np.linspace(ALONG_FROM, ALONG_TO, samples)
    x, y = (
        corners_px[:, axis, None]
        + places * sides[:, axis, None]
        + FROM_INSIDE[:, None, None] * (reaches_px * outwards[:, axis])[:, None]
        for axis in (0, 1)
    )
    offsets, weights, widths = edge_offsets(view.at(x, y), reaches_px, spreads_px)
    seen = weights.sum(axis=1) >= MIN_SEEN * samples
    ends, covariances, bows, correlated_px2 = robust_lines(places, offsets, weights, lengths, seen)
    starts = corners_px + ends[:, :1] * outwards
    directions = sides + (ends[:, 1:] - ends[:, :1]) * outwards
    corners = meeting_points(starts, directions)
    information = information_by_side(outwards, covariances)
    return FittedSquare(corners, information, seen, bows / lengths, math.sqrt(correlated_px2)), widths
