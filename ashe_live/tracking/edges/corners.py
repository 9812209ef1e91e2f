"""Sub-pixel corners of a black square: its four edges fitted by straight lines, and where these meet.

A whole edge says far more than the few pixels around a corner, and is still there when the paper's corner curls up.
Edges are measured in linear light, where blur moves none of them (in the encoded picture it eats into the black), and
in ideal pixels (see `lens`), where they are straight.
"""

import math
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.edge_lines import NEXT, information_by_side, meeting_points, robust_lines
from ashe_live.tracking.edges.lens import source_from_ideal

Light = NDArray[np.float32]

MIN_SIDE_PX = 4.0
# Of the two sides' product: the sine of the sharpest angle that still counts as a corner.
MIN_SINE = 0.05

# Where an edge is sampled along its side, and in how many places across.
ALONG_FROM, ALONG_TO = 0.06, 0.94
ACROSS = 25
FROM_INSIDE = np.linspace(-1, 1, ACROSS)
MIDDLES = ((FROM_INSIDE[1:] + FROM_INSIDE[:-1]) / 2).astype(np.float32)
HALF, TINY = np.float32(0.5), np.float32(1e-9)
# How far across, over the square's extent in that direction: within a border or margin of an eighth.
REACH_RATIO = 0.08
MIN_REACH_PX, LAST_REACH_PX = 2.0, 4.0
MORE_SEARCHES = 3
LEAST_SAMPLES = 8
# Each search reaches this much less far than the one before: a few of the steps between its samples.
NARROWING = 5.0
# What an edge must rise from black to white, of the encoded picture's range (its curve taken for a square root).
MIN_RISE = 12 / 255
# What counts as one edge: so far to each side of the steepest place. As much as a sharp edge needs, less where a small
# marker's cells lie close, and more where motion has blurred it: so many standard deviations of its rise.
SHARP_SPREADS_PX, SPREAD_RATIO = (1.0, 2.0), 1 / 12
WIDTHS = 2.2
# How much wider an edge may be than its window before it is measured again, and the rises that are noise beside it.
SLACK = 1.25
NOISE_RISE = 0.15
SHIFTS = 4
# Of a side's samples, how many must show an edge.
MIN_SEEN = 0.4

# Light where there is no picture.
OUTSIDE = -1e3
# Curled paper moves corners by up to so much of its side; how much of that is likely tells the bow of its edges. On a
# real clip edges bow by 0.012 of their length where the corners miss the pose by 0.02 to 0.03.
CURL, FLAT, CURL_PER_BOW = 0.03, 0.004, 2.4

LINEAR: Light = LINEAR_FROM_SRGB_8BIT.astype(np.float32)


@dataclass(frozen=True, slots=True)
class FittedSquare:
    """A square's corners and how sure they are."""

    corners_px: Float  # (4, 2) ideal pixels, in the order that was asked for
    by_side: Float  # (4, 8, 8) what each side tells: summed, the inverse covariance of corners_px.ravel(), 1 / px^2
    seen: Mask = field(default_factory=lambda: np.ones(4, dtype=bool))  # (4,) an unseen side is where it was guessed
    bows: Float | None = None  # (4,) of the sides, over their lengths; None: edges were not looked at
    bleed_px: float | None = None  # by how much all sides lay outwards; corners_px allow for it. None: not known

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


def linear_light(grey: Image) -> Light:
    """(h, w) linear light in [0, 1] of an encoded picture (h, w)."""
    return np.asarray(cv2.LUT(grey, LINEAR), dtype=np.float32)


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
    view = _View(light, camera, np.asarray(origin_px, dtype=np.float64))
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


@dataclass(frozen=True, slots=True)
class _View:
    """A part of the picture, asked for at ideal pixels."""

    light: Light
    camera: Camera | None
    origin_px: Float

    def at(self, x_px: Float, y_px: Float) -> Light:
        """Linear light at ideal pixels, each (ACROSS, 4, samples), interpolated; negative where the picture ends."""
        if self.camera is not None and self.camera.is_distorted:
            shape = x_px.shape
            source = source_from_ideal(self.camera, np.column_stack([x_px.ravel(), y_px.ravel()]))
            x_px, y_px = source[:, 0], source[:, 1]
            x_px, y_px = x_px.reshape(shape), y_px.reshape(shape)
        left, top = self.origin_px
        # OpenCV's remap wants fewer than 32768 rows or columns.
        x, y = (x_px - left).astype(np.float32), (y_px - top).astype(np.float32)
        rows = len(x_px), -1
        values = cv2.remap(
            self.light,
            x.reshape(rows),
            y.reshape(rows),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=OUTSIDE,
        )
        return np.asarray(values, dtype=np.float32).reshape(x_px.shape)


def _fitted(
    view: _View, corners_px: Float, samples: int, reaches_px: Float, spreads_px: Float
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
    offsets, weights, widths = _edge_offsets(view.at(x, y), reaches_px, spreads_px)
    seen = weights.sum(axis=1) >= MIN_SEEN * samples
    ends, covariances, bows = robust_lines(places, offsets, weights, lengths, seen)
    starts = corners_px + ends[:, :1] * outwards
    directions = sides + (ends[:, 1:] - ends[:, :1]) * outwards
    corners = meeting_points(starts, directions)
    return FittedSquare(corners, information_by_side(outwards, covariances), seen, bows / lengths), widths


def _rises_from_black(values: Light) -> Light:
    """(ACROSS - 1, ...) how steep the light (ACROSS, ...) rises, the more the nearer to its darkest.

    Of several rises the border's is the one from black. A floor in the sun is steeper above its paper than paper in the
    shade above its ink, in linear light; so the steps are compared in a curve like the eye's.
    """
    seen = np.sqrt(np.maximum(values, 0))
    before, after = seen[:-1], seen[1:]
    return np.asarray((after - before) * (2 * seen.max(axis=0) - before - after))


def _edge_offsets(values: Light, reaches_px: Float, spreads_px: Float) -> tuple[Float, Float, Float]:
    """How far outwards the edge lies, in pixels, whether there is one, as 0 or 1, and each side's blur.

    `values` (ACROSS, 4, samples) is the light from `reaches_px` (4,) within the sides to as far beyond them; the first
    two results are (4, samples), the third is (4,) standard deviations in pixels. The edge is the centre of gravity of
    the rise from black to white; a fall, as from paper to ground, is none.
    """
    samples = values.shape[2]
    rises = np.maximum(values[1:] - values[:-1], 0)
    # In units of the window's half width. Single precision suffices, and whole arrays are faster than broadcast ones.
    unit = np.repeat((reaches_px / spreads_px).astype(np.float32)[:, None], samples, axis=1)
    step = np.float32(2 / (ACROSS - 1)) * unit
    centres = MIDDLES[:, None, None] * unit
    borders = (_rises_from_black(values).argmax(axis=0) + HALF) * step - unit
    rises_near = np.where(np.abs(centres - borders) <= 1, rises, np.float32(-1))
    offsets = (rises_near.argmax(axis=0) + HALF) * step - unit
    # A mean shift from the steepest place: a window fixed there would pull the centre of gravity towards noise.
    for _ in range(SHIFTS):
        away = centres - offsets
        weights = rises * np.maximum(1 - away * away, 0)
        total = weights.sum(axis=0)
        offsets = (weights * centres).sum(axis=0) / np.maximum(total, TINY)
    dark = values.min(axis=0)
    rise = np.sqrt(np.maximum(dark + total, 0)) - np.sqrt(np.maximum(dark, 0))
    is_edge = ((dark >= 0) & (rise >= MIN_RISE)).astype(np.float32)
    steep = is_edge * np.maximum(rises - NOISE_RISE * rises.max(axis=0), 0)
    away = centres - (steep * centres).sum(axis=0) / np.maximum(steep.sum(axis=0), TINY)
    squared = (steep * away * away).sum(axis=(0, 2)) / np.maximum(steep.sum(axis=(0, 2)), TINY)
    return offsets * spreads_px[:, None], is_edge.astype(np.float64), np.sqrt(squared) * spreads_px
