"""Beside a cube: the model stands clear of it and of its shadow, and over a flat marker as ever."""

import dataclasses
import itertools

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.catalogue import MOST_MODELS
from ashe_live.models.placement import FOOTPRINT_SIDES, UNMOVED, seat_beside
from ashe_live.render.beside import first_places
from ashe_live.tracking.cube.faces import CORNERS
from tests.painted_cubes import CAMERA, EDGE_M, looking

BODY = Proxy("box", np.column_stack([EDGE_M * CORNERS, np.zeros((8, 2))]))


def tracked(azimuth_deg: float, body: Proxy | None = BODY) -> TrackedFrame:
    marker = MarkerPose(looking(0.5, 50, azimuth_deg), np.zeros((4, 2)), EDGE_M, 0.0, None, body=body)
    return TrackedFrame(Frame(np.zeros((480, 640, 3), np.uint8), 0, 0.0), CAMERA, marker)


def test_over_a_flat_marker_and_without_one_nothing_is_moved() -> None:
    assert first_places(tracked(30, None), None).of(0) == UNMOVED
    assert first_places(dataclasses.replace(tracked(30), marker=None), None).of(0) == UNMOVED


def test_where_the_cube_is_covered_it_stands_in_its_place() -> None:
    assert first_places(tracked(30), None, in_its_place=True).of(0) == UNMOVED
    assert first_places(tracked(30), None).of(0) != UNMOVED


@pytest.mark.parametrize("azimuth_deg", [0, 75, 200])
def test_it_stands_beside_the_cube_in_the_picture(azimuth_deg: float) -> None:
    seen = tracked(azimuth_deg)
    assert seen.marker is not None
    x, y = first_places(seen, None).of(0).shift_m
    assert np.hypot(x, y) > 1.3 * EDGE_M
    middle, beside = project(CAMERA, seen.marker.T_cam_marker, [(0, 0, 0), (x, y, 0)])
    assert beside[0] > middle[0] + 40


@pytest.mark.parametrize("aside_m", [-0.2, 0.2])
def test_beside_a_cube_near_the_pictures_rim_it_stands_where_it_is_seen(aside_m: float) -> None:
    seen = tracked(75)
    assert seen.marker is not None
    T_cam_marker = seen.marker.T_cam_marker.copy()
    T_cam_marker[0, 3] += aside_m
    marker = dataclasses.replace(seen.marker, T_cam_marker=T_cam_marker)
    x, y = first_places(dataclasses.replace(seen, marker=marker), None).of(0).shift_m
    pixels = project(CAMERA, T_cam_marker, EDGE_M * CORNERS + (x, y, 0))
    assert np.all((pixels > 0) & (pixels < seen.frame.size))


@pytest.mark.parametrize("sun_deg", range(0, 360, 30))
def test_it_stands_out_of_the_cubes_shadow(sun_deg: float) -> None:
    to_light = direction_from_angles(np.radians(sun_deg), np.radians(30))
    place = np.array(first_places(tracked(75), Light(to_light)).of(0).shift_m)
    to_shadow = -to_light[:2] / np.linalg.norm(to_light[:2])
    assert place @ to_shadow < 0.5 * np.linalg.norm(place)


@pytest.mark.parametrize("azimuth_deg", range(0, 360, 25))
def test_several_stand_clear_of_the_cube_and_of_one_another(azimuth_deg: float) -> None:
    places = first_places(tracked(azimuth_deg), None)
    stood = [(seat_beside(seat, EDGE_M) @ places.of(seat)).shift_m for seat in range(MOST_MODELS)]
    for one, other in itertools.combinations([(0.0, 0.0), *stood], 2):
        assert np.abs(np.subtract(one, other)).max() > 1.1 * FOOTPRINT_SIDES * EDGE_M


@pytest.mark.parametrize("azimuth_deg", range(0, 360, 25))
def test_several_stand_in_a_row_across_the_way_to_the_cube_that_goes_right_or_nearer_in_the_picture(
    azimuth_deg: float,
) -> None:
    """Seat 1 is that to the right of the middle, seat 2 that to the left."""
    seen = tracked(azimuth_deg)
    assert seen.marker is not None
    places = first_places(seen, None)
    middle, along = np.array(places.middle_m), np.array(places.along)
    assert along @ middle == pytest.approx(0, abs=1e-9)
    assert np.abs(along).max() == pytest.approx(1)
    right_m, left_m = ((seat_beside(seat, EDGE_M) @ places.of(seat)).shift_m for seat in (1, 2))
    assert np.add(right_m, left_m) / 2 == pytest.approx(middle)
    right, left = project(CAMERA, seen.marker.T_cam_marker, [(*right_m, 0.0), (*left_m, 0.0)])
    assert (right - left).sum() > 0, "x goes right and y down"
