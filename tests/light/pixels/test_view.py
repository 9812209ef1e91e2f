"""The frame at a working size: points stay where projection puts them, and ground is where rays meet the plane."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import inverse_rigid, project
from ashe_live.light.pixels.view import FARTHEST, View
from tests.light.painted_scenes import BOX, SIDE_M, VIEW, overlap, paint, tracked_frame
from tests.light.synthetic_masks import IMPOSSIBLE_POSES, camera_towards

POINTS = np.array([(0.0, 0.0, 0.0), (0.1, 0.05, 0.0), (-0.08, 0.1, 0.03), (0.12, 0.0, 0.08)])


def view_of(T_cam_marker: Float, size: tuple[int, int] = (80, 60), hfov_deg: float = 55.0) -> View:
    camera = Camera.from_hfov(size, hfov_deg)
    return View.of(tracked_frame(np.zeros((*size[::-1], 3), np.uint8), camera, T_cam_marker), size[0])


@pytest.mark.parametrize("width_px", [640, 320, 213, 64])
def test_a_scaled_view_shows_points_where_the_frame_does(width_px: int) -> None:
    tracked = paint(BOX).tracked
    view = View.of(tracked, width_px)
    assert view.size == (width_px, round(width_px * 0.75))
    assert view.image_bgr.shape[:2] == view.is_ground.shape == view.size[::-1]
    whole = project(tracked.camera, VIEW, POINTS)
    # Pixel centres are at whole numbers: their corners scale.
    expected = (whole + 0.5) * np.divide(view.size, tracked.camera.size) - 0.5
    np.testing.assert_allclose(project(view.camera, view.T_cam_marker, POINTS), expected, atol=1e-6)


def test_no_view_is_larger_than_its_frame() -> None:
    tracked = paint(BOX, size=(320, 240)).tracked
    view = View.of(tracked, 5000)
    assert view.size == (320, 240)
    np.testing.assert_array_equal(view.image_bgr, tracked.frame.image_bgr)
    assert view.scaled(5000) is view


def test_a_cut_view_is_the_same_picture_seen_through_a_window() -> None:
    view = View.of(paint(BOX).tracked, 320)
    window = np.s_[40:200, 90:300]
    cut = view.cut(window)
    assert cut.size == (210, 160)
    np.testing.assert_array_equal(cut.image_bgr, view.image_bgr[window])
    np.testing.assert_array_equal(cut.is_ground, view.is_ground[window])
    whole = project(view.camera, view.T_cam_marker, POINTS)
    np.testing.assert_allclose(project(cut.camera, cut.T_cam_marker, POINTS), whole - (90, 40), atol=1e-9)


def test_a_cut_view_knows_how_well_its_focal_length_is_known() -> None:
    tracked = paint(BOX).tracked
    camera = Camera.from_focal(tracked.camera.size, float(tracked.camera.K[0, 0]), "estimated", 12.0)
    view = View.of(tracked_frame(np.asarray(tracked.frame.image_bgr), camera), 320)
    assert view.cut(np.s_[40:200, 90:300]).camera.focal_sigma_px == view.camera.focal_sigma_px == 6.0


def test_a_lens_is_straightened() -> None:
    how = {"ground": "checkered", "noise_levels": 0.0, "focal_px": 620.0}
    wide, straight = paint(BOX, size=(960, 720), **how), paint(BOX, **how)
    dist = np.array([-0.3, 0, 0, 0, 0])
    camera = Camera((640, 480), straight.tracked.camera.K, dist, "file")
    pixels = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), axis=2).reshape(-1, 1, 2)
    sources = cv2.undistortPoints(pixels, camera.K, dist, P=wide.tracked.camera.K).reshape(480, 640, 2)
    bent = cv2.remap(np.asarray(wide.tracked.frame.image_bgr), sources.astype(np.float32), None, cv2.INTER_LINEAR)
    view = View.of(tracked_frame(np.asarray(bent, np.uint8), camera), 640)
    assert not view.camera.is_distorted
    true = np.asarray(straight.tracked.frame.image_bgr, np.float64)
    inner = np.s_[30:-30, 30:-30]
    off, bent_off = (np.abs(picture - true)[inner].mean() for picture in (view.image_bgr, bent))
    assert off < 0.2 * bent_off


@pytest.mark.parametrize("k1", [0.03, 0.2, -0.2])
def test_what_the_lens_does_not_show_is_no_ground(k1: float) -> None:
    straight = paint(BOX).tracked
    width, height = straight.camera.size
    camera = Camera(straight.camera.size, straight.camera.K, np.array([k1, 0, 0, 0, 0]), "file")
    bright = np.full((height, width, 3), 150, np.uint8)
    view = View.of(tracked_frame(bright, camera), width)
    # Where the ray of each pixel meets the picture as it was taken.
    rays = np.stack([*np.meshgrid(np.arange(width), np.arange(height)), np.ones((height, width))], axis=-1)
    rays = rays.reshape(-1, 3) @ np.linalg.inv(camera.K).T
    x, y = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), camera.K, camera.dist)[0].reshape(height, width, 2).T
    inside, beside = (((x >= by) & (x <= width - 1 - by) & (y >= by) & (y <= height - 1 - by)).T for by in (0.1, -0.1))
    pinhole = View.of(tracked_frame(bright, camera.without_distortion()), width)
    assert not (view.is_ground & ~beside).any()
    np.testing.assert_array_equal(view.is_ground[inside], pinhole.is_ground[inside])
    # Nor at a smaller scale, where a blank pixel darkens its neighbours.
    smaller = view.scaled(200)
    assert (smaller.image_bgr[smaller.is_ground] >= 149).all()
    assert (smaller.is_ground == pinhole.scaled(200).is_ground).mean() > 0.8


@pytest.mark.parametrize("k1", [0.0, 0.05])
def test_black_bars_are_no_ground(k1: float) -> None:
    """Of any width, at any of the four sides, nearly black as a codec leaves them, also seen through a lens."""
    straight = paint(BOX).tracked
    width, height = straight.camera.size
    camera = Camera(straight.camera.size, straight.camera.K, np.array([k1, 0, 0, 0, 0]), "file")
    bright = np.full((height, width, 3), 150, np.uint8)
    bright[100:140, 200:260] = 0  # what is black within the picture is part of it
    barred = np.random.default_rng(1).integers(0, 12, bright.shape, np.uint8)
    within = np.s_[31 : height - 60, 8 : width - 1]
    barred[within] = bright[within]
    whole, view = (View.of(tracked_frame(picture, camera), width) for picture in (bright, barred))
    dark = view.is_ground & (view.image_bgr.max(axis=-1) < 75)
    dark[90:150, 190:270] = False
    assert not dark.any()
    inner = np.s_[45 : height - 75, 25 : width - 20]
    np.testing.assert_array_equal(view.is_ground[inner], whole.is_ground[inner])
    assert view.is_ground.sum() > 0.8 * whole.is_ground[within].sum()


def test_a_picture_that_is_all_black_has_no_bars() -> None:
    straight = paint(BOX).tracked
    pictures = (np.full_like(np.asarray(straight.frame.image_bgr), value) for value in (0, 150))
    black, grey = (View.of(tracked_frame(picture, straight.camera), 320) for picture in pictures)
    np.testing.assert_array_equal(black.is_ground, grey.is_ground)


def ground_by_rays(view: View) -> Mask:
    """Ray by ray, with the eye and the rays in the marker frame; the sheet not left out."""
    T_marker_cam = inverse_rigid(view.T_cam_marker)
    width, height = view.size
    u, v = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(view.camera.K).T
    climb = rays @ T_marker_cam[2, :3]
    eye = T_marker_cam[:3, 3]
    depth = np.where(climb * -np.sign(eye[2]) > 1e-9, -eye[2] / np.where(climb == 0, 1, climb), np.inf)
    return np.asarray(depth < FARTHEST * np.linalg.norm(eye))


@pytest.mark.parametrize("pitch_deg", [0.5, 5.0, 15.0, 45.0, 90.0])
def test_ground_is_where_rays_meet_the_plane_beside_the_sheet(pitch_deg: float) -> None:
    view = view_of(camera_towards((0.3, 0.1), 0.7, pitch_deg))
    half = 0.5 * 1.7 * SIDE_M
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    around = np.zeros(view.is_ground.shape, np.uint8)
    hull = np.clip(project(view.camera, view.T_cam_marker, square), -1e4, 1e4)
    cv2.fillConvexPoly(around, np.round(hull).astype(np.int32), 1)
    beside = around == 0
    np.testing.assert_array_equal(view.is_ground[beside], ground_by_rays(view)[beside])


@pytest.mark.parametrize("width_px", [640, 320, 100])
def test_no_pixel_of_the_sheet_is_ground_and_little_else_is_left_out(width_px: int) -> None:
    scene = paint(BOX)
    view = View.of(scene.tracked, width_px)
    sheet = cv2.resize(scene.sheet.astype(np.float32), view.size, interpolation=cv2.INTER_AREA) > 0
    assert not (view.is_ground & sheet).any()
    assert overlap(~view.is_ground, sheet) > 0.7


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (40, 30)])
@pytest.mark.parametrize("T_cam_marker", IMPOSSIBLE_POSES.values(), ids=IMPOSSIBLE_POSES)
def test_any_pose_and_size_has_a_ground_or_none(T_cam_marker: Float, size: tuple[int, int]) -> None:
    view = view_of(T_cam_marker, size, hfov_deg=30.0)
    assert view.is_ground.shape == size[::-1]
    assert view.scaled(1).size[0] == 1


def test_seen_from_afar_the_sky_is_no_ground() -> None:
    view = view_of(camera_towards((0.0, 0.0), 0.5, 0.0))
    assert not view.is_ground[: view.size[1] // 2].any()


@pytest.mark.parametrize("page_m", [None, (0.1, 0.15, 0.1, 0.15)])
def test_by_a_clean_plate_all_that_lies_on_the_plane_is_ground(page_m) -> None:
    scene, empty = paint(BOX, ground="bricks", page_m=page_m), paint(ground="bricks", page_m=page_m)
    plate = empty.tracked.frame.image_bgr
    taken = View.of(scene.tracked, 320).with_paper_as_ground()
    plain = View.of(replace(scene.tracked, clean_plate_bgr=plate), 320).with_paper_as_ground()
    assert not taken.is_ground.all()
    assert plain.is_ground.all()
    # What lamps and mirror images are found by is the picture as it was taken, at each scale.
    for view, expected in ((plain, taken), (plain.scaled(160), taken.scaled(160))):
        assert view.taken is not None
        assert view.size == view.taken.size
        np.testing.assert_array_equal(view.taken.image_bgr, expected.image_bgr)
        np.testing.assert_array_equal(view.taken.is_ground, expected.is_ground)


def test_a_clean_plate_is_straightened_with_its_picture() -> None:
    camera = replace(Camera.from_hfov((320, 240), 60.0), dist=np.array([-0.3, 0.1, 0.0, 0.0, 0.0]))
    image = np.random.default_rng(0).integers(40, 200, (240, 320, 3), np.uint8)
    tracked = replace(tracked_frame(image, camera), clean_plate_bgr=image)
    shown = View.of(tracked, 320).with_paper_as_ground()
    assert len(np.unique(shown.image_bgr[shown.is_ground], axis=0)) == 1  # nothing has changed


def test_a_clean_plate_of_another_size_is_none() -> None:
    tracked = paint(BOX).tracked
    with pytest.raises(ValueError, match="clean plate"):
        replace(tracked, clean_plate_bgr=np.zeros((10, 10, 3), np.uint8))
