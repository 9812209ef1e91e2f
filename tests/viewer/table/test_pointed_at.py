"""Which model the mouse takes up: the one under it, or the nearest."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, raycast_to_plane, rigid, transform_points
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.catalogue import load_model
from ashe_live.models.placement import UNMOVED, PlacedModel, Placement, placed_on_marker
from ashe_live.viewer.table.pointed_at import model_at

SIDE_M = 0.08
CAMERA = Camera.from_hfov((640, 480), 60)
T = rigid(cv2.Rodrigues(np.array([2.3, 0.0, 0.0]))[0], (0.0, 0.0, 0.6))
MARKER = MarkerPose(T, project(CAMERA, T, square_corners(SIDE_M)), SIDE_M, 0.1, None)
TRACKED = TrackedFrame(Frame(np.zeros((480, 640, 3), np.uint8), 0, 0.0), CAMERA, MARKER)
PLACES = UNMOVED, Placement(shift_m=(0.2, 0.0)), Placement(0.5, math.radians(30), (-0.15, 0.05))


@pytest.fixture(scope="module")
def models() -> list[tuple[PlacedModel, Placement | None]]:
    cube = placed_on_marker(load_model("cube"), SIDE_M)
    return [(cube, place) for place in PLACES]


def middle_px(placement: Placement) -> tuple[float, float]:
    """Where the middle of a cube as large as the marker is seen."""
    middle = transform_points(placement.marker_from_placed, [(0.0, 0.0, SIDE_M / 2)])
    ((x, y),) = project(CAMERA, T, middle)
    return float(x), float(y)


def test_it_is_the_one_under_the_mouse(models) -> None:
    assert [model_at(middle_px(place), TRACKED, models) for place in PLACES] == [0, 1, 2]
    back_to_front = models[::-1]
    assert [model_at(middle_px(place), TRACKED, back_to_front) for place in PLACES] == [2, 1, 0]


def test_beside_all_of_them_it_is_the_nearest(models) -> None:
    (first, row), (second, _), (third, _) = (middle_px(place) for place in PLACES)
    assert model_at((0.45 * first + 0.55 * second, row), TRACKED, models) == 1
    assert model_at((0.7 * first + 0.3 * second, row), TRACKED, models) == 0
    assert model_at((639.0, 479.0), TRACKED, models) == 1
    assert model_at((third - 60, 0.0), TRACKED, models) == 2


@pytest.mark.parametrize("outwards", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
def test_it_is_the_one_whose_outline_is_nearer_and_not_that_whose_middle_is(models, outwards) -> None:
    """Three pixels beside a large one, of which the middle is farther than that of a small one that stands apart."""
    cube, large = models[0][0], Placement(2.5)
    half = 0.5 * SIDE_M
    corners = [(x, y, z) for x in (-half, half) for y in (-half, half) for z in (0.0, SIDE_M)]
    seen = project(CAMERA, T, transform_points(large.marker_from_placed, corners))
    lower, upper = seen.min(axis=0), seen.max(axis=0)
    at = (lower + upper) / 2 + np.array(outwards) * ((upper - lower) / 2 + 3)
    ((x, y, _),) = raycast_to_plane(CAMERA, T, (at + 35 * np.array(outwards))[None])
    small = Placement(0.15, 0.0, (float(x), float(y)))
    for order in ((large, small), (small, large)):
        found = model_at((float(at[0]), float(at[1])), TRACKED, [(cube, place) for place in order])
        assert found == order.index(large)


def test_of_one_within_another_it_is_that_whose_middle_is_nearer(models) -> None:
    large, small = Placement(4.0), Placement(0.5, 0.0, (0.12, -0.02))
    cube = models[0][0]
    nested = [(cube, large), (cube, small)]
    assert model_at(middle_px(small), TRACKED, nested) == 1
    assert model_at(middle_px(large), TRACKED, nested) == 0


def test_what_is_not_in_view_is_not_taken_up(models) -> None:
    cube = models[0][0]
    at = middle_px(UNMOVED)
    assert model_at(at, TRACKED, [(cube, None), models[1]]) == 1
    assert model_at(at, TRACKED, [(cube, None)]) is None
    behind_camera = Placement(shift_m=(0.0, -3.0))
    assert model_at(at, TRACKED, [(cube, behind_camera), models[1]]) == 1
    assert model_at(at, TrackedFrame(TRACKED.frame, CAMERA, None), models) is None
