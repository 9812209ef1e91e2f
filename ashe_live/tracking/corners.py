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
from ashe_live.tracking.edge_lines import NEXT, information_by_side, meeting_points, robust_lines
from ashe_live.tracking.lens import source_from_ideal

Light = NDArray[np.float32]

MIN_SIDE_PX = 4.0
# Of the two sides' product: the sine of the sharpest angle that still counts as a corner.
MIN_SINE = 0.05

# Where an edge is sampled along its side, and in how many places across.
ALONG_FROM, ALONG_TO = 0.06, 0.94
ACROSS = 25
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

    def at(self, points_px: Float) -> Float:
        """Linear light at ideal pixels (..., 2), interpolated; negative where the picture has ended."""
        flat = points_px.reshape(-1, 2)
        if self.camera is not None:
            flat = source_from_ideal(self.camera, flat)
        # OpenCV's remap wants fewer than 32768 rows or columns.
        x, y = (flat - self.origin_px).astype(np.float32).T.reshape(2, -1, points_px.shape[-2])
        values = cv2.remap(self.light, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=OUTSIDE)
        return values.reshape(points_px.shape[:-1]).astype(np.float64)


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
    across = np.linspace(-1, 1, ACROSS) * reaches_px[:, None]
    on_side = corners_px[:, None] + places[:, None] * sides[:, None]
    values = view.at(on_side[:, :, None] + across[:, None, :, None] * outwards[:, None, None])
    offsets, weights, widths = _edge_offsets(values, across, spreads_px)
    seen = weights.sum(axis=1) >= MIN_SEEN * samples
    ends, covariances, bows = robust_lines(places, offsets, weights, lengths, seen)
    starts = corners_px + ends[:, :1] * outwards
    directions = sides + (ends[:, 1:] - ends[:, :1]) * outwards
    corners = meeting_points(starts, directions)
    return FittedSquare(corners, information_by_side(outwards, covariances), seen, bows / lengths), widths


def _rises_from_black(values: Float) -> Float:
    """(4, samples, ACROSS - 1) how steep the light (4, samples, ACROSS) rises, the more the nearer to its darkest.

    Of several rises the border's is the one from black. A floor in the sun is steeper above its paper than paper in the
    shade above its ink, in linear light; so the steps are compared in a curve like the eye's.
    """
    seen = np.sqrt(values.clip(0))
    above = seen - seen.min(axis=2, keepdims=True)
    middle = (above[:, :, 1:] + above[:, :, :-1]) / 2
    return np.asarray(np.diff(seen, axis=2) * (above.max(axis=2, keepdims=True) - middle))


def _edge_offsets(values: Float, across: Float, spreads_px: Float) -> tuple[Float, Float, Float]:
    """How far outwards the edge lies, in pixels, whether there is one, as 0 or 1, and each side's blur.

    `values` (4, samples, ACROSS) is the light at the distances `across` (4, ACROSS) from the sides; the first two
    results are (4, samples), the third is (4,) standard deviations in pixels. The edge is the centre of gravity of the
    rise from black to white; a fall, as from paper to ground, is none.
    """
    rises = np.diff(values, axis=2).clip(0)
    centres = ((across[:, 1:] + across[:, :-1]) / 2)[:, None]
    borders = np.take_along_axis(centres[:, 0], _rises_from_black(values).argmax(axis=2), axis=1)
    near = np.abs(centres - borders[:, :, None]) <= spreads_px[:, None, None]
    offsets = np.take_along_axis(centres[:, 0], np.where(near, rises, -1.0).argmax(axis=2), axis=1)
    # A mean shift from the steepest place: a window fixed there would pull the centre of gravity towards noise.
    for _ in range(SHIFTS):
        away = (centres - offsets[:, :, None]) / spreads_px[:, None, None]
        weights = rises * (1 - away**2).clip(0)
        total = weights.sum(axis=2)
        offsets = (weights * centres).sum(axis=2) / np.maximum(total, 1e-9)
    dark = values.min(axis=2)
    rise = np.sqrt((dark + total).clip(0)) - np.sqrt(dark.clip(0))
    weights = ((dark >= 0) & (rise >= MIN_RISE)).astype(np.float64)
    steep = weights[:, :, None] * (rises - NOISE_RISE * rises.max(axis=2, keepdims=True)).clip(0)
    mass = np.maximum(steep.sum(axis=2), 1e-9)
    middle = (steep * centres).sum(axis=2) / mass
    squared = (steep * (centres - middle[:, :, None]) ** 2).sum(axis=(1, 2)) / np.maximum(steep.sum(axis=(1, 2)), 1e-9)
    return offsets, weights, np.sqrt(squared)
