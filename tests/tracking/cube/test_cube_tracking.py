"""A cube is one marker: its pose comes from all faces that are seen, also where a flat marker would be edge-on."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose
from ashe_live.quality import BALANCED
from ashe_live.tracking import search
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.layout import cube_layout
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, Folds, frame_of, looking, sun


def tracker() -> MarkerTracker:
    return MarkerTracker(cube_layout(), CAMERA, EDGE_M, BALANCED.tracking)


def found(frame: Frame) -> MarkerPose:
    marker = tracker().track(frame).marker
    assert marker is not None
    return marker


@pytest.mark.parametrize(("tilt_deg", "azimuth_deg"), [(30, 40), (60, 160), (75, 250), (85, 65)])
def test_a_single_frame_gives_the_pose_of_the_whole_cube(tilt_deg: float, azimuth_deg: float) -> None:
    T = looking(0.35, tilt_deg, azimuth_deg)
    marker = found(frame_of(CubeScene(CAMERA, T, [sun(200, 40)])))
    assert turn_deg(marker.T_cam_marker, T) < 0.3
    assert marker.T_cam_marker[:3, 3] == pytest.approx(T[:3, 3], abs=5e-4)


def test_the_pose_carries_the_body_that_stands_on_the_table() -> None:
    marker = found(frame_of(CubeScene(CAMERA, looking(0.4, 50, 70), [sun(200, 40)])))
    assert marker.side_m == EDGE_M
    assert marker.body is not None
    points = marker.body.points_marker()
    # As the faces lie: to a tenth of a millimetre for those in view of a cube that was folded perfectly.
    assert points.min(axis=0) == pytest.approx((-EDGE_M / 2, -EDGE_M / 2, 0), abs=5e-4)
    assert points.max(axis=0) == pytest.approx((EDGE_M / 2, EDGE_M / 2, EDGE_M), abs=5e-4)
    # The square whose corners are stated is the one that it stands on.
    pixels = project(CAMERA, marker.T_cam_marker, square_corners(EDGE_M))
    assert marker.corners_px == pytest.approx(pixels, abs=1e-6)


def test_all_faces_together_are_surer_than_the_one_that_is_left_uncovered() -> None:
    T = looking(0.35, 50, 40)
    frame = frame_of(CubeScene(CAMERA, T, [sun(200, 40)]))
    whole = found(frame)
    lower = frame.image_bgr.copy()
    top_px = CAMERA.K @ (T[:3, :3] @ (0, 0, EDGE_M) + T[:3, 3])
    beneath = int(top_px[1] / top_px[2]) + 45
    lower[beneath:] = 90
    alone = found(dataclasses.replace(frame, image_bgr=lower))
    assert whole.covariance is not None
    assert alone.covariance is not None
    assert np.trace(whole.covariance[:3, :3]) < 0.5 * np.trace(alone.covariance[:3, :3])
    assert turn_deg(alone.T_cam_marker, T) < 1


def test_a_cube_folded_badly_is_found_and_less_sure_of_itself() -> None:
    T = looking(0.35, 55, 40)
    folds = Folds.drawn(np.random.default_rng(3), EDGE_M)
    straight = found(frame_of(CubeScene(CAMERA, T, [sun(200, 40)])))
    crooked = found(frame_of(CubeScene(CAMERA, T, [sun(200, 40)], folds=folds)))
    assert straight.covariance is not None
    assert crooked.covariance is not None
    assert turn_deg(crooked.T_cam_marker, T) < 2.5
    assert np.trace(crooked.covariance[:3, :3]) > np.trace(straight.covariance[:3, :3])


def test_it_is_followed_from_above_to_the_table_and_back() -> None:
    following = tracker()
    for index, tilt_deg in enumerate([*range(40, 88, 4), *range(88, 40, -4)]):
        T = looking(0.35, tilt_deg, 30 + 2 * index)
        marker = following.track(frame_of(CubeScene(CAMERA, T, [sun(200, 40)]), index)).marker
        assert marker is not None
        assert turn_deg(marker.measured_T_cam_marker, T) < 0.6


def test_once_its_folds_are_known_two_faces_are_enough_and_others_stand_in_for_covered_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked_at: list[bool] = []
    look = search.along_edges

    def along_edges(*where: Any) -> list[FittedSquare | None]:
        squares = look(*where)
        looked_at.extend(square is not None for square in squares)
        return squares

    monkeypatch.setattr(search, "along_edges", along_edges)
    T = looking(0.35, 55, 40)
    frame = frame_of(CubeScene(CAMERA, T, [sun(200, 40)]))
    following = tracker()
    found_in = []
    for index in range(8):
        looked_at.clear()
        following.track(dataclasses.replace(frame, index=index, time_s=index / 30))
        found_in.append(sum(looked_at))
    assert max(found_in) == 3
    assert found_in[-1] == 2
    covered = frame.image_bgr.copy()
    x, y = project(CAMERA, T, np.array([(0.0, 0.0, EDGE_M)]))[0].astype(int)
    covered[y - 12 : y + 12, x - 12 : x + 12] = 90
    looked_at.clear()
    marker = following.track(Frame(covered, 8, 8 / 30)).marker
    assert marker is not None
    assert len(looked_at) == 3
    assert sum(looked_at) == 2
    assert turn_deg(marker.measured_T_cam_marker, T) < 0.3
