"""A whole page is found where it ends, whatever stands or falls on it, and nothing else is taken for one."""

import cv2
import numpy as np
import pytest

from ashe_live.core.types import TrackedFrame
from ashe_live.light.pixels.page import Page, page_around
from ashe_live.light.pixels.sheet import ADDED, Sheet
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import CYLINDER, SIDE_M, Caster, paint
from tests.light.synthetic_masks import camera_towards

A4 = (0.105, 0.126, 0.105, 0.171)  # right, above, left and below of the marker, as `ashe-live marker` prints it
ABOVE = camera_towards((0.0, -0.02), 0.62, 55.0)
ON_PAGE, BESIDE_PAGE, BEFORE_PAGE = (0.02, -0.11), (0.15, 0.03), (0.0, -0.19)


def page_in(tracked: TrackedFrame) -> Page | None:
    assert tracked.marker is not None
    image = np.asarray(tracked.frame.image_bgr)
    return page_around(image, tracked.camera, tracked.marker.T_cam_marker, SIDE_M)


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("at", [ON_PAGE, BESIDE_PAGE, BEFORE_PAGE])
def test_a_page_is_found_whatever_stands_on_it_and_around(ground: str, at: tuple[float, float]) -> None:
    page = page_in(paint(Caster(at=at), ground=ground, azimuth_deg=30, T_cam_marker=ABOVE, page_m=A4).tracked)
    assert page is not None
    ends, seen, true = np.array(page.ends), np.array(page.is_seen), np.array(A4) / SIDE_M
    assert seen.sum() >= 3
    np.testing.assert_allclose(ends[seen], true[seen], atol=0.03)
    assert (ends[~seen] < true[~seen] + 0.1).all()


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
    np.testing.assert_allclose(page.ground_over_paper, np.array([0.42, 0.38, 0.33]) / 0.8, rtol=0.06)


@pytest.mark.parametrize("ground", ["plain", "checkered", "striped", "bricks"])
@pytest.mark.parametrize("margin_m", [0.01, 0.02, 0.04])
def test_a_marker_that_is_cut_out_lies_on_no_page(ground: str, margin_m: float) -> None:
    cut = [SIDE_M / 2 + margin_m] * 4
    assert page_in(paint(CYLINDER, ground=ground, T_cam_marker=ABOVE, page_m=cut).tracked) is None


def test_lit_and_in_shadow_a_page_looks_like_the_ground_around_it() -> None:
    scene = paint(Caster(at=(0.075, 0.05)), azimuth_deg=170, elevation_deg=30, T_cam_marker=ABOVE, page_m=A4)
    view = View.of(scene.tracked, 640).with_page_as_ground()
    inside = cv2.erode(scene.shadow.astype(np.uint8), np.ones((5, 5))) > 0
    for these in (inside, ~scene.shadow & ~scene.body):
        on_page, beside = these & view.is_ground & scene.sheet, these & view.is_ground & ~scene.sheet
        assert min(on_page.sum(), beside.sum()) > 100
        paper, ground = (np.median(view.image_bgr[mask], axis=0) for mask in (on_page, beside))
        np.testing.assert_allclose(paper, ground, atol=8)


def test_what_may_be_paper_or_ground_is_not_used() -> None:
    page = Page((1.3, 1.6, 1.3, 2.1), (True, True, True, False), (0.5, 0.5, 0.5))
    right, above, left, below = (corners[:, :2] / SIDE_M for corners in page.between(SIDE_M))
    np.testing.assert_allclose((right[:, 0].min(), right[:, 0].max()), (1.3 - ADDED, 1.3 + ADDED))
    np.testing.assert_allclose((above[:, 1].min(), above[:, 1].max()), (1.6 - ADDED, 1.6 + ADDED))
    np.testing.assert_allclose((left[:, 0].min(), left[:, 0].max()), (-1.3 - ADDED, -1.3 + ADDED))
    np.testing.assert_allclose((below[:, 1].min(), below[:, 1].max()), (-2.1 - ADDED, -1.1 + ADDED))
    assert Sheet(*page.ends).corners(SIDE_M)[:, 1].min() == pytest.approx(-2.1 * SIDE_M)
