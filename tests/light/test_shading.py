"""Lambert's shading: a painted body agrees with its own light, less with others, and a uniform one with none."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import inverse_rigid, normalised
from ashe_live.light.predicted import predicted
from ashe_live.light.regions import Region
from ashe_live.light.shading import agreement
from tests.light.painted_bodies import body_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Caster
from tests.light.synthetic_masks import direction

LEFT_OVER = float(SHADOW_RATIO.mean())
CENTRE, RADIUS = np.array([0.12, 0.0, 0.035]), 0.035
BALL = Proxy("sphere", np.array([[*CENTRE, RADIUS, RADIUS]]))


def agreed(caster: Caster, to_light: Float | None = None, **how: str) -> float:
    here = painted_region(caster, **how)
    lights = [here.scene.to_light if to_light is None else to_light]
    return agreement(here.region, here.body, body_of(here, caster).proxy, lights, [LEFT_OVER])


def opposite(to_light: Float) -> Float:
    return np.asarray(to_light * (-1, -1, 1))


def shown(ball: Float) -> tuple[Region, Mask]:
    """The region of a painted picture with these log brightnesses (h, w) in place of its own; and where they are."""
    region = painted_region(BOX).region
    colours = region.colours.copy()
    colours[..., 0] = np.nan_to_num(ball)
    return replace(region, colours=colours), np.isfinite(ball)


def lit_ball(*to_lights: Float, ambient: float = 0.3) -> Float:
    """(h, w) log of Lambert's irradiance where rays meet the ball; nan elsewhere."""
    view = painted_region(BOX).region.view
    T_marker_cam = inverse_rigid(view.T_cam_marker)
    width, height = view.size
    pixels = np.stack([*np.meshgrid(np.arange(width), np.arange(height)), np.ones((height, width))], axis=2)
    rays = pixels @ np.linalg.inv(view.camera.K).T @ T_marker_cam[:3, :3].T
    rays /= np.linalg.norm(rays, axis=2, keepdims=True)
    to_eye = T_marker_cam[:3, 3] - CENTRE
    along = rays @ to_eye
    inside = along**2 - (to_eye @ to_eye - RADIUS**2)
    met = to_eye + rays * (-along - np.sqrt(np.where(inside > 0, inside, np.nan)))[..., None]
    normals = met / RADIUS
    return np.asarray(np.log(ambient + sum(np.maximum(normals @ light, 0) for light in to_lights)))


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_a_painted_body_agrees_with_its_light_and_not_with_the_opposite_one(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    assert agreed(caster, ground=ground) > 0.9
    assert agreed(caster, opposite(here.scene.to_light), ground=ground) < 0.5


@pytest.mark.parametrize("azimuth_deg", [150.0, 200.0, 300.0, 350.0])
def test_a_lambertian_ball_agrees_with_its_light_and_less_with_any_other(azimuth_deg: float) -> None:
    light = direction(azimuth_deg, 40.0)
    region, where = shown(lit_ball(light))
    true = agreement(region, where, BALL, [light], [LEFT_OVER])
    others = [agreement(region, where, BALL, [direction(azimuth_deg + by, 40.0)], [LEFT_OVER]) for by in (45, 90, 180)]
    assert true > 0.9
    assert true > others[0] > others[1] > others[2]
    assert others[2] < 0


def test_two_lights_agree_with_both() -> None:
    lights = [direction(170.0, 40.0), direction(300.0, 40.0)]
    region, where = shown(lit_ball(*lights))
    both = agreement(region, where, BALL, lights, [0.6, 0.6])
    assert both > 0.85
    assert all(both > agreement(region, where, BALL, [light], [0.6]) for light in lights)


def test_exposure_and_contrast_do_not_matter() -> None:
    """A correlation knows neither a picture's brightness nor its contrast; but which is bright, and which dark."""
    light = direction(200.0, 40.0)
    logs = lit_ball(light)
    values = []
    for gain, offset in ((1.0, 0.0), (0.5, -3.0), (2.0, 1.0), (-1.0, 0.0)):
        region, where = shown(gain * logs + offset)
        values.append(agreement(region, where, BALL, [light], [LEFT_OVER]))
    np.testing.assert_allclose(values[1:], [values[0], values[0], -values[0]], atol=1e-5)


def test_a_uniform_object_tells_nothing() -> None:
    region, where = shown(np.where(np.isfinite(lit_ball(direction(200.0, 40.0))), -0.7, np.nan))
    assert agreement(region, where, BALL, [direction(200.0, 40.0)], [LEFT_OVER]) == 0


def test_hardly_any_pixel_tells_nothing() -> None:
    here = painted_region(BOX)
    few = np.zeros_like(here.body)
    few[30:36, 30:36] = True
    for body in (few, few & False):
        assert agreement(here.region, body, body_of(here, BOX).proxy, [here.scene.to_light], [LEFT_OVER]) == 0


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_turning_the_marker_by_quarters_changes_nothing(quarters: int) -> None:
    here = painted_region(CYLINDER)
    c, s = ((0, 1), (-1, 0), (0, -1))[quarters - 1]
    R = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    view = replace(here.region.view, T_cam_marker=here.region.view.T_cam_marker @ R.T)
    spheroids = body_of(here, CYLINDER).proxy.spheroids_marker.copy()
    spheroids[:, :3] = spheroids[:, :3] @ R[:3, :3].T
    light = R[:3, :3] @ here.scene.to_light
    turned = agreement(replace(here.region, view=view), here.body, Proxy("frustum", spheroids), [light], [LEFT_OVER])
    assert turned == pytest.approx(agreed(CYLINDER), abs=1e-6)


@pytest.mark.parametrize("light", [(1, 0, 0), (0, 0, 1), (0.6, 0.8, 1e-9), (0, 1, -0.5)])
@pytest.mark.parametrize("left_over", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("spheroid", [(0.12, 0, 0, 0, 0), (0.12, 0, 0.03, 0.03, 0.03), (0, -9.0, 1, 1, 1)])
def test_any_body_and_light_has_a_finite_agreement(
    light: tuple[float, ...], left_over: float, spheroid: tuple[float, ...]
) -> None:
    here = painted_region(BOX)
    proxy = Proxy("sphere", np.array([spheroid]))
    value = agreement(here.region, here.body, proxy, [normalised(np.array(light, float))], [left_over])
    assert -1 <= value <= 1
    assert predicted(proxy, [], here.region.view).body.shape == here.body.shape
