"""The lit ground under a lamp is even once its light's fall is taken out of it; a sun's needs it on gloss alone."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT, srgb_from_linear
from ashe_live.core.transforms import angle_between, camera_centre, image_from_plane
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.ground.gloss import Gloss, mirrored
from ashe_live.light.ground.lit_ground import LitGround, fit_lit_ground
from ashe_live.light.lamps.kinds import AUTO, SUN
from ashe_live.light.lamps.lit_by_lamp import lit_ground_beside, lit_ground_of
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import Caster, paint
from tests.light.synthetic_masks import camera_towards

OVERHEAD, BESIDE = np.array([0.0, 0.0, 0.2]), np.array([0.3, -0.2, 0.25])
FAR_AWAY = Caster("box", (5.0, 5.0), height_m=0.01)  # out of the picture


def grounds(lamp_m: Float | None, kind: str = AUTO) -> tuple[View, LitGround, LitGround]:
    view = View.of(paint(FAR_AWAY, lamp_m=lamp_m).tracked, BALANCED.coarse_width_px)
    by_quadratic = fit_lit_ground(view.image_bgr, view.is_ground, BALANCED.ground)
    found = lit_ground_of(view, BALANCED.ground, kind)
    assert by_quadratic is not None
    assert found is not None
    return view, by_quadratic, found


def unevenness(ground: LitGround, view: View) -> float:
    """Standard deviation of the log brightness, averaged over cells that are larger than the ground's texture."""
    brightness = np.where(view.is_ground, ground.colours[..., 0], np.nan)
    cells = [np.nanmean(block) for rows in np.array_split(brightness, 6) for block in np.array_split(rows, 8, axis=1)]
    return float(np.nanstd(cells))


@pytest.mark.parametrize("lamp_m", [OVERHEAD, BESIDE], ids=["overhead", "beside"])
def test_a_lamps_ground_becomes_more_even(lamp_m: Float) -> None:
    view, by_quadratic, found = grounds(lamp_m)
    assert found.fall is not None
    before, after = (unevenness(each, view) for each in (by_quadratic, found))
    assert after < 0.8 * before


@pytest.mark.parametrize(("lamp_m", "kind"), [(None, AUTO), (OVERHEAD, SUN)])
def test_no_fall_is_taken_out_under_a_sun(lamp_m: Float | None, kind: str) -> None:
    view, by_quadratic, found = grounds(lamp_m, kind)
    assert found.fall is None
    np.testing.assert_array_equal(found.colours[view.is_ground], by_quadratic.colours[view.is_ground])


@pytest.mark.parametrize("first_lamp_m", [None, OVERHEAD], ids=["sun", "lamp"])
def test_in_other_views_light_falls_off_if_it_does_in_the_first(first_lamp_m: Float | None) -> None:
    _, _, first = grounds(first_lamp_m)
    pose = camera_towards((0.02, 0.0), 0.5, 50.0, 120.0)
    other = View.of(paint(FAR_AWAY, lamp_m=OVERHEAD, T_cam_marker=pose).tracked, BALANCED.coarse_width_px)
    found = lit_ground_beside(first, other, BALANCED.ground, AUTO)
    assert found is not None
    assert (found.fall is None) == (first.fall is None) == (first_lamp_m is None)


def as_seen(view: View, light: Float) -> View:
    """The view with its linear light multiplied by `light` (h, w)."""
    linear = LINEAR_FROM_SRGB_8BIT[view.image_bgr] * light[..., None]
    return replace(view, image_bgr=(255 * srgb_from_linear(linear.clip(0, 1)) + 0.5).astype(np.uint8))


def places_in(view: View) -> Float:
    """(h, w, 2) metres on the plane."""
    rows, columns = np.indices(view.is_ground.shape)
    pixels = np.stack([columns.ravel(), rows.ravel(), np.ones(rows.size)])
    on_plane = np.linalg.solve(image_from_plane(view.camera, view.T_cam_marker), pixels)
    return np.asarray((on_plane[:2] / on_plane[2]).T.reshape(*rows.shape, 2))


def test_on_gloss_a_suns_ground_becomes_more_even_and_is_no_lamps() -> None:
    """It mirrors a low sun that stands opposite the camera."""
    view = View.of(paint(FAR_AWAY).tracked, BALANCED.coarse_width_px)
    to_eye = camera_centre(view.T_cam_marker)
    sun = np.array([[-2 * to_eye[0] / to_eye[2], -2 * to_eye[1] / to_eye[2], 0.0]])
    shine = mirrored(places_in(view).reshape(-1, 2), to_eye, sun, Gloss(0.4, 0.1)).reshape(view.is_ground.shape)
    glossy = as_seen(view, 0.5 * (1 + 0.8 * shine))
    by_quadratic = fit_lit_ground(glossy.image_bgr, glossy.is_ground, BALANCED.ground)
    found = lit_ground_of(glossy, BALANCED.ground, AUTO)
    assert by_quadratic is not None
    assert found is not None
    assert found.fall is not None
    assert found.fall.light[2] == 0
    assert unevenness(found, glossy) < unevenness(by_quadratic, glossy)


def test_on_gloss_a_lamp_is_where_its_light_and_its_mirror_image_say() -> None:
    """The image alone, a spot that lies towards the camera, would be taken for the light below a lamp there."""
    lamp_m, gloss = np.array([-0.35, 0.1, 0.4]), Gloss(0.3, 0.08)
    view = View.of(paint(FAR_AWAY, lamp_m=lamp_m).tracked, BALANCED.coarse_width_px)
    lamp = np.array([[*lamp_m[:2] / lamp_m[2], 1 / lamp_m[2]]])
    shine = mirrored(places_in(view).reshape(-1, 2), camera_centre(view.T_cam_marker), lamp, gloss)
    found = lit_ground_of(as_seen(view, 0.5 * (1 + shine.reshape(view.is_ground.shape))), BALANCED.ground, AUTO)
    assert found is not None
    assert found.fall is not None
    assert found.fall.gloss is not None
    assert found.fall.light[2] > 0
    told = np.append(found.fall.light[:2], 1.0)
    assert angle_between(told, lamp_m) < np.radians(15)


@pytest.mark.parametrize("brighter", [0.4, 1.5])
def test_behind_a_tables_end_the_light_does_not_fall(brighter: float) -> None:
    view = View.of(paint(FAR_AWAY).tracked, BALANCED.coarse_width_px)
    beyond = np.linspace(0, 1, view.size[1])[:, None] < np.linspace(0.1, 0.4, view.size[0])
    found = lit_ground_of(as_seen(view, np.where(beyond, brighter, 1.0) / 1.5), BALANCED.ground, AUTO)
    assert found is not None
    assert found.fall is None
