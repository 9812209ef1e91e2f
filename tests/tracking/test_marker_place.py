"""Whether the marker was moved or the camera: on a painted table, where both are known."""

import math
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import cast

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import angle_between, image_from_plane, inverse_rigid, project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.key_views import KeyViews
from ashe_live.tracking.marker_place import LOST_S, MarkerPlace
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.sources.scene_tracker import SceneTracker
from tests.light.painted_scenes import BOX, SIDE_M, paint
from tests.light.synthetic_masks import camera_towards

FPS = 30
CAMERA = Camera.from_hfov((640, 480), 60)
TABLE_M, CELLS = 1.2, 1200


@cache
def table(grain: float) -> np.ndarray:
    """A table's top, (n, n, 3): noise of several sizes, `grain` grey levels deep."""
    rng = np.random.default_rng(3)
    noise = sum(cv2.GaussianBlur(rng.normal(0, 1, (CELLS, CELLS)), (0, 0), size) * size for size in (3, 6, 12))
    return np.clip(130 + grain * noise / noise.std(), 0, 255).astype(np.uint8)[..., None].repeat(3, axis=2)


def seen(T_cam_room: Float, T_room_marker: Float, time_s: float, grain: float = 20.0, exposure: float = 1.0):
    """The table with the marker's sheet on it, wherever that was put; noise of two grey levels."""
    cells = TABLE_M / CELLS
    plane = np.array([[cells, 0, -TABLE_M / 2], [0, cells, -TABLE_M / 2], [0, 0, 1]])
    image = cv2.warpPerspective(table(grain), image_from_plane(CAMERA, T_cam_room) @ plane, CAMERA.size, borderValue=90)
    T_cam_marker = T_cam_room @ T_room_marker
    for side, level in ((1.3 * SIDE_M, 225), (SIDE_M, 25), (0.4 * SIDE_M, 225)):
        corners = np.round(16 * project(CAMERA, T_cam_marker, square_corners(side))).astype(np.int32)
        cv2.fillConvexPoly(image, corners, (level,) * 3, cv2.LINE_AA, 4)
    rng = np.random.default_rng(int(1e3 * time_s))
    noise = 2 * rng.standard_normal((*image.shape[:2], 1), dtype=np.float32)
    image = np.clip(np.float32(exposure) * image + noise, 0, 255).astype(np.uint8)
    corners_px = project(CAMERA, T_cam_marker, square_corners(SIDE_M))
    pose = MarkerPose(T_cam_marker, corners_px, SIDE_M, 0.1, None)
    return TrackedFrame(Frame(image, round(time_s * FPS), time_s), CAMERA, pose)


def lying(turn_deg: float, x: float = 0.0, y: float = 0.0) -> Float:
    """T_room_marker of a sheet on the table."""
    cosine, sine = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    return rigid([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], [x, y, 0])


def view(azimuth_deg: float = 0.0, pitch_deg: float = 45.0) -> Float:
    return camera_towards((0.02, 0.0), 0.5, pitch_deg, 90 + azimuth_deg)


def followed(frames: Iterable[TrackedFrame], marker_place: MarkerPlace | None = None) -> list[Float]:
    marker_place = marker_place or MarkerPlace()
    return [np.asarray(marker_place.add(frame).T_room_marker) for frame in frames]


def assert_near(found: Float, true: Float, degrees: float, mm: float) -> None:
    between = inverse_rigid(true) @ found
    assert math.degrees(float(np.linalg.norm(cv2.Rodrigues(between[:3, :3])[0]))) < degrees
    assert 1e3 * float(np.linalg.norm(between[:3, 3])) < mm


TURNED = [lying(3.0 * k, 0.001 * k, -0.0005 * k) for k in range(31)]


@cache
def turned() -> list[TrackedFrame]:
    """The sheet turned and moved before a still camera."""
    return [seen(view(), place, k / FPS) for k, place in enumerate(TURNED)]


@cache
def resting() -> list[TrackedFrame]:
    """Ten frames a second of a sheet that lies still."""
    return [seen(view(), lying(0), k / 10) for k in range(30)]


@pytest.mark.parametrize("exposure", [1.0, 0.75])
def test_a_marker_that_is_turned_before_a_still_camera(exposure) -> None:
    gains = np.linspace(1, exposure, len(TURNED))
    places = followed(seen(view(), place, k / FPS, exposure=gains[k]) for k, place in enumerate(TURNED))
    for place, true in zip(places[3:], TURNED[3:], strict=True):
        assert_near(place, true, 3.5, 2.5)  # of a frame before, while nothing has been compared yet
    assert_near(places[-1], TURNED[-1], 0.5, 1)


def test_a_camera_that_moves_round_a_marker_moves_no_marker() -> None:
    frames = (seen(view(k - 30), lying(0), k / FPS) for k in range(61))
    assert len({id(place) for place in followed(frames)}) == 1


def test_nor_does_one_that_comes_nearer_and_turns() -> None:
    poses = [camera_towards((0.02 + 0.002 * k, 0), 0.6 - 0.008 * k, 35 + 0.8 * k, 90 + 0.5 * k) for k in range(31)]
    places = followed(seen(pose, lying(0), k / FPS) for k, pose in enumerate(poses))
    assert len({id(place) for place in places}) == 1


def test_nor_does_one_that_moves_round_a_thing_that_stands_there() -> None:
    sides = [paint(BOX, T_cam_marker=view(k), seed=k + 9).tracked for k in range(0, 24, 2)]
    frames = [replace(side, frame=Frame(side.frame.image_bgr, k, k / 10)) for k, side in enumerate(sides)]
    assert len({id(place) for place in followed(frames)}) == 1


@pytest.mark.parametrize("tremble_deg", [0.0, 0.3])
def test_both_may_move_at_once(tremble_deg) -> None:
    """The camera around the table, or in a hand that trembles."""
    rng = np.random.default_rng(1)
    round_deg = 0.0 if tremble_deg else 0.4
    places = []
    marker_place = MarkerPlace()
    for k, true in enumerate(TURNED):
        tremble = cv2.Rodrigues(np.radians(tremble_deg * rng.normal(size=3)))[0]
        T_cam_room = rigid(tremble, np.zeros(3)) @ view(round_deg * k)
        places += followed([seen(T_cam_room, true, k / FPS)], marker_place)
    assert_near(places[-1], TURNED[-1], 2.0, 8)


def test_on_plain_ground_nothing_shows_that_the_marker_is_moved() -> None:
    places = followed(seen(view(), place, k / FPS, grain=0.0) for k, place in enumerate(TURNED))
    assert len({id(place) for place in places}) == 1


def test_a_marker_that_was_out_of_view_may_lie_elsewhere() -> None:
    first, last = seen(view(), lying(0), 0.0), seen(view(), lying(140, 0.06, -0.03), 1.5)
    away = replace(seen(view(), lying(0), 0.5), marker=None)
    before, meanwhile, after = followed([first, away, last])
    assert meanwhile is before
    assert_near(after, lying(140, 0.06, -0.03), 0.5, 1)


def test_it_may_lie_elsewhere_although_the_hand_that_moved_it_hid_most_of_the_table_before() -> None:
    first, last = seen(view(), lying(0), 0.0), seen(view(), lying(70, 0.05, -0.03), 1.5 * LOST_S)
    corners = first.marker.corners_px
    image, lowest = first.frame.image_bgr.copy(), round(corners[:, 1].max() + 0.3 * np.ptp(corners[:, 1]))
    cloth = cv2.GaussianBlur(np.random.default_rng(8).normal(0, 1, image.shape[:2]), (0, 0), 3)
    sleeve = np.clip(110 + 17 * cloth / cloth.std(), 0, 255).astype(np.uint8)[..., None]
    image[lowest:], image[:, 360:] = sleeve[lowest:], sleeve[:, 360:]
    before, after = followed([replace(first, frame=Frame(image, 0, 0.0)), last])
    assert after is not before
    assert_near(after, lying(70, 0.05, -0.03), 0.5, 1)


def test_a_marker_in_the_hand_is_tilted() -> None:
    tilted = [rigid(cv2.Rodrigues(np.radians([1.5 * k, 0.0, 0]))[0], [0, 0, 0.001 * k]) for k in range(21)]
    places = followed(seen(view(), place, k / FPS) for k, place in enumerate(tilted))
    assert_near(places[-1], tilted[-1], 0.5, 1)


def test_a_sheet_on_the_table_is_not_tilted_by_the_errors_of_its_poses() -> None:
    """The light would lean by them."""
    first, last = seen(view(), lying(0), 0.0), seen(view(), lying(60), 0.5)
    error = rigid(cv2.Rodrigues(np.radians([1.2, -0.8, 0]))[0], [0, 0, 0.002])
    off = replace(last.marker, T_cam_marker=last.marker.T_cam_marker @ error)
    place = followed([first, replace(last, marker=off)])[-1]
    assert np.array_equal(place[2], (0, 0, 1, 0))
    assert_near(place, lying(60), 0.5, 1.5)


def test_a_marker_that_lies_still_again_has_one_place() -> None:
    """So that nothing is computed anew while nothing moves."""
    still = [seen(view(), TURNED[-1], (len(TURNED) + k) / FPS) for k in range(10)]
    assert len({id(place) for place in followed([*turned(), *still])[-6:]}) == 1


def test_what_cannot_be_compared_counts_as_unmoved() -> None:
    first, other = seen(view(), lying(0), 0.0), seen(view(), lying(0), LOST_S + 1.0, grain=0.0)
    back = seen(view(), lying(90), 2 * LOST_S + 2.0)
    before, after, later = followed([first, replace(other, marker=seen(view(30), lying(0), 0.0).marker), back])
    assert before is after is later


@pytest.mark.parametrize("ends", ["rewind", "forget"])
def test_a_cut_begins_anew(ends) -> None:
    marker_place = MarkerPlace()
    last = followed(turned(), marker_place)[-1]
    getattr(marker_place, ends)()
    (next_one,) = followed([seen(view(50), lying(0), 9.0)], marker_place)
    assert np.array_equal(next_one, np.eye(4)) if ends == "rewind" else next_one is last


def test_stepped_back_and_forth_it_lies_where_it_lay_then() -> None:
    frames, marker_place = turned(), MarkerPlace()
    followed(frames, marker_place)
    for frame in reversed(frames[:-1]):
        marker_place.forget()
        place = marker_place.add(frame).T_room_marker
    assert np.array_equal(place, np.eye(4))
    assert_near(followed(frames, marker_place)[-1], TURNED[-1], 0.5, 1)
    marker_place.forget()
    assert np.array_equal(marker_place.add(frames[0]).T_room_marker, np.eye(4))
    marker_place.forget()
    assert_near(np.asarray(marker_place.add(frames[-1]).T_room_marker), TURNED[-1], 0.5, 1)


@pytest.mark.parametrize(("degrees", "mm"), [(0.4, 0.0), (0.0, 1.0), (0.4, 1.0)])
def test_a_marker_that_is_moved_slowly_is_moved(degrees, mm) -> None:
    """Ten times a second by a little, before a camera that stands still."""
    slow = [lying(degrees * k, 0.001 * mm * k) for k in range(61)]
    moved = [seen(view(), place, 3 + k / 10) for k, place in enumerate(slow)]
    places = followed([*resting(), *moved])
    assert_near(places[-1], slow[-1], 4.0, 10)


def test_a_marker_that_is_put_back_lies_where_it_lay() -> None:
    back = [*reversed(TURNED[:10]), *TURNED[:1] * 5]
    places = followed([*turned()[:11], *(seen(view(), place, k / FPS) for k, place in enumerate(back, 11))])
    assert_near(places[10], TURNED[10], 3.5, 2.5)
    assert_near(places[-1], lying(0), 0.01, 0.01)


def test_one_unclear_frame_after_a_long_rest_forgets_no_move() -> None:
    rest = [seen(view(), lying(0), k / FPS) for k in range(0, int(5 * FPS), 3)]
    moved = [seen(view(), lying(70), 6.0 + k / FPS) for k in range(10)]
    blurred = cv2.blur(moved[0].frame.image_bgr, (61, 61))
    unclear = replace(moved[0], frame=replace(moved[0].frame, image_bgr=blurred))
    assert_near(followed([*rest, unclear, *moved[1:]])[-1], lying(70), 0.5, 1.5)


@pytest.mark.parametrize("turn_deg", [30, 60, 100])
def test_points_on_a_line_are_no_ground_to_go_by(monkeypatch, turn_deg) -> None:
    """A ruler on a plain table, while marker and camera move: many homographies explain what it shows."""
    ruler = np.full_like(table(40.0), 130)
    rows = slice(*(round((y_m + TABLE_M / 2) / TABLE_M * CELLS) for y_m in (0.13, 0.16)))
    ruler[rows] = table(40.0)[rows]
    monkeypatch.setattr(sys.modules[__name__], "table", lambda _: ruler)
    place = followed([seen(view(), lying(0), 0.0), seen(view(8), lying(turn_deg), 1.0)])[-1]
    np.testing.assert_array_equal(place, np.eye(4))


def test_light_from_the_room_is_where_it_was() -> None:
    """The convention: what T_room_marker takes from the marker's frame to the room's stays there."""
    true = lying(60, 0.03, 0.01)
    first, last = followed([seen(view(), lying(0), 0.0), seen(view(), true, 0.5)])
    to_light_room = np.array([0.6, 0.0, 0.8])
    now, truth = last[:3, :3].T @ first[:3, :3] @ to_light_room, true[:3, :3].T @ to_light_room
    assert math.degrees(angle_between(now, truth)) < 0.5


def test_another_marker_was_not_moved_where_the_one_before_it_was() -> None:
    """A step back in a clip, to before that was moved, would else turn the other's light."""

    def of_marker(spec: str, seen_at: Sequence[TrackedFrame]) -> MarkerTracker:
        return cast(
            MarkerTracker,
            SimpleNamespace(
                marker=SimpleNamespace(spec=spec),
                preset=None,
                track=lambda frame: seen_at[frame.index],
                jump=lambda: None,
                reset=lambda: None,
            ),
        )

    moved = of_marker("moved", turned())
    still = of_marker("still", [seen(view(), lying(0), k / FPS) for k in range(len(TURNED))])
    scene = SceneTracker(moved, KeyViews())
    frames = [Frame(np.zeros((480, 640, 3), np.uint8), k, k / FPS) for k in range(len(TURNED))]
    assert_near(np.asarray([scene.track(frame) for frame in frames][-1].T_room_marker), TURNED[-1], 0.5, 1)
    scene.rewind()
    assert np.array_equal(scene.track(frames[0]).T_room_marker, np.eye(4))
    assert_near(np.asarray([scene.track(frame) for frame in frames[1:]][-1].T_room_marker), TURNED[-1], 0.5, 1)
    # Seen by another camera the same marker lies where it lay.
    scene.follow(of_marker("moved", turned()))
    assert_near(np.asarray(scene.track(frames[-1]).T_room_marker), TURNED[-1], 0.5, 1)
    scene.jump()
    assert np.array_equal(scene.track(frames[0]).T_room_marker, np.eye(4))
    scene.follow(still)
    here = scene.track(frames[-1])
    scene.jump()
    assert scene.track(frames[2]).T_room_marker is here.T_room_marker
