"""A whole page is found where it ends, whatever stands or falls on it, and nothing else is taken for one."""

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import PIL.Image
import pytest

from ashe_live.core.arrays import FRACTION_BITS, Float, fixed_point
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.page import PageAround, page_around
from ashe_live.light.pixels.page_ground import PageGround, ground_around
from ashe_live.light.pixels.page_lines import PageLines
from ashe_live.light.pixels.sheet import ADDED, Sheet
from ashe_live.light.pixels.view import View
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.families.printing import write_marker_sheet
from tests.light.painted_scenes import CYLINDER, SIDE_M, Caster, noise_frames, paint
from tests.light.synthetic_masks import camera_towards

A4 = (0.105, 0.126, 0.105, 0.171)  # right, above, left and below of the marker, as `ashe-live marker` prints it
LETTER = (0.108, 0.1172, 0.108, 0.1622)
FROM_ABOVE = camera_towards((0.0, -0.04), 0.6, 65.0)
ABOVE = camera_towards((0.0, -0.02), 0.62, 55.0)
ON_PAGE, BESIDE_PAGE, BEFORE_PAGE = (0.02, -0.11), (0.15, 0.03), (0.0, -0.19)


def turned(radians: float) -> Float:
    """(4, 4) of the marker's frame about z."""
    T = np.eye(4)
    T[:2, :2] = [[math.cos(radians), -math.sin(radians)], [math.sin(radians), math.cos(radians)]]
    return T


def page_in(tracked: TrackedFrame) -> PageAround | None:
    assert tracked.marker is not None
    picture = View.of(tracked, tracked.camera.size[0])
    return page_around(PageLines.of(picture), picture)


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("at", [ON_PAGE, BESIDE_PAGE, BEFORE_PAGE])
def test_a_page_is_found_whatever_stands_on_it_and_around(ground: str, at: tuple[float, float]) -> None:
    page = page_in(paint(Caster(at=at), ground=ground, azimuth_deg=30, T_cam_marker=ABOVE, page_m=A4).tracked)
    assert page is not None
    assert all(page.is_seen)
    np.testing.assert_allclose(page.ends, np.array(A4) / SIDE_M, atol=0.03)


@pytest.mark.parametrize("height_m", [0.07, 0.12])
def test_an_end_that_something_white_hides_is_that_of_the_opposite_side(height_m: float) -> None:
    camera = camera_towards((0.0, 0.0), 0.6, 50.0) @ turned(math.pi / 2)
    white = Caster(at=(0.14, 0.0), width_m=0.08, height_m=height_m, rgb=(0.7, 0.7, 0.7))
    page = page_in(paint(white, azimuth_deg=100, T_cam_marker=camera, page_m=A4).tracked)
    assert page is not None
    np.testing.assert_allclose((page.ends[0], page.ends[2]), 0.105 / SIDE_M, atol=0.03)


@pytest.mark.parametrize("x", [-0.155, -0.175])
@pytest.mark.parametrize("page_m", [A4, LETTER])
def test_a_page_is_found_where_a_tin_on_its_end_ends_the_paper_sooner(page_m: tuple[float, ...], x: float) -> None:
    """Its foot is nearly straight there: many lines end together, nearer than where any page ends beside the others."""
    tin = Caster("cylinder", at=(x, 0.0), width_m=0.2, height_m=0.04)
    page = page_in(paint(tin, azimuth_deg=30, T_cam_marker=ABOVE, page_m=page_m).tracked)
    assert page is not None
    np.testing.assert_allclose(page.ends, np.array(page_m) / SIDE_M, atol=0.03)


@pytest.mark.parametrize("page_m", [A4, LETTER])
def test_a_few_lines_show_an_end_where_pages_have_it(page_m: tuple[float, ...]) -> None:
    hiding = [Caster(at=(x, 0.031 - page_m[3]), width_m=0.08, height_m=0.05) for x in (-0.055, 0.015)]
    page = page_in(paint(*hiding, azimuth_deg=80, T_cam_marker=FROM_ABOVE, page_m=page_m).tracked)
    assert page is not None
    assert page.is_seen[3]
    assert page.ends[3] == pytest.approx(page_m[3] / SIDE_M, abs=0.05)


def test_printed_pages_are_those_that_are_printed(tmp_path: Path) -> None:
    for paper, page_m in (("a4", A4), ("letter", LETTER)):
        write_marker_sheet(tmp_path / f"{paper}.png", parse_marker("aruco:4x4_50:0"), SIDE_M, paper=paper)
        with PIL.Image.open(tmp_path / f"{paper}.png") as image:
            dark, per_m = np.asarray(image.convert("L")) < 128, image.info["dpi"][0] / 0.0254
        _, _, areas, _ = cv2.connectedComponentsWithStats(dark.astype(np.uint8))
        left, top, width, height = areas[1 + areas[1:, 4].argmax(), :4]
        ends = dark.shape[1] - left - width / 2, top + height / 2, left + width / 2, dark.shape[0] - top - height / 2
        np.testing.assert_allclose(np.array(ends) / per_m, page_m, atol=0.001)


def test_what_stands_at_the_end_of_a_page_keeps_its_colour_on_both_sides() -> None:
    scene = paint(Caster(at=(0.02, 0.10), height_m=0.1), azimuth_deg=280, T_cam_marker=ABOVE, page_m=A4)
    shown = View.of(scene.tracked, 640).with_paper_as_ground().image_bgr.astype(int)
    image = np.asarray(scene.tracked.frame.image_bgr).astype(int)
    inside = cv2.erode(scene.body.astype(np.uint8), np.ones((9, 9))) > 0
    is_lit = inside & (image.max(axis=-1) > 40)
    on_page, beyond = is_lit & scene.sheet, is_lit & ~scene.sheet
    assert min(on_page.sum(), beyond.sum()) > 300
    changed = np.abs(shown - image).max(axis=-1)
    # All but the border, which is painted over.
    assert (changed[on_page] < 12).mean() > 0.7
    assert (changed[beyond] < 12).mean() > 0.7


def test_the_border_of_a_page_is_ground_where_a_shadow_crosses_it() -> None:
    scene = paint(Caster(at=(0.075, 0.05)), azimuth_deg=170, elevation_deg=30, T_cam_marker=ABOVE, page_m=A4)
    view = View.of(scene.tracked, 640).with_paper_as_ground()
    sheet, shadow = scene.sheet.astype(np.uint8), scene.shadow.astype(np.uint8)
    border = (cv2.dilate(sheet, np.ones((5, 5))) > 0) & (cv2.erode(sheet, np.ones((5, 5))) == 0)
    in_shadow, far = cv2.erode(shadow, np.ones((9, 9))) > 0, cv2.dilate(shadow, np.ones((61, 61))) == 0
    far &= cv2.dilate(scene.body.astype(np.uint8), np.ones((61, 61))) == 0
    assert (border & in_shadow).sum() > 30
    assert view.is_ground[border & in_shadow].mean() > 0.9
    assert not view.is_ground[border & far].any()
    dark = np.median(view.image_bgr[in_shadow & scene.beside_sheet], axis=0)
    assert (np.abs(view.image_bgr[border & in_shadow] - dark).max(axis=-1) < 20).mean() > 0.9


def test_noise_shows_no_page() -> None:
    assert [page_in(tracked) for tracked in noise_frames(20)] == [None] * 20


@pytest.mark.parametrize("marker_mm", [60, 100, 150])
def test_the_marker_may_be_small_or_large_on_its_page(marker_mm: float) -> None:
    true = np.array(A4) / (1e-3 * marker_mm)
    page_m = (true * SIDE_M).tolist()
    away = Caster(at=(0.06 + page_m[0], 0.02))
    page = page_in(
        paint(away, azimuth_deg=30, T_cam_marker=camera_towards((0.0, -0.02), 0.75, 55.0), page_m=page_m).tracked
    )
    assert page is not None
    np.testing.assert_allclose(np.array(page.ends)[[0, 1, 2]], true[[0, 1, 2]], atol=0.03)


def test_the_ground_beside_a_page_has_the_colour_that_is_seen_there() -> None:
    page = page_in(paint(CYLINDER, T_cam_marker=ABOVE, page_m=A4).tracked)
    assert page is not None
    (at_marker,) = page.ground.over_paper_at(np.zeros((1, 2)))
    np.testing.assert_allclose(at_marker, np.array([0.42, 0.38, 0.33]) / 0.8, rtol=0.06)


def test_where_no_line_ends_the_ground_is_the_commonest() -> None:
    tracked = paint(CYLINDER, T_cam_marker=ABOVE, page_m=A4).tracked
    lines = PageLines.of(View.of(tracked, 640))
    paper, common = np.array([-0.2, 0.0, 0.0]), np.array([-0.7, 0.3, 0.0])
    for ends in ([None] * 4, [0] * 4):  # beside the square nothing ends
        ground = ground_around(lines, ends, paper, common)
        np.testing.assert_allclose(ground.lit_at(np.array([(0.0, 0.0), (2.0, -1.0)])), 2 * [paper + common], atol=1e-9)


@pytest.mark.parametrize("towards", [(0.16, 0.0), (-0.05, 0.12), (0.0, -0.15)])
def test_a_page_continues_the_ground_where_that_shines_towards_one_side(towards: tuple[float, float]) -> None:
    """Glossy ground mirrors more of the sky there, and paper does not."""
    scene = paint(Caster(at=BESIDE_PAGE), azimuth_deg=30, T_cam_marker=ABOVE, page_m=A4)
    tracked = scene.tracked
    image = np.asarray(tracked.frame.image_bgr)
    rows, columns = np.indices(image.shape[:2])
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    plane = raycast_to_plane(tracked.camera, tracked.pose.T_cam_marker, pixels)[:, :2] / SIDE_M
    by_place = np.exp(np.nan_to_num(plane) @ towards).reshape(image.shape[:2])
    is_ground = ~scene.sheet & ~scene.body
    linear = LINEAR_FROM_SRGB_8BIT[image] * np.where(is_ground, by_place, 1.0)[..., None]
    shining = np.round(255 * srgb_from_linear(np.minimum(linear, 1))).astype(np.uint8)
    view = View.of(replace(tracked, frame=Frame(shining, 0, 0.0)), 640).with_paper_as_ground()
    assert view.page is not None
    shown = log_opponent(np.asarray(view.image_bgr))[..., 0]
    away = cv2.dilate((scene.shadow | scene.body).astype(np.uint8), np.ones((15, 15))) == 0
    on_page = cv2.erode(scene.sheet.astype(np.uint8), np.ones((9, 9))) > 0
    beside = (cv2.dilate(scene.sheet.astype(np.uint8), np.ones((41, 41))) > 0) & (
        cv2.dilate(scene.sheet.astype(np.uint8), np.ones((9, 9))) == 0
    )
    by_right, by_up = (plane[:, axis].reshape(shown.shape) for axis in (0, 1))
    for side in (by_right > 0.9, by_right < -0.9, by_up > 1.1, by_up < -1.6):
        paper, ground = (np.median(shown[side & mask & away & view.is_ground]) for mask in (on_page, beside))
        assert abs(paper - ground) < 0.1


@pytest.mark.parametrize("shift", [(0.045, 0.03), (-0.045, -0.08), (0.02, 0.085)])
def test_a_page_is_found_wherever_on_it_the_marker_is(shift: tuple[float, float]) -> None:
    """Other programs put it into a corner."""
    x, y = shift
    page_m = (0.105 - x, 0.1485 - y, 0.105 + x, 0.1485 + y)
    away = Caster(at=(-0.2 - x, 0.02))
    camera = camera_towards((-x, -y), 0.75, 60.0)
    page = page_in(paint(away, azimuth_deg=30, T_cam_marker=camera, page_m=page_m).tracked)
    assert page is not None
    np.testing.assert_allclose(page.ends, np.array(page_m) / SIDE_M, atol=0.04)


@pytest.mark.parametrize("words_m", [(-0.04, 0.01), (-0.02, 0.04)])
def test_words_below_the_marker_do_not_end_the_page(words_m: tuple[float, float]) -> None:
    page_m = (0.06, 0.12, 0.15, 0.177)
    camera = camera_towards((0.04, -0.02), 0.7, 60.0)
    tracked = paint(Caster(at=(0.14, 0.02)), azimuth_deg=30, T_cam_marker=camera, page_m=page_m).tracked
    (left, right), below = words_m, -0.056
    around = [(left, below), (right, below), (right, below - 0.006), (left, below - 0.006)]
    outline = project(tracked.camera, tracked.pose.T_cam_marker, np.insert(around, 2, 0.0, axis=1))
    image = np.array(tracked.frame.image_bgr)
    grey = (150, 150, 150)  # of letters whose strokes the camera does not resolve
    cv2.fillConvexPoly(image, fixed_point(outline), grey, cv2.LINE_AA, FRACTION_BITS)
    page = page_in(replace(tracked, frame=Frame(image, 0, 0.0)))
    assert page is not None
    np.testing.assert_allclose(page.ends, np.array(page_m) / SIDE_M, atol=0.04)


def test_a_page_reaches_far_from_a_small_marker_in_its_corner() -> None:
    sides = np.array((0.055, 0.065, 0.155, 0.232)) / 0.05
    camera = camera_towards((-0.09, -0.15), 1.0, 62.0)
    page = page_in(
        paint(Caster(at=(0.16, -0.1)), azimuth_deg=340, T_cam_marker=camera, page_m=(sides * SIDE_M).tolist()).tracked
    )
    assert page is not None
    np.testing.assert_allclose(page.ends, sides, atol=0.05)


def test_what_is_longer_than_any_paper_is_no_page() -> None:
    """Something white that adjoins a marker that was cut out."""
    strip_m = [SIDE_M * reach for reach in (0.69, 0.69, 0.69, 2.4)]
    camera = camera_towards((0.0, -0.1), 0.8, 60.0)
    assert page_in(paint(CYLINDER, azimuth_deg=30, T_cam_marker=camera, page_m=strip_m).tracked) is None


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("margin_m", [0.01, 0.02, 0.04])
def test_a_marker_that_is_cut_out_lies_on_no_page(ground: str, margin_m: float) -> None:
    cut = [SIDE_M / 2 + margin_m] * 4
    assert page_in(paint(CYLINDER, ground=ground, T_cam_marker=ABOVE, page_m=cut).tracked) is None


def test_lit_and_in_shadow_a_page_looks_like_the_ground_around_it() -> None:
    scene = paint(Caster(at=(0.075, 0.05)), azimuth_deg=170, elevation_deg=30, T_cam_marker=ABOVE, page_m=A4)
    view = View.of(scene.tracked, 640).with_paper_as_ground()
    inside = cv2.erode(scene.shadow.astype(np.uint8), np.ones((5, 5))) > 0
    for these in (inside, ~scene.shadow & ~scene.body):
        on_page, beside = these & view.is_ground & scene.sheet, these & view.is_ground & ~scene.sheet
        assert min(on_page.sum(), beside.sum()) > 100
        paper, ground = (np.median(view.image_bgr[mask], axis=0) for mask in (on_page, beside))
        np.testing.assert_allclose(paper, ground, atol=8)


def test_what_may_be_paper_or_ground_is_not_used() -> None:
    ground = PageGround((-0.2, 0.0, 0.0), ((-0.7, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    page = PageAround((1.3, 1.6, 1.3, 2.1), (True, True, True, False), ground)
    right, above, left, below = (corners[:, :2] / SIDE_M for corners in page.between(SIDE_M))
    np.testing.assert_allclose((right[:, 0].min(), right[:, 0].max()), (1.3 - ADDED, 1.3 + ADDED))
    np.testing.assert_allclose((above[:, 1].min(), above[:, 1].max()), (1.6 - ADDED, 1.6 + ADDED))
    np.testing.assert_allclose((left[:, 0].min(), left[:, 0].max()), (-1.3 - ADDED, -1.3 + ADDED))
    np.testing.assert_allclose((below[:, 1].min(), below[:, 1].max()), (-2.1 - ADDED, -1.1 + ADDED))
    assert Sheet(*page.ends).corners(SIDE_M)[:, 1].min() == pytest.approx(-2.1 * SIDE_M)


def test_a_narrow_margin_is_compared_with_the_ground_beside_it_and_not_with_what_lies_far_out() -> None:
    narrow = (0.6 * SIDE_M, 0.6 * SIDE_M, 0.6 * SIDE_M, 2.0 * SIDE_M)
    tracked = paint(Caster(at=(0.02, -0.09)), T_cam_marker=FROM_ABOVE, page_m=narrow).tracked
    assert tracked.marker is not None
    lines = PageLines.of(View.of(tracked, tracked.camera.size[0]))
    end = int(np.abs(lines.outwards - 0.6).argmin())
    for side in (0, 1, 2):
        ((paper, ground),) = lines.colours_beside([end if each == side else None for each in range(4)])
        assert np.median(paper[:, 0]) > np.median(ground[:, 0]) + 0.3
        assert lines.ends_in(side, end, np.median(ground - paper, axis=0).astype(np.float64))
        np.testing.assert_allclose(np.median(paper, axis=0), np.median(lines.before[side, :, 0], axis=0), atol=0.05)


@pytest.mark.parametrize(("distance_m", "pitch_deg"), [(0.18, 20.0), (0.18, 25.0), (0.16, 30.0)])
def test_a_page_that_may_reach_behind_the_camera_is_shown_as_ground_before_it(
    distance_m: float, pitch_deg: float
) -> None:
    camera = camera_towards((0.0, 0.0), distance_m, pitch_deg)
    scene = paint(T_cam_marker=camera, page_m=A4, focal_px=400.0)
    page, view = page_in(scene.tracked), View.of(scene.tracked, 640)
    assert page is not None
    lowest = camera @ (0.0, -page.ends[3] * SIDE_M, 0.0, 1.0)
    assert lowest[2] < 0  # its end is out of the picture, and looked for no farther than so
    shown = view.with_paper_as_ground()
    on_page, beside = shown.is_ground & scene.sheet, shown.is_ground & ~scene.sheet
    assert min(on_page.sum(), beside.sum()) > 5000
    before, after = (
        np.abs(np.median(each.image_bgr[on_page], axis=0) - np.median(each.image_bgr[beside], axis=0)).max()
        for each in (view, shown)
    )
    assert before > 40
    assert after < 8
