"""Which frames are kept as views: different sides, sharp, well posed, few and small."""

import dataclasses
import math
from itertools import pairwise

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, frozen_floats
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, inverse_rigid, project, rigid, transform_points, view_direction
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.comparable import lies_as_in
from ashe_live.light.live.key_views import (
    GAIN,
    MOST_BLUR_PX,
    MOST_BYTES,
    MOST_VIEWS,
    OLDEST_S,
    RENEWED_AFTER_S,
    WORKING_WIDTH_PX,
    KeyViews,
    blur_px,
    kept_size,
    scaled,
    span_of,
)
from tests.camera_poses import looking_at

SIZE = (640, 480)
CAMERA = Camera.from_hfov(SIZE, 60)
SIDE_M = 0.08
SQUARE = SIDE_M / 2 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
SURE = np.diag([1e-3] * 6) ** 2


def view(azimuth_deg: float, index: int = 0, time_s: float = 0.0, blur: float = 0.8, camera=CAMERA) -> TrackedFrame:
    """The marker's square on white paper from 45 degrees above and half a metre, blurred by `blur` pixels."""
    azimuth = math.radians(azimuth_deg)
    centre = 0.5 * np.array([math.cos(azimuth), math.sin(azimuth), 1.0]) / math.sqrt(2)
    T_cam_marker = looking_at((0, 0, 0), centre)
    corners = project(camera, T_cam_marker, SQUARE)
    image = np.full((camera.size[1], camera.size[0], 3), 230, np.uint8)
    cv2.fillConvexPoly(image, np.round(corners * 16).astype(int), (20, 20, 20), cv2.LINE_AA, 4)
    if blur:
        image = cv2.GaussianBlur(image, (0, 0), blur)
    pose = MarkerPose(T_cam_marker, corners, SIDE_M, 0.1, 0.5, SURE)
    return TrackedFrame(Frame(image, index, time_s), camera, pose)


def orbit(degrees) -> list[TrackedFrame]:
    return [view(degree, index, index / 30) for index, degree in enumerate(degrees)]


def kept_of(frames) -> KeyViews:
    kept = KeyViews()
    for frame in frames:
        kept.add(frame)
    return kept


def narrowest(views) -> float:
    directions = [view_direction(each.marker.T_cam_marker) for each in views]
    return min(angle_between(a, b) for at, a in enumerate(directions) for b in directions[:at])


def test_a_camera_that_stands_still_leaves_one_view_however_long() -> None:
    trembling = np.random.default_rng(1).normal(0, 0.2, 200)
    kept = kept_of([view(degree, index, index / 30) for index, degree in enumerate(trembling)])
    assert [each.frame.index for each in kept.views] == [0]
    assert span_of(kept.views) == 0


def test_an_orbit_leaves_a_full_set_that_is_spread_over_all_of_it() -> None:
    frames = orbit(np.linspace(0, 60, 240))
    kept = kept_of(frames)
    assert len(kept.views) == MOST_VIEWS
    assert len({each.frame.index for each in kept.views}) == MOST_VIEWS
    # The last frame that is left out lies within GAIN narrowest gaps of a kept one.
    assert span_of(kept.views) > (1 - GAIN / (MOST_VIEWS - 1)) * span_of(frames)
    assert narrowest(kept.views) > 0.5 * span_of(frames) / (MOST_VIEWS - 1)


def test_a_little_motion_gives_several_views() -> None:
    """Three degrees at half a metre are a breath of movement."""
    kept = kept_of(orbit(np.linspace(0, 4.5, 60)))
    assert len(kept.views) >= 3
    assert math.degrees(span_of(kept.views)) > 2


def test_once_full_it_changes_only_for_a_wider_spread() -> None:
    kept = KeyViews()
    gaps = []
    for frame in orbit(np.random.default_rng(2).uniform(0, 50, 300)):
        if kept.add(frame) and len(kept.views) == MOST_VIEWS:
            gaps.append(narrowest(kept.views))
    assert all(later >= 0.999 * earlier for earlier, later in pairwise(gaps))
    assert len(gaps) < 40


@pytest.mark.parametrize(
    "bad",
    [
        lambda good: dataclasses.replace(good, marker=None),
        lambda good: dataclasses.replace(good, marker=dataclasses.replace(good.marker, bridged=True)),
        lambda good: dataclasses.replace(good, marker=dataclasses.replace(good.marker, covariance=1e3 * SURE)),
    ],
    ids=["no marker", "bridged", "badly posed"],
)
def test_what_is_badly_posed_is_not_kept(bad) -> None:
    kept = KeyViews()
    assert not kept.add(bad(view(0)))
    assert kept.add(view(0))


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize(("sigma_deg", "is_kept"), [(0.45, True), (0.55, False)])
def test_a_pose_that_tilts_the_table_by_more_than_half_a_degree_about_either_axis_is_not_kept(
    axis, sigma_deg, is_kept
) -> None:
    covariance = SURE.copy()
    covariance[axis, axis] = math.radians(sigma_deg) ** 2
    seen = view(0)
    tilted = dataclasses.replace(seen, marker=dataclasses.replace(seen.marker, covariance=covariance))
    assert KeyViews().add(tilted) is is_kept


def test_an_uncertain_focal_length_keeps_no_view_out() -> None:
    """It makes all poses uncertain alike."""
    seen = view(0)
    uncertain = dataclasses.replace(seen.marker, covariance=1e3 * SURE, noise_covariance=SURE)
    assert KeyViews().add(dataclasses.replace(seen, marker=uncertain))


def test_a_blurred_frame_is_not_kept() -> None:
    kept = KeyViews()
    assert not kept.add(view(0, blur=2 * MOST_BLUR_PX))
    assert kept.views == ()
    smeared = view(0)
    image = cv2.blur(np.asarray(smeared.frame.image_bgr), (25, 1))
    assert not kept.add(dataclasses.replace(smeared, frame=Frame(image, 0, 0.0)))


@pytest.mark.parametrize(("blur", "is_kept"), [(1.5 * MOST_BLUR_PX, True), (2.5 * MOST_BLUR_PX, False)])
def test_the_blur_of_a_large_picture_counts_as_it_is_in_the_view_that_is_kept(blur, is_kept) -> None:
    """Of half its size."""
    large = Camera.from_hfov((1280, 960), 60)
    assert kept_size(large.size) == SIZE
    assert KeyViews().add(view(0, blur=blur, camera=large)) is is_kept


def test_one_view_is_no_set_of_several() -> None:
    with pytest.raises(ValueError, match="1 views are not several"):
        KeyViews(1)
    two = KeyViews(2)
    assert [two.add(frame) for frame in orbit((0, 10, 40, 35))] == [True, True, True, False]
    assert len(two.views) == 2


def test_a_view_beside_the_one_that_it_replaces_counts_by_its_distance_from_the_others() -> None:
    kept = KeyViews(3)
    assert [kept.add(frame) for frame in orbit((0, 20, 24))] == [True, True, True]
    before = narrowest(kept.views)
    assert kept.add(view(16, 3)), "the narrowest gap, of 20 and 24, is twice as wide then"
    assert [each.frame.index for each in kept.views] == [0, 2, 3]
    assert narrowest(kept.views) > GAIN * before


@pytest.mark.parametrize("blur", [1.5, 2.5, 4.0])
@pytest.mark.parametrize("azimuth_deg", [0, 20, 45])
def test_blur_is_measured_in_pixels(blur, azimuth_deg) -> None:
    assert blur_px(view(azimuth_deg, blur=blur)) == pytest.approx(blur, rel=0.3)


@pytest.mark.parametrize("blur", [1.5, 3.0])
def test_blur_is_measured_at_a_corner_that_is_in_the_picture(blur) -> None:
    """A sharp thing lies at the picture's border where a marker leaves it."""
    whole = view(-90, blur=blur)
    shift = round(whole.marker.corners_px[0, 0]) + 20
    image = np.ascontiguousarray(whole.frame.image_bgr[:, shift:])
    top = round(whole.marker.corners_px[0, 1])
    image[top - 10 : top, :10] = 0
    K = CAMERA.K - np.array([[0, 0, shift], [0, 0, 0], [0, 0, 0]])
    marker = dataclasses.replace(whole.marker, corners_px=whole.marker.corners_px - (shift, 0))
    cut = TrackedFrame(Frame(image, 0, 0.0), Camera(image.shape[1::-1], K, np.zeros(5), "flag"), marker)
    assert (marker.corners_px[0] < 0).any()
    assert blur_px(cut) == pytest.approx(blur, rel=0.3)


@pytest.mark.parametrize("axis", [0, 1], ids=["right", "below"])
def test_blur_is_not_measured_at_a_corner_beyond_the_picture(axis) -> None:
    whole = view(-60, blur=2.0)
    corners = whole.marker.corners_px
    corners = np.roll(corners, -int(corners[:, axis].argmax()), axis=0)  # the first in its order
    end = round(corners[0, axis]) - 12
    image = np.ascontiguousarray(whole.frame.image_bgr[(slice(None), slice(end))[:: -1 if axis else 1]])
    marker = dataclasses.replace(whole.marker, corners_px=corners)
    cut = TrackedFrame(Frame(image, 0, 0.0), Camera(image.shape[1::-1], CAMERA.K, np.zeros(5), "flag"), marker)
    assert (corners[0] >= image.shape[1::-1]).any()
    assert blur_px(cut) == pytest.approx(2.0, rel=0.2)


@pytest.mark.parametrize("blur", [1.5, 3.0])
@pytest.mark.parametrize("turned", range(4))
def test_blur_is_measured_at_a_corner_beside_the_pictures_border(blur, turned) -> None:
    whole = view(45, blur=blur)
    order = np.roll(np.arange(4), turned)
    corners = whole.marker.corners_px[order]
    x, y = np.maximum(np.round(corners.min(axis=0)).astype(int) - 8, 0)
    image = np.ascontiguousarray(whole.frame.image_bgr[y:, x:])
    K = CAMERA.K - np.array([[0, 0, x], [0, 0, y], [0, 0, 0]])
    marker = dataclasses.replace(whole.marker, corners_px=corners - (x, y))
    cut = TrackedFrame(Frame(image, 0, 0.0), Camera(image.shape[1::-1], K, np.zeros(5), "flag"), marker)
    assert blur_px(cut) == pytest.approx(blur, rel=0.3)


@pytest.mark.parametrize("blur", [1.5, 3.0])
def test_of_a_printed_body_the_blur_is_measured_on_its_faces(blur) -> None:
    """Its corners on the plane are hidden, and the ground there is plain."""
    seen = view(0, blur=0.0)
    body = Proxy("box", np.array([[x, y, 0.04, 0.02, 0.04] for x in (-0.02, 0.02) for y in (-0.02, 0.02)]))
    image = np.full_like(seen.frame.image_bgr, 150)
    u, v = np.round(project(CAMERA, seen.marker.T_cam_marker, [(0.0, 0.0, SIDE_M / 2)])[0]).astype(int)
    image[v - 12 : v + 12, u - 12 : u + 12] = 20
    image = cv2.GaussianBlur(image, (0, 0), blur)
    printed = dataclasses.replace(seen.marker, body=body)
    tracked = TrackedFrame(Frame(image, 0, 0.0), CAMERA, printed)
    assert blur_px(tracked) == pytest.approx(blur, rel=0.3)


def test_without_a_marker_or_contrast_nothing_is_sharp() -> None:
    seen = view(0)
    assert blur_px(dataclasses.replace(seen, marker=None)) == math.inf
    flat = np.full_like(seen.frame.image_bgr, 77)
    assert blur_px(dataclasses.replace(seen, frame=Frame(flat, 0, 0.0))) == math.inf
    away = dataclasses.replace(seen.marker, corners_px=seen.marker.corners_px + 5000)
    assert blur_px(dataclasses.replace(seen, marker=away)) == math.inf


@pytest.mark.parametrize(
    "size", [(640, 480), (1280, 720), (1920, 1080), (3840, 2160), (1080, 1920), (2160, 3840), (1601, 907), (320, 240)]
)
def test_views_are_as_large_as_the_estimator_uses_and_all_fit_the_memory(size) -> None:
    width, height = kept_size(size)
    assert MOST_VIEWS * 3 * width * height <= MOST_BYTES
    assert min(size[0], WORKING_WIDTH_PX if size[0] > size[1] else 500) <= width < 2 * WORKING_WIDTH_PX
    assert width / height == pytest.approx(size[0] / size[1], rel=0.01)


def test_a_kept_view_shows_every_point_where_its_camera_projects_it() -> None:
    large = view(10, camera=Camera.from_hfov((1600, 1200), 60))
    large = dataclasses.replace(large, clean_plate_bgr=large.frame.image_bgr)
    small = scaled(large, kept_size(large.frame.size))
    assert small.frame.size == small.camera.size == (800, 600)
    assert small.clean_plate_bgr is None, "it is of the other size"
    # What the pose leaves unexplained is in the pixels of each.
    assert small.marker.reprojection_rms_px == large.marker.reprojection_rms_px / 2
    assert small.marker.other_rms_px == large.marker.other_rms_px / 2
    alone = dataclasses.replace(large, marker=dataclasses.replace(large.marker, other_rms_px=None))
    assert scaled(alone, small.frame.size).marker.other_rms_px is None
    np.testing.assert_allclose(project(small.camera, small.marker.T_cam_marker, SQUARE), small.marker.corners_px)
    grey = cv2.cvtColor(np.asarray(small.frame.image_bgr), cv2.COLOR_BGR2GRAY)
    expected = np.array(small.marker.corners_px[:, None], np.float32)
    seen = cv2.cornerSubPix(grey, expected.copy(), (4, 4), (-1, -1), (3, 30, 0.001))
    # A drawn polygon is half a pixel larger on all sides.
    np.testing.assert_allclose(seen.mean(axis=0)[0], small.marker.corners_px.mean(axis=0), atol=0.1)
    np.testing.assert_allclose(seen[:, 0], small.marker.corners_px, atol=0.6)


def test_memory_is_bounded_and_counted() -> None:
    kept = kept_of(orbit(np.linspace(0, 300, 100)))
    assert kept.nbytes == MOST_VIEWS * 640 * 480 * 3 <= MOST_BYTES


def test_another_focal_length_begins_a_new_set() -> None:
    kept = kept_of(orbit([0, 10, 20]))
    kept.add(view(40, camera=Camera.from_hfov(SIZE, 50)))
    assert len(kept.views) == 1


def test_an_old_view_gives_way_to_a_new_one_from_its_side_and_a_very_old_one_to_any() -> None:
    kept = kept_of([view(0, 0, 0.0), view(10, 1, 1.0)])
    assert not kept.add(view(0, 2, RENEWED_AFTER_S / 2))
    assert kept.add(view(0, 3, RENEWED_AFTER_S + 0.1))
    assert [each.frame.index for each in kept.views] == [1, 3]
    assert kept.add(view(40, 4, OLDEST_S + 2))
    assert [each.frame.index for each in kept.views] == [3, 4]


def test_views_are_dropped_some_or_all() -> None:
    kept = kept_of(orbit([0, 10, 20]))
    first, _, last = kept.views
    kept.drop([first, last])
    assert [each.frame.index for each in kept.views] == [1]
    kept.drop()
    assert kept.views == ()
    assert kept.add(view(0))


def place(T_room_marker) -> Float:
    """Of a marker that lies there for several frames: that it does is known by the array's identity."""
    return frozen_floats(T_room_marker, (4, 4), "T_room_marker")


def turned(degrees: float) -> Float:
    """T_room_marker of a sheet that is turned on its table."""
    return place(rigid(cv2.Rodrigues(np.radians([0.0, 0.0, degrees]))[0], [0.01, 0.0, 0.0]))


def test_views_stay_when_the_marker_is_moved() -> None:
    """By its frame where it lies then; none is added while it moves."""
    lies, kept = place(np.eye(4)), KeyViews()
    for frame in orbit(range(0, 40, 4)):
        kept.add(dataclasses.replace(frame, T_room_marker=lies))
    before = kept.views
    assert before[0].frame.index == 0
    assert len(before) == 10
    assert not kept.add(dataclasses.replace(frame, T_room_marker=lies))
    assert kept.views is before, "whoever looks at them sees that nothing is new"
    for degrees in range(2, 60, 2):
        assert not kept.add(dataclasses.replace(view(80.0, degrees), T_room_marker=turned(degrees)))
    assert kept.views == before
    last = dataclasses.replace(view(80.0, 99), T_room_marker=turned(60))
    kept.add(last)
    assert kept.add(dataclasses.replace(last, frame=Frame(last.frame.image_bgr, 100, 4.0)))
    *moved, new = kept.views
    assert new.frame.index == 100
    assert [each.frame.index for each in moved] == [each.frame.index for each in before]
    point_room = np.array([[0.1, 0.05, 0.03]])
    for one, other in zip(before, moved, strict=True):
        assert all(lies_as_in(each, new) for each in moved)
        was, now = (
            project(CAMERA, each.marker.T_cam_marker, transform_points(inverse_rigid(each.T_room_marker), point_room))
            for each in (one, other)
        )
        assert now == pytest.approx(was)


def test_a_marker_that_is_turned_little_by_little_takes_all_views_along() -> None:
    """Each time by less than counts as elsewhere, but for the views of before the last time."""
    kept = KeyViews()
    for at, degrees in enumerate((0.0, 0.7, 1.4)):
        lies = turned(degrees)
        for index in (2 * at, 2 * at + 1):  # it is at rest in the second
            last = dataclasses.replace(view(10.0 * at, index), T_room_marker=lies)
            kept.add(last)
    assert len(kept.views) == 3
    assert all(lies_as_in(each, last) for each in kept.views)


def test_a_marker_that_is_lifted_from_its_table_shows_another_scene() -> None:
    lies, kept = place(np.eye(4)), KeyViews()
    for frame in orbit(range(0, 40, 4)):
        kept.add(dataclasses.replace(frame, T_room_marker=lies))
    assert len(kept.views) > 2
    lifted = place(rigid(cv2.Rodrigues(np.radians([30.0, 0.0, 0.0]))[0], [0.0, 0.0, 0.1]))
    held = dataclasses.replace(view(0.0, 99), T_room_marker=lifted)
    kept.add(held)
    kept.add(held)
    assert [each.frame.index for each in kept.views] == [99]
