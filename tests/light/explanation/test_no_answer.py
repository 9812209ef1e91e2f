"""Why there is no answer: what is said must be what is wrong."""

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import camera_centre, project
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.no_answer import (
    BLACK_GROUND,
    CUT_OFF,
    DARK,
    DOES_NOT_FIT,
    HARDLY_A_SHADOW,
    NOTHING_THERE,
    PAGE_TOO_BRIGHT,
    TOO_BRIGHT,
    TOO_DARK,
    fault_of_exposure,
    fault_of_scene,
)
from ashe_live.light.pixels.view import View
from tests.light.painted_bodies import alignment_of, explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, HFOV_DEG, VIEW, Caster, Painted, paint, tracked_frame
from tests.light.synthetic_masks import camera_towards

SMALL = (320, 240)


def reason(scene: Painted) -> str | None:
    return ProxyEstimator().estimate(scene.tracked).reason


def fault(image_bgr: Image) -> str | None:
    camera = Camera.from_hfov(SMALL, HFOV_DEG)
    return fault_of_exposure(View.of(tracked_frame(image_bgr, camera), SMALL[0]))


@pytest.mark.parametrize(("exposure", "expected"), [(0.002, TOO_DARK), (30.0, TOO_BRIGHT)])
@pytest.mark.parametrize("ground", ["plain", "checkered"])
def test_a_picture_that_shows_nothing_for_its_exposure_says_so(ground: str, exposure: float, expected: str) -> None:
    assert reason(paint(BOX, ground=ground, size=SMALL, exposure=exposure)) == expected


@pytest.mark.parametrize("exposure", [0.25, 1.0])
def test_exposure_is_not_blamed_for_an_empty_table(exposure: float) -> None:
    assert reason(paint(size=SMALL, exposure=exposure)) == NOTHING_THERE


def test_only_the_ground_and_its_brightest_channel_determine_the_exposure() -> None:
    blue = np.zeros((SMALL[1], SMALL[0], 3), np.uint8)
    blue[..., 0] = 200
    assert fault(blue) is None
    assert fault(np.full_like(blue, DARK - 1)) == TOO_DARK
    assert fault(np.full_like(blue, 255)) == TOO_BRIGHT
    blue[: SMALL[1] // 4] = 255  # a bright window is not the table
    assert fault(blue) is None


def test_an_overexposed_page_is_blamed_only_where_it_stands_out() -> None:
    page_m = (0.105, 0.126, 0.105, 0.171)
    above = camera_towards((0.0, -0.02), 0.62, 55.0)
    for exposure, is_blamed in ((0.9, False), (1.6, True)):
        scene = paint(BOX, T_cam_marker=above, page_m=page_m, exposure=exposure)
        view = View.of(scene.tracked, 640).with_paper_as_ground()
        assert view.page is not None
        fault = fault_of_exposure(view, scene.sheet)
        assert (fault == PAGE_TOO_BRIGHT) == is_blamed
        assert fault_of_exposure(view, scene.body | scene.shadow) is None
        assert fault_of_exposure(view) is None
    on_page = paint(Caster(at=(0.02, -0.1)), T_cam_marker=above, page_m=page_m, exposure=1.6)
    view = View.of(on_page.tracked, 640).with_paper_as_ground()
    assert view.page is not None
    assert fault_of_exposure(view, on_page.body | on_page.shadow) is None


def test_a_picture_without_ground_is_not_blamed_for_its_exposure() -> None:
    scene = paint(BOX, size=SMALL)
    view = View.of(scene.tracked, SMALL[0])
    empty = View(view.image_bgr, view.camera, view.T_cam_marker, view.side_m, np.zeros_like(view.is_ground))
    assert fault_of_exposure(empty) is None


@pytest.mark.parametrize(
    ("elevation_deg", "in_view", "expected"),
    [
        (8.0, 0.0, CUT_OFF),
        (8.0, 0.9, DOES_NOT_FIT),  # most of its end is in the picture
        (50.0, 0.0, DOES_NOT_FIT),  # hidden, not cut off: none of it lies at the picture's edge
    ],
)
def test_a_shadow_is_said_to_leave_the_picture_where_it_does(
    elevation_deg: float, in_view: float, expected: str
) -> None:
    here = painted_region(BOX, elevation_deg=elevation_deg)
    told = explanation_of(here, alignment=alignment_of(here, ends_in_view=(in_view,)))
    assert fault_of_scene(told, 0.3) == expected


def test_what_is_hardly_taken_for_a_shadow_is_not_said_to_leave_the_picture() -> None:
    here = painted_region(BOX, elevation_deg=8.0)
    told = explanation_of(here, alignment=alignment_of(here, ends_in_view=(0.0,)))
    assert fault_of_scene(told, 0.02) == DOES_NOT_FIT


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("aside_deg", [0.0, 4.0])
def test_a_shadow_that_the_object_hides_is_said_to_be_hidden(caster: Caster, aside_deg: float) -> None:
    x, y, z = camera_centre(VIEW) - (*caster.at, 0)
    azimuth_deg, elevation_deg = np.degrees([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))])
    assert reason(paint(caster, azimuth_deg=azimuth_deg + aside_deg, elevation_deg=elevation_deg)) == HARDLY_A_SHADOW


def test_black_ground_around_white_paper_is_not_blamed_on_the_exposure() -> None:
    image = np.full((SMALL[1], SMALL[0], 3), 10, np.uint8)
    camera = Camera.from_hfov(SMALL, HFOV_DEG)
    tracked = tracked_frame(image, camera)
    assert fault_of_exposure(View.of(tracked, SMALL[0])) == TOO_DARK
    assert tracked.marker is not None
    half = 0.6 * tracked.marker.side_m
    margin = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)])
    outline = np.round(project(camera, tracked.marker.T_cam_marker, margin)).astype(np.int32)
    cv2.polylines(image, [outline], isClosed=True, color=(200, 200, 200), thickness=5)
    assert fault(image) == BLACK_GROUND
