"""Three searches for a marker in a frame: along its last edges, around its last place, and anywhere.

Each costs more than the one before it, and finds markers that that one has lost.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera, scaled_pixels
from ashe_live.core.square import side_lengths_px
from ashe_live.tracking.edges.corners import LAST_REACH_PX, REACH_RATIO, fitted_squares
from ashe_live.tracking.edges.covered_sides import verified_square
from ashe_live.tracking.edges.edge_profiles import LightPatch, linear_light
from ashe_live.tracking.edges.lens import ideal_from_source
from ashe_live.tracking.edges.quads import MIN_SIDE_PX
from ashe_live.tracking.edges.squares import FittedSquare, is_front_of_square, region_around
from ashe_live.tracking.families.dictionary_marker import DictionaryMarker
from ashe_live.tracking.families.markers import Marker

# A marker that keeps its velocity is at most this far from where it is expected.
NEAR_PX = 2.0
# A square measured in the last frame is replaced by another one only if that appears this many times as large.
STAYS = 1.3
# Fewer sides do not determine the pose.
MIN_SIDES_SEEN = 3
# "Nearby" is the bounding box of the last corners, grown on each side by this share of its longer side.
REGION_MARGIN = 0.6
# It is scaled so that the marker is between these sizes.
LARGEST_PX, SMALLEST_PX = 96.0, 48.0
MAX_ENLARGEMENT = 3.0
# From one frame to the next the marker's size changes by factors between these.
SMALLEST_NEAR, LARGEST_NEAR = 0.6, 1.7
# A thorough search of the frame finds markers down to this size, in a picture this many times as wide as a quick
# search.
THOROUGH_SIDE_PX, THOROUGH_RATIO = 8.0, 2
# Coarse corners are off by up to this much, at the scale of the search.
COARSE_PX = 1.0


def in_front(expected_px: Mapping[int, Float], last: Container[int]) -> list[int]:
    """The numbers of those squares (corners (4, 2)) whose printed side is seen, the largest in the picture first.

    Those of the `last` frame have precedence over others of about the same size: from other faces, the pose of a cube
    that is not folded exactly would be another one.
    """
    areas = {
        number: cv2.contourArea(corners_px.astype(np.float32)) * (STAYS if number in last else 1.0)
        for number, corners_px in expected_px.items()
        if is_front_of_square(corners_px)
    }
    return sorted(areas, key=lambda number: -areas[number])


@dataclass(frozen=True, slots=True, eq=False)
class Expected:
    """A marker, and where it should be."""

    marker: Marker
    corners_px: Float  # (4, 2) picture pixels, good to a tenth of its size
    aligned_sigma: float = 0.0  # of its FittedSquare in the frame before


def along_edges(
    expected: Sequence[Expected], image_bgr: Image, camera: Camera, samples: int, is_predictable: bool = False
) -> list[FittedSquare | None]:
    """Each of the markers where it is expected; None where it is not.

    Where their motion `is_predictable`, they are first looked for within NEAR_PX, which takes half the time.
    """
    around = [_view_around(one.corners_px, 6, image_bgr, camera) for one in expected]
    asked = [(number, view) for number, view in enumerate(around) if view is not None]
    ideal = [ideal_from_source(camera, expected[number].corners_px) for number, _ in asked]
    near: list[FittedSquare | None] = [None] * len(asked)
    if is_predictable:
        near = fitted_squares([view for _, view in asked], ideal, samples, most_reach_px=LAST_REACH_PX)
    squares: list[FittedSquare | None] = [None] * len(expected)
    for (number, view), corners, square in zip(asked, ideal, near, strict=True):
        if square is None or square.sides_seen < 4 or np.abs(square.corners_px - corners).max() > NEAR_PX:
            (square,) = fitted_squares([view], [corners], samples)
        if square is None or square.sides_seen < MIN_SIDES_SEEN:
            continue
        growth = side_lengths_px(square.corners_px) / side_lengths_px(corners)
        if growth.min() >= SMALLEST_NEAR and growth.max() <= LARGEST_NEAR:
            one = expected[number]
            squares[number] = verified_square(square, view, one.marker.alignment, samples, one.aligned_sigma)
    return squares


def first_along_edges(
    expected: Mapping[int, Expected],
    most: int,
    image_bgr: Image,
    camera: Camera,
    samples: int,
    is_predictable: bool,
) -> dict[int, FittedSquare | None]:
    """As `along_edges`, by number, until `most` of them have been found; the rest is not looked for."""
    squares: dict[int, FittedSquare | None] = {}
    untried = list(expected)
    while untried and most > 0:
        tried, untried = untried[:most], untried[most:]
        found = along_edges([expected[number] for number in tried], image_bgr, camera, samples, is_predictable)
        squares |= dict(zip(tried, found, strict=True))
        most -= sum(one is not None for one in found)
    return squares


def _view_around(corners_px: Float, margin_px: float, image_bgr: Image, camera: Camera) -> LightPatch | None:
    """The part of the picture around corners (4, 2), picture pixels; None where they are not in it."""
    region = region_around(corners_px, margin_px, REACH_RATIO, image_bgr.shape)
    if region is None:
        return None
    (left, top), (right, bottom) = region
    return LightPatch(linear_light(_grey(image_bgr[top:bottom, left:right])), camera, np.array((left, top)))


def nearby(marker: Marker, image_bgr: Image, last_px: Float) -> list[Float]:
    """Coarse corners (4, 2), picture pixels, of every such marker around `last_px` (4, 2)."""
    region = region_around(last_px, 4, REGION_MARGIN, image_bgr.shape)
    if region is None:
        return []
    (left, top), (right, bottom) = region
    extent = float(np.ptp(last_px, axis=0).max())
    scale = min(LARGEST_PX / extent, 1.0) if extent > SMALLEST_PX else min(SMALLEST_PX / extent, MAX_ENLARGEMENT)
    grey = _grey(image_bgr[top:bottom, left:right])
    min_side_px = SMALLEST_NEAR * float(side_lengths_px(last_px).min())
    (found,) = _found([marker], grey, scale, min_side_px, thorough=True)
    return [corners + np.array((left, top)) for corners in found]


def anywhere(markers: Sequence[Marker], image_bgr: Image, width_px: int, thorough: bool) -> list[list[Float]]:
    """For each marker the coarse corners (4, 2), picture pixels, of every such one in a frame searched at `width_px`.

    Markers of one dictionary are looked for together.
    """
    width = image_bgr.shape[1]
    scale = min(1.0, (THOROUGH_RATIO if thorough else 1) * width_px / width)
    min_side_px = (THOROUGH_SIDE_PX if thorough else MIN_SIDE_PX) / scale
    return _found(markers, _grey(image_bgr), scale, min_side_px, thorough)


def refined(marker: Marker, image_bgr: Image, camera: Camera, coarse_px: Float, samples: int) -> FittedSquare | None:
    """The marker at coarse corners (4, 2), picture pixels, measured at full resolution; None when it is not there."""
    off_by_px = max(COARSE_PX, float(np.ptp(coarse_px, axis=0).max()) / LARGEST_PX)
    view = _view_around(coarse_px, 2 * off_by_px + 4, image_bgr, camera)
    if view is None:
        return None
    ideal = ideal_from_source(camera, coarse_px)
    (square,) = fitted_squares([view], [ideal], samples, off_by_px)
    if square is None and is_front_of_square(ideal):
        square = FittedSquare.guessed(ideal, off_by_px)
    return None if square is None else verified_square(square, view, marker.alignment, samples)


def _found(
    markers: Sequence[Marker], grey: Image, scale: float, min_side_px: float, thorough: bool
) -> list[list[Float]]:
    """Searched at `scale`; all in pixels of `grey`."""
    if scale == 1:
        return _found_in(markers, grey, min_side_px, thorough)
    height, width = grey.shape
    size = max(1, round(width * scale)), max(1, round(height * scale))
    interpolation = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    scaled = np.asarray(cv2.resize(grey, size, interpolation=interpolation), dtype=np.uint8)
    steps = np.array((width, height)) / size
    found = _found_in(markers, scaled, min_side_px * scale, thorough)
    return [[scaled_pixels(corners, steps) for corners in each] for each in found]


def _found_in(markers: Sequence[Marker], grey: Image, min_side_px: float, thorough: bool) -> list[list[Float]]:
    first, *others = markers
    if isinstance(first, DictionaryMarker):
        alike = [first, *(other for other in others if isinstance(other, DictionaryMarker))]
        if len(alike) == len(markers) and all(first.is_of_dictionary(other) for other in alike):
            return first.find_several(alike, grey, min_side_px, thorough)
    return [marker.find(grey, min_side_px, thorough) for marker in markers]


def _grey(image_bgr: Image) -> Image:
    return np.asarray(cv2.cvtColor(image_bgr, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
