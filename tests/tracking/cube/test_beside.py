"""A flat marker beside the cube becomes one board with it, wherever it lies, and stops being one when it is moved."""

from functools import cache

import cv2
import numpy as np
import pytest

from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Float, Image
from ashe_live.core.square import PlaneMarker, mean_side_px, square_corners
from ashe_live.core.transforms import project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.pixels.view import View
from ashe_live.quality import BALANCED
from ashe_live.tracking.cube.beside import BESIDE_NUMBER, MOVED, PLACED_AFTER, FlatBeside
from ashe_live.tracking.cube.faces import FACES, TAG_SHARE
from ashe_live.tracking.edges.squares import FittedSquare
from ashe_live.tracking.families.layout import parse_target, usual_side_m
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from tests.painted_cubes import CAMERA, EDGE_M, CubeScene, frame_of, looking, sun

FLAT = "aruco:4x4_50:3"
LYING = PlaneMarker(FLAT, np.array([0.1, 0.02]), 0.4, 0.05)
ELSEWHERE = PlaneMarker(FLAT, np.array([0.1, 0.035]), 0.4, 0.05)
MARGIN = 0.25  # of the paper around the square, over its side
FINER = 4
FARTHEST = 7  # place of the camera, degrees around the cube


def with_flat(image: Image, T_cam_cube: Float, lying: PlaneMarker) -> Image:
    """The picture with the flat marker's sheet on the table."""
    square = cv2.copyMakeBorder(parse_marker(FLAT).bitmap(240), 60, 60, 60, 60, cv2.BORDER_CONSTANT, value=255)
    ends = np.array([(0, 0), (360, 0), (360, 360), (0, 360)], np.float32) - np.float32(0.5)
    corners = lying.on_plane(square_corners(lying.side_m * (1 + 2 * MARGIN)))
    fine_px = (FINER * (project(CAMERA, T_cam_cube, corners) + 0.5) - 0.5).astype(np.float32)
    H = cv2.getPerspectiveTransform(ends, fine_px)
    size = CAMERA.size[0] * FINER, CAMERA.size[1] * FINER
    seen, covered = (
        cv2.resize(cv2.warpPerspective(each, H, size), CAMERA.size, interpolation=cv2.INTER_AREA)[..., None]
        for each in ((20 + square * 0.8).astype(np.float32), np.ones(square.shape, np.float32))
    )
    return np.round(image * (1 - covered) + seen).astype(np.uint8)


def place_of(index: int) -> int:
    """Of the camera, which goes to and fro, so that few pictures make a long clip."""
    return min(index % (2 * FARTHEST), -index % (2 * FARTHEST))


def view_of(index: int) -> Float:
    return looking(0.42, 48, 40 + place_of(index))


@cache
def picture_from(place: int, is_moved: bool) -> Image:
    T = looking(0.42, 48, 40 + place)
    painted = frame_of(CubeScene(CAMERA, T, [sun(200, 40)], seed=place)).image_bgr
    return with_flat(painted, T, ELSEWHERE if is_moved else LYING)


def frame_at(index: int, is_moved: bool = False) -> Frame:
    return Frame(picture_from(place_of(index), is_moved), index, index / 30)


def without_cube(frame: Frame, T_cam_cube: Float) -> Frame:
    """The cube behind a hand."""
    image = frame.image_bgr.copy()
    half = EDGE_M * 0.62
    box = np.array([(x, y, z) for x in (-half, half) for y in (-half, half) for z in (0, 1.15 * EDGE_M)])
    hull = cv2.convexHull(project(CAMERA, T_cam_cube, box).astype(np.float32))[:, 0]
    cv2.fillConvexPoly(image, np.round(hull).astype(np.int32), (90, 110, 140))
    return Frame(image, frame.index, frame.time_s)


@pytest.fixture(scope="module")
def followed() -> tuple[MarkerTracker, list[TrackedFrame]]:
    tracker = MarkerTracker(parse_target(f"cube+{FLAT}"), CAMERA, EDGE_M, BALANCED.tracking)
    return tracker, [tracker.track(frame_at(index)) for index in range(PLACED_AFTER + 4)]


@pytest.fixture
def knowing() -> tuple[MarkerTracker, int]:
    """A tracker that knows where the marker lies, and how many frames it has seen."""
    tracker = MarkerTracker(parse_target(f"cube+{FLAT}"), CAMERA, EDGE_M, BALANCED.tracking)
    count = PLACED_AFTER + 2
    for index in range(count):
        tracker.track(frame_at(index))
    return tracker, count


def test_where_it_lies_is_learned(followed: tuple[MarkerTracker, list[TrackedFrame]]) -> None:
    *_, last = followed[1]
    assert followed[1][0].others == ()
    (lying,) = last.others
    assert lying.spec == FLAT
    assert lying.centre_m == pytest.approx(LYING.centre_m, abs=1e-3)
    assert lying.turn_rad == pytest.approx(LYING.turn_rad, abs=0.01)
    assert lying.side_m == pytest.approx(LYING.side_m, rel=0.01)


def test_both_are_surer_than_the_cube_alone(followed: tuple[MarkerTracker, list[TrackedFrame]]) -> None:
    alone = MarkerTracker(parse_target("cube"), CAMERA, EDGE_M, BALANCED.tracking)
    by_cube = [alone.track(frame_at(index)) for index in range(PLACED_AFTER + 4)]
    noise = []
    for several in (followed[1], by_cube):
        marker = several[-1].marker
        assert marker is not None
        assert marker.noise_covariance is not None
        assert turn_deg(marker.measured_T_cam_marker, view_of(len(several) - 1)) < 0.3
        noise.append(np.trace(marker.noise_covariance[:3, :3]))
    assert noise[0] < 0.8 * noise[1]


def test_its_sheet_is_no_ground(followed: tuple[MarkerTracker, list[TrackedFrame]]) -> None:
    view = View.of(followed[1][-1], CAMERA.size[0])
    x, y = project(CAMERA, view_of(PLACED_AFTER + 3), LYING.on_plane(np.zeros((1, 3))))[0].round().astype(int)
    assert not view.is_ground[y - 3 : y + 4, x - 3 : x + 4].any()


def test_while_the_cube_is_covered_it_determines_the_pose_alone(knowing: tuple[MarkerTracker, int]) -> None:
    tracker, count = knowing
    for index in range(count, count + 8):
        marker = tracker.track(without_cube(frame_at(index), view_of(index))).marker
        assert marker is not None
        assert not marker.bridged
        assert turn_deg(marker.measured_T_cam_marker, view_of(index)) < 1.0
        assert marker.measured_T_cam_marker[:3, 3] == pytest.approx(view_of(index)[:3, 3], abs=3e-3)


def test_one_that_is_moved_is_learned_anew_and_does_not_pull_the_cube_along(knowing: tuple[MarkerTracker, int]) -> None:
    tracker, count = knowing
    for index in range(count, count + 2 * PLACED_AFTER + 4):
        tracked = tracker.track(frame_at(index, is_moved=True))
        assert tracked.marker is not None
        assert turn_deg(tracked.marker.measured_T_cam_marker, view_of(index)) < 0.5
    (lying,) = tracked.others
    assert lying.centre_m == pytest.approx(ELSEWHERE.centre_m, abs=1e-3)


@pytest.fixture
def placed() -> tuple[FlatBeside, dict[int, FittedSquare], MarkerPose]:
    """A marker whose place is known, the squares of a frame by their numbers (a face of the cube, and it), the pose."""
    beside, T = FlatBeside(parse_marker(FLAT)), view_of(0)
    beside.placed, beside.corners = LYING, LYING.on_plane(square_corners(LYING.side_m))
    seen = project(CAMERA, T, EDGE_M * FACES[0].corners(TAG_SHARE)), project(CAMERA, T, beside.corners)
    squares = {number: FittedSquare.guessed(px, 0.05) for number, px in zip((0, BESIDE_NUMBER), seen, strict=True)}
    return beside, squares, MarkerPose(T, seen[0], EDGE_M, 0.1, None)


def test_one_that_is_taken_away_is_missed_after_a_while_in_which_the_cube_is_seen(placed) -> None:
    """And not because a hand covers it for a moment, or because the cube is covered."""
    beside, squares, pose = placed
    cube, flat = {0: squares[0]}, {BESIDE_NUMBER: squares[BESIDE_NUMBER]}
    for _ in range(3):
        assert not any(beside.has_moved(cube, pose, CAMERA) for _ in range(PLACED_AFTER - 1))
        assert not beside.has_moved(squares, pose, CAMERA)
    for unseen in ({}, flat):
        assert not any(beside.has_moved(unseen, pose, CAMERA) for _ in range(2 * PLACED_AFTER))
    assert [beside.has_moved(cube, pose, CAMERA) for _ in range(PLACED_AFTER)] == [False] * (PLACED_AFTER - 1) + [True]
    beside.forget()
    assert not any(beside.has_moved(cube, pose, CAMERA) for _ in range(2 * PLACED_AFTER)), "it lies nowhere"


def test_it_has_moved_where_it_is_seen_a_tenth_of_its_side_from_where_it_lay(placed) -> None:
    beside, squares, pose = placed
    there = squares[BESIDE_NUMBER].corners_px
    for share, has_moved in ((0.0, False), (0.8 * MOVED, False), (1.25 * MOVED, True)):
        off = there + share * mean_side_px(there) * np.array((0.6, -0.8))
        seen = {**squares, BESIDE_NUMBER: FittedSquare.guessed(off, 0.05)}
        assert beside.has_moved(seen, pose, CAMERA) is has_moved
    assert beside.has_moved(squares, None, CAMERA), "no pose explains both"
    assert not beside.has_moved({BESIDE_NUMBER: squares[BESIDE_NUMBER]}, None, CAMERA), "it alone says nothing of that"


def test_a_frame_that_no_pose_explains_leaves_the_cube_to_be_found_in_the_next(
    knowing: tuple[MarkerTracker, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    tracker, count = knowing
    with monkeypatch.context() as patched:
        patched.setattr("ashe_live.tracking.members.pose_of_squares", lambda *_, **__: None)
        assert tracker.track(frame_at(count)).marker is None
    tracked = tracker.track(frame_at(count + 1))
    assert tracked.marker is not None
    assert tracked.others == ()  # it is learned anew
    assert turn_deg(tracked.marker.measured_T_cam_marker, view_of(count + 1)) < 0.5


def test_the_cube_is_measured_by_its_edge_whatever_lies_beside_it() -> None:
    assert usual_side_m(f"cube+{FLAT}") == usual_side_m("cube")
    with pytest.raises(UserError, match="on the cube already"):
        parse_target("cube+aruco:4x4_50:20")
