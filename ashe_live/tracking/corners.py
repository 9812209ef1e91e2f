"""Sub-pixel corners of a black square: its four edges fitted by straight lines, and where these meet.

A whole edge says far more than the few pixels around a corner, and is still there when the paper's corner curls up.
"""

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image, Mask

MIN_SIDE_PX = 4.0
# Of the two sides' product: the sine of the sharpest angle that still counts as a corner.
MIN_SINE = 0.05

# Where an edge is sampled along its side, and in how many places across.
ALONG_FROM, ALONG_TO = 0.06, 0.94
ACROSS = 25
# How far across, over the square's extent in that direction: within a border or margin of an eighth.
REACH_RATIO = 0.08
MIN_REACH_PX, LAST_REACH_PX = 2.0, 4.0
# Each search reaches this much less far than the one before: a few of the steps between its samples.
NARROWING = 5.0
# Grey levels that an edge must rise from black to white.
MIN_RISE = 12.0
# What counts as one edge: so far to each side of the steepest place.
MIN_SPREAD_PX = 2.0
SHIFTS = 4
# Points farther than this from the line do not count (Tukey's biweight).
OUTLIER_PX = 1.5

# Each corner's neighbours along the outline; np.roll would take ten times as long, and this runs in every frame.
NEXT, BEFORE = np.array([1, 2, 3, 0]), np.array([3, 0, 1, 2])


def side_lengths_px(corners_px: Float) -> Float:
    """(4,) lengths of the sides of a quadrilateral (4, 2), each from its corner to the next."""
    return np.asarray(np.linalg.norm(corners_px[NEXT] - corners_px, axis=1))


def is_front_of_square(corners_px: Float) -> bool:
    """Whether (4, 2) corners are finite, convex, clockwise in the picture, and neither tiny nor nearly on a line."""
    if not np.isfinite(corners_px).all():
        return False
    lengths = side_lengths_px(corners_px)
    sides = corners_px[NEXT] - corners_px
    after = sides[NEXT]
    turns = sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0]
    return bool(lengths.min() >= MIN_SIDE_PX and (turns > MIN_SINE * lengths * lengths[NEXT]).all())


def refined_corners(grey: Image, corners_px: Float, samples: int, off_by_px: float = 1.0) -> Float:
    """(4, 2) corners of the black square in `grey` (h, w), from coarse ones that may be `off_by_px` off.

    `samples` is how many places of each edge are measured. Where no edge is to be seen, a side stays as it was.
    """
    if not is_front_of_square(corners_px):
        return corners_px
    lengths = side_lengths_px(corners_px)
    extents = abs(cv2.contourArea(corners_px.astype(np.float32))) / lengths
    reaches = np.maximum(REACH_RATIO * extents, max(MIN_REACH_PX, 1.5 * off_by_px))
    refined = _fitted(grey, corners_px, samples, reaches)
    narrowed = reaches
    while narrowed.max() > LAST_REACH_PX and np.isfinite(refined).all():
        narrowed = np.maximum(narrowed / NARROWING, np.minimum(reaches, LAST_REACH_PX))
        refined = _fitted(grey, refined, samples, narrowed)
    astray = np.linalg.norm(refined - corners_px, axis=1).max() > 4 * reaches.max()
    return corners_px if astray or not is_front_of_square(refined) else refined


def _fitted(grey: Image, corners_px: Float, samples: int, reaches_px: Float) -> Float:
    """Corners (4, 2) of the lines through the edges found within `reaches_px` (4,) of the sides."""
    sides = corners_px[NEXT] - corners_px
    along = sides / np.linalg.norm(sides, axis=1)[:, None]
    # Clockwise in the picture, so the outside is to the left of the way along a side.
    outwards = np.column_stack([along[:, 1], -along[:, 0]])
    places = np.linspace(ALONG_FROM, ALONG_TO, samples)
    offsets, weights = _edge_offsets(grey, corners_px, sides, outwards, places, reaches_px)
    at_start, slope = _robust_lines(places, offsets, weights)
    starts = corners_px + at_start[:, None] * outwards
    return _meeting_points(starts, sides + slope[:, None] * outwards)


def _edge_offsets(
    grey: Image, corners_px: Float, sides: Float, outwards: Float, places: Float, reaches_px: Float
) -> tuple[Float, Float]:
    """How far outwards of each place the edge lies, in pixels, and whether there is one, as 0 or 1; both (4, samples).

    The edge is the centre of gravity of the rise from black to white; a fall, as from paper to ground, is none.
    """
    across = np.linspace(-1, 1, ACROSS) * reaches_px[:, None]
    on_side = corners_px[:, None] + places[:, None] * sides[:, None]
    points = on_side[:, :, None] + across[:, None, :, None] * outwards[:, None, None]
    x, y = np.moveaxis(points.reshape(-1, ACROSS, 2).astype(np.float32), 2, 0)
    values = cv2.remap(grey, x.copy(), y.copy(), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rises = np.diff(values.reshape(4, len(places), ACROSS).astype(np.float64), axis=2).clip(0)
    centres = (across[:, 1:] + across[:, :-1]) / 2
    spreads = np.maximum(MIN_SPREAD_PX, reaches_px / 4)[:, None, None]
    offsets = np.take_along_axis(centres, rises.argmax(axis=2), axis=1)
    # A mean shift from the steepest place: a window fixed there would pull the centre of gravity towards noise.
    for _ in range(SHIFTS):
        away = (centres[:, None] - offsets[:, :, None]) / spreads
        weights = rises * (1 - away**2).clip(0)
        total = weights.sum(axis=2)
        offsets = (weights * centres[:, None]).sum(axis=2) / np.maximum(total, 1e-9)
    return offsets, (total >= MIN_RISE).astype(np.float64)


def _robust_lines(places: Float, offsets: Float, weights: Float) -> tuple[Float, Float]:
    """Offset at place 0 and slope (4,) of each side's line, by least squares reweighted with Tukey's biweight.

    A side with fewer than half of its samples stays: both are 0.
    """
    seen = weights.sum(axis=1) >= len(places) / 2
    # The first line goes through the middle of the offsets, so that a few wrong ones do not carry it away.
    middle = _medians(offsets, weights > 0)
    at_start, slope = middle, np.zeros(4)
    for scale in (8.0, 4.0, 2.0, 1.0):
        residuals = offsets - at_start[:, None] - slope[:, None] * places
        kept = weights * (1 - np.minimum((residuals / (scale * OUTLIER_PX)) ** 2, 1)) ** 2
        mass = np.maximum(kept.sum(axis=1), 1e-9)
        place = (kept * places).sum(axis=1) / mass
        offset = (kept * offsets).sum(axis=1) / mass
        from_place = places - place[:, None]
        slope = (kept * from_place * offsets).sum(axis=1) / np.maximum((kept * from_place**2).sum(axis=1), 1e-9)
        at_start = offset - slope * place
    return np.where(seen, at_start, 0.0), np.where(seen, slope, 0.0)


def _medians(values: Float, counts: Mask) -> Float:
    """Median of each row's values that count; 0 where none does."""
    ordered = np.sort(np.where(counts, values, np.inf), axis=1)
    numbers = counts.sum(axis=1)
    rows = np.arange(len(values))
    medians = (ordered[rows, (numbers - 1) // 2] + ordered[rows, numbers // 2]) / 2
    return np.where(numbers > 0, medians, 0.0)


def _meeting_points(starts: Float, directions: Float) -> Float:
    """(4, 2) where each side's line meets the one before it; NaN when they are parallel."""
    before, towards = starts[BEFORE], directions[BEFORE]
    cross = towards[:, 0] * directions[:, 1] - towards[:, 1] * directions[:, 0]
    gap = starts - before
    cross = np.where(np.abs(cross) > 1e-9, cross, np.nan)
    way = (gap[:, 0] * directions[:, 1] - gap[:, 1] * directions[:, 0]) / cross
    return np.asarray(before + way[:, None] * towards)
