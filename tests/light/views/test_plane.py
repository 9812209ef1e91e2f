"""What several views tell about the plane: by geometry, on painted pictures of known scenes."""

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.light.pixels.log_colour import log_opponent
from ashe_live.light.pixels.view import View, plane_homography
from ashe_live.light.views.plane import log_likelihood_ratio, on_plane, where_in
from tests.light.painted_scenes import BOX, Caster, Painted, paint
from tests.light.painted_views import painted_from
from tests.light.synthetic_masks import camera_towards

WIDTH = 320


def on_bricks(heading_deg: float, *casters: Caster, **how: Any) -> Painted:
    return painted_from(heading_deg, *casters, **{"ground": "bricks", "size": (640, 480), **how})


def ratio_of(first: TrackedFrame, *others: TrackedFrame) -> np.ndarray:
    reference = View.of(first, WIDTH)
    colours = log_opponent(reference.image_bgr)
    views = [View.of(other, WIDTH) for other in others]
    seen = [on_plane(reference, colours, view, log_opponent(view.image_bgr)) for view in views]
    return log_likelihood_ratio([one for one in seen if one is not None], reference.is_ground.shape)


def small(mask: np.ndarray, margin_px: int = 2) -> np.ndarray:
    """(h, w) at the views' size, without the outline."""
    size = WIDTH, mask.shape[0] * WIDTH // mask.shape[1]
    shrunk = cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_AREA)
    return cv2.erode(shrunk, np.ones((2 * margin_px + 1,) * 2, np.uint8)) > 0


def test_the_homography_takes_points_of_the_plane_where_the_other_camera_sees_them() -> None:
    one, other = (View.of(on_bricks(heading).tracked, WIDTH) for heading in (80, 110))
    points = np.array([(0.1, 0.05, 0), (-0.08, 0.02, 0), (0.2, -0.1, 0)])
    pixels = np.column_stack([project(one.camera, one.T_cam_marker, points), np.ones(3)])
    taken = pixels @ plane_homography(one, other).T
    np.testing.assert_allclose(
        taken[:, :2] / taken[:, 2:], project(other.camera, other.T_cam_marker, points), atol=1e-9
    )


def test_what_another_camera_has_behind_it_is_in_no_mask_of_its_picture() -> None:
    above = View.of(paint(T_cam_marker=camera_towards((0.0, 0.0), 1.0, 75.0)).tracked, WIDTH)
    low = View.of(paint(T_cam_marker=camera_towards((0.0, 0.0), 0.12, 8.0)).tracked, WIDTH)
    found = where_in(np.ones_like(low.is_ground), low, above)
    rows, columns = np.nonzero(np.ones_like(above.is_ground))
    points = raycast_to_plane(above.camera, above.T_cam_marker, np.column_stack([columns, rows]))
    seen = project(low.camera, low.T_cam_marker, points).reshape(*above.is_ground.shape, 2)
    width, height = low.size
    inside = (seen > -0.5).all(axis=2) & (seen[..., 0] < width - 0.5) & (seen[..., 1] < height - 0.5)
    assert np.isnan(seen).any()
    assert np.mean(found != inside) < 0.01


@pytest.mark.parametrize("ground", ["plain", "bricks"])
def test_a_shadow_stays_on_the_plane_and_a_box_does_not(ground: str) -> None:
    first = on_bricks(90, BOX, ground=ground)
    ratio = ratio_of(first.tracked, *(on_bricks(heading, BOX, ground=ground).tracked for heading in (75, 105)))
    shadow, body = small(first.shadow), small(first.body, 1)
    # A plain face agrees with itself where it overlaps itself, which tells nothing: what is left decides.
    assert ratio[shadow].mean() > 0
    assert np.mean(ratio[shadow] < -1) < 0.1  # where the box hides it in another view
    assert ratio[body].mean() < -0.3
    assert np.mean(ratio[body] < -1) > 0.25


@pytest.mark.parametrize(("heading_deg", "border"), [(105, np.s_[100:170, :4]), (75, np.s_[100:170, -4:])])
def test_plain_ground_is_no_evidence_at_the_border_of_the_picture_either(heading_deg: float, border) -> None:
    """There, too, it looks the same wherever it is: what the other border of the picture shows is no neighbour."""
    first, other = (on_bricks(heading, ground="plain") for heading in (90, heading_deg))
    ratio = np.abs(ratio_of(first.tracked, other.tracked))
    assert ratio[border].mean() < 2 * ratio[100:170, 180:260].mean() < 0.2


def test_a_flat_dark_thing_is_no_object() -> None:
    sticker = Caster(width_m=0.06, height_m=1e-4, rgb=(0.03, 0.03, 0.03))
    first = on_bricks(90, sticker)
    ratio = ratio_of(first.tracked, *(on_bricks(heading, sticker).tracked for heading in (75, 105)))
    assert np.mean(ratio[small(first.body)] < -1) < 0.02


def test_another_exposure_and_white_balance_change_nothing_on_the_plane() -> None:
    first, other = on_bricks(90, BOX), on_bricks(105, BOX, exposure=0.7)
    tinted = (other.tracked.frame.image_bgr * np.array([0.95, 1.0, 0.92])).astype(np.uint8)
    frame = TrackedFrame(Frame(tinted, 1, 0.0), other.tracked.camera, other.tracked.marker)
    ratio = ratio_of(first.tracked, frame)
    ground = small(~first.body & ~first.sheet, 4) & ~small(first.shadow, 0)
    assert np.mean(ratio[ground] < -1) < 0.1
    assert ratio[ground].mean() > 0 > ratio[small(first.body, 1)].mean()


def test_views_from_one_place_are_no_evidence() -> None:
    first, again = on_bricks(90, BOX), on_bricks(90, BOX, seed=1)
    np.testing.assert_array_equal(ratio_of(first.tracked, again.tracked), 0)


def test_views_of_different_grounds_are_no_evidence() -> None:
    away = paint(size=(320, 240), T_cam_marker=camera_towards((5.0, 0.0), 0.5, 60.0))
    here, there = (View.of(painted.tracked, WIDTH) for painted in (on_bricks(90, BOX), away))
    assert on_plane(here, log_opponent(here.image_bgr), there, log_opponent(there.image_bgr)) is None


def test_a_strip_that_is_narrower_than_the_reduced_picture_resolves_is_no_evidence() -> None:
    here, there = (View.of(on_bricks(heading).tracked, 160) for heading in (90, 95))
    strip = np.zeros_like(here.is_ground)
    strip[29:32] = here.is_ground[29:32]
    here = replace(here, is_ground=strip)
    assert on_plane(here, log_opponent(here.image_bgr), there, log_opponent(there.image_bgr)) is None
