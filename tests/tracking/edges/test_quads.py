"""Quadrilaterals are proposed where something lies over an outline, and where a shadow ends around a print."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest

from ashe_live.bench.track.frames import Cover, Flaws, PrintedMarker, ground
from ashe_live.bench.track.measures import turn_deg
from ashe_live.bench.track.takes import SMALL, pose_at
from ashe_live.core.arrays import Image
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.quads import dark_quads, half_seen_quads, ink_quads
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import SIDE_M, SPECS, frame, is_among, photographed

POSE = pose_at(0.65, 25, 20)
CORNERS = project(SMALL, POSE, square_corners(SIDE_M))
CELLS_PX = 240  # of a print's side


def with_finger(marker: Marker, number: int) -> Image:
    """(h, w, 3) as bright as skin, from beyond the paper to a fifth of the side into the square."""
    start = 0.3 + 0.05 * (number // 4)
    finger = Cover(number % 4, inwards=0.22, outwards=0.5, along=(start, start + 0.2), skew=0.0, light=0.3)
    painter = PrintedMarker(marker.bitmap(CELLS_PX), SIDE_M, SMALL, Flaws(cover=finger), 3)
    return painter.painted([POSE], np.random.default_rng(number), ground(SMALL))


def in_deep_shadow(marker: Marker, ratio: float) -> Image:
    """(h, w, 3) with a shadow that covers the print and a seventh of the side around it, not all of the paper."""
    paper = cv2.copyMakeBorder(marker.bitmap(CELLS_PX), *[CELLS_PX // 2] * 4, cv2.BORDER_CONSTANT, value=255)
    light = LINEAR_FROM_SRGB_8BIT[paper] + 0.03  # of ink
    shaded = slice(CELLS_PX // 2 - CELLS_PX // 7, -CELLS_PX // 2 + CELLS_PX // 7)
    light[shaded, shaded] *= ratio
    encoded = (255 * srgb_from_linear(0.8 * light)).round().astype(np.uint8)
    middle_px = (len(paper) - 1) / 2
    return photographed(encoded, SIDE_M / CELLS_PX, (middle_px, middle_px), SMALL, POSE)


def turn_off(marker: Marker, image_bgr: Image) -> float:
    """Degrees by which the pose found in a single picture is off; infinite where none is."""
    found = MarkerTracker(marker, SMALL, SIDE_M, BALANCED.tracking).track(frame(image_bgr)).marker
    return np.inf if found is None else turn_deg(found.measured_T_cam_marker, POSE)


@pytest.mark.parametrize("spec", SPECS)
def test_a_finger_over_a_side_does_not_hide_the_marker(spec: str, marker_of: Callable[[str], Marker]) -> None:
    marker = marker_of(spec)
    pictures = [with_finger(marker, number) for number in range(8)]
    assert all(turn_off(marker, picture) < 1.5 for picture in pictures)


def test_a_finger_over_a_side_opens_the_outline() -> None:
    """Which is why the convex hull of outlines is looked at."""
    for number in range(4):
        grey = np.ascontiguousarray(with_finger(parse_marker("aruco:4x4_50:3"), number)[:, :, 0])
        assert not is_among([*dark_quads(grey), *ink_quads(grey)], CORNERS)
        assert is_among(half_seen_quads(grey), CORNERS)


@pytest.mark.parametrize("ratio", [0.05, 0.1, 0.2])
def test_a_marker_is_found_in_a_deep_shadow_that_ends_on_its_paper(ratio: float) -> None:
    marker = parse_marker("aruco:4x4_50:3")
    assert turn_off(marker, in_deep_shadow(marker, ratio)) < 0.5


def test_a_square_without_a_corner_is_the_whole_square_and_a_triangle_is_none() -> None:
    square = np.array([(60, 40), (180, 50), (170, 160), (50, 150)], np.float64)
    grey = np.full((220, 240), 200, np.uint8)
    cv2.fillConvexPoly(grey, square.round().astype(np.int32), 20)
    cv2.fillConvexPoly(grey, np.array([(190, 40), (125, 40), (185, 105)], np.int32), 200)
    assert not is_among(dark_quads(grey), square)
    assert is_among(half_seen_quads(grey), square)
    triangle = np.full((220, 240), 200, np.uint8)
    cv2.fillConvexPoly(triangle, np.array([(60, 40), (180, 50), (110, 170)], np.int32), 20)
    assert not half_seen_quads(triangle)
