"""Markers beside the one that is followed: where they lie on its plane, by painted pictures."""

import math

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.quality import BALANCED
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.plane_markers import PlaneMarkers
from ashe_live.tracking.tracker import MarkerTracker
from tests.tracking.conftest import SIDE_M, frame, photographed, pose

CAMERA = Camera.from_focal((640, 480), 600.0)
FOLLOWED, OTHER = (parse_marker(f"aruco:4x4_50:{number}") for number in (0, 7))
PX_PER_M = 4000
TABLE_PX = 2400


def table(centre_m, turn_deg, share=1.0, number=OTHER):
    """A white sheet with the followed marker in its middle and another one turned beside it, y up."""
    sheet = np.full((TABLE_PX, TABLE_PX), 255, np.uint8)
    for marker, (x, y), degrees, side_m in (
        (FOLLOWED, (0, 0), 0, SIDE_M),
        (number, centre_m, turn_deg, share * SIDE_M),
    ):
        side_px = round(side_m * PX_PER_M)
        about = cv2.getRotationMatrix2D(((side_px - 1) / 2, (side_px - 1) / 2), degrees, 1.0)
        about[:, 2] += (TABLE_PX - 1) / 2 + PX_PER_M * np.array((x, -y)) - (side_px - 1) / 2
        print_px = cv2.warpAffine(marker.bitmap(side_px), about, sheet.shape, borderValue=255)
        sheet = np.minimum(sheet, print_px)
    return sheet


def seen(sheet, T_cam_marker, index=0):
    middle = (TABLE_PX - 1) / 2
    return frame(photographed(sheet, 1 / PX_PER_M, (middle, middle), CAMERA, T_cam_marker), index)


def tracker():
    made = MarkerTracker(FOLLOWED, CAMERA, SIDE_M, BALANCED.tracking)
    made.others = PlaneMarkers([OTHER])
    return made


@pytest.mark.parametrize(
    ("centre_m", "turn_deg", "share", "tilt_deg"),
    [((0.15, 0.05), 0, 1.0, 20), ((-0.12, -0.1), 135, 1.0, 45), ((0.13, -0.06), -60, 0.6, 50)],
)
def test_it_is_found_where_it_lies(centre_m, turn_deg, share, tilt_deg):
    tracked = tracker().track(seen(table(centre_m, turn_deg, share), pose(0.7, tilt_deg)))
    (found,) = tracked.others
    assert found.spec == OTHER.spec
    np.testing.assert_allclose(found.centre_m, centre_m, atol=0.001)
    assert abs(math.remainder(found.turn_rad - math.radians(turn_deg), math.tau)) < math.radians(1)
    assert found.side_m == pytest.approx(share * SIDE_M, rel=0.015)


def test_a_place_is_the_mean_over_the_frames():
    first, second = (seen(table((0.15 + moved_m, 0.05), 0), pose(0.7, 20), i) for i, moved_m in enumerate((0, 4e-4)))
    alone = [tracker().track(one).others[0].centre_m for one in (first, second)]
    both = tracker()
    both.track(first)
    (found,) = both.track(second).others
    np.testing.assert_allclose(found.centre_m, np.mean(alone, axis=0), atol=2e-5)


def test_it_is_held_still_and_follows_when_it_is_moved():
    following, places = tracker(), []
    for index in range(12):
        sheet = table((0.15, 0.05) if index < 8 else (0.15, 0.0), 20)
        tracked = following.track(seen(sheet, pose(0.7, 40 + 0.2 * index), index))
        places.append(tracked.others[0].centre_m if tracked.others else None)
    assert all(place is not None for place in places[:8])
    assert np.ptp(places[2:8], axis=0).max() < 0.0005
    np.testing.assert_allclose(places[-1], (0.15, 0.0), atol=0.001)  # looked for again within a fifth of a second


def test_what_is_not_there_is_not_said_and_another_number_is_another_marker():
    following = tracker()
    alone = table((0.15, 0.05), 0, number=parse_marker("aruco:4x4_50:9"))
    assert following.track(seen(alone, pose(0.7, 40))).others == ()
    assert following.track(frame(np.full((480, 640, 3), 120, np.uint8), 1)).others == ()


def test_one_that_stands_upright_is_none_of_the_plane():
    """The other marker is painted where the camera would see it on a wall behind the table."""
    T_cam_table = pose(0.7, 55)
    wall = np.eye(4)
    wall[:3, :3] = cv2.Rodrigues(np.array((math.pi / 2, 0, 0)))[0]
    wall[:3, 3] = 0.12, 0.1, 0.06
    picture = seen(table((5.0, 5.0), 0), T_cam_table).image_bgr.copy()
    side_px = 320
    paper = cv2.copyMakeBorder(OTHER.bitmap(side_px), *[80] * 4, cv2.BORDER_CONSTANT, value=255)
    middle = (paper.shape[0] - 1) / 2
    upright = photographed(paper, SIDE_M / side_px, (middle, middle), CAMERA, T_cam_table @ wall, 0.0)
    picture[upright != 120] = upright[upright != 120]
    square = OTHER.find(np.ascontiguousarray(picture[..., 1]))
    assert len(square) == 1  # it is there to be read
    tracked = tracker().track(frame(picture))
    assert tracked.marker is not None
    assert tracked.others == ()
