"""Lambert's shading: a painted body shows its own light, less of others, and one under the sky alone shows none."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float, Mask
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import inverse_rigid
from ashe_live.light.explanation.judgement.shading import BOUNCE, UNKNOWN, Shading, shading_of
from ashe_live.light.ground.regions import Region
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import predicted
from tests.light.painted_bodies import body_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, SHADOW_RATIO, Caster
from tests.light.synthetic_masks import direction


def sun(azimuth_deg: float, elevation_deg: float) -> Float:
    return at_infinity(direction(azimuth_deg, elevation_deg))


LEFT_OVER = float(SHADOW_RATIO.mean())
CENTRE, RADIUS = np.array([0.12, 0.0, 0.035]), 0.035
BALL = Proxy("sphere", np.array([[*CENTRE, RADIUS, RADIUS]]))


def shading_in(caster: Caster, to_light: Float | None = None, **how: str) -> Shading:
    here = painted_region(caster, **how)
    lights = [at_infinity(here.scene.to_light if to_light is None else to_light)]
    return shading_of(here.region, here.body, body_of(here, caster).body.proxy, lights, [LEFT_OVER])


def opposite(to_light: Float) -> Float:
    return np.asarray(to_light * (-1, -1, 1))


def shown(ball: Float) -> tuple[Region, Mask]:
    """The region of a painted picture with these log brightnesses (h, w) in place of its own; and where they are."""
    region = painted_region(BOX).region
    colours = region.colours.copy()
    colours[..., 0] = np.nan_to_num(ball)
    return replace(region, colours=colours), np.isfinite(ball)


def normals_of_ball() -> Float:
    """(h, w, 3) where rays meet the ball; nan elsewhere."""
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
    return np.asarray(met / RADIUS)


def lit_ball(*lights: Float, ambient: float = 0.3) -> Float:
    """(h, w) log of Lambert's irradiance, in units of that across a light at the ball's foot; nan beside the ball."""
    normals, total = normals_of_ball(), ambient
    foot, surface = CENTRE * (1, 1, 0), CENTRE + RADIUS * normals_of_ball()
    for x, y, z, w in lights:
        away, at_foot = (np.array([x, y, z]) - w * place for place in (surface, foot))
        distance = np.linalg.norm(away, axis=2)
        total = total + np.maximum((normals * away).sum(axis=2), 0) / distance**3 * np.linalg.norm(at_foot) ** 2
    return np.asarray(np.log(total))


def ball_under_the_sky() -> Float:
    """(h, w) log irradiance of an even sky and of what the ground sends back of it; nan beside the ball."""
    up = normals_of_ball()[..., 2]
    return np.asarray(np.log((1 + up) / 2 + BOUNCE * (1 - up) / 2))


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_a_painted_body_shows_its_light_and_not_the_opposite_one(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)
    true, wrong = shading_in(caster, ground=ground), shading_in(caster, opposite(here.scene.to_light), ground=ground)
    assert true.contrast > max(wrong.contrast, 0)
    assert true.sunlit > max(wrong.sunlit, 0)


@pytest.mark.parametrize("azimuth_deg", [150.0, 200.0, 300.0, 350.0])
def test_a_lambertian_ball_shows_its_light_and_less_of_any_other(azimuth_deg: float) -> None:
    light = sun(azimuth_deg, 40.0)
    region, where = shown(lit_ball(light))
    shadings = [shading_of(region, where, BALL, [sun(azimuth_deg + by, 40.0)], [LEFT_OVER]) for by in (0, 45, 90, 180)]
    assert shadings[0].contrast > 1
    assert shadings[0].sunlit > 2
    assert np.all(np.diff([shading.contrast for shading in shadings]) < 0)
    assert np.all(np.diff([shading.sunlit for shading in shadings]) < 0)
    assert shadings[-1].contrast < 0
    assert shadings[-1].sunlit < 0


@pytest.mark.parametrize("azimuth_deg", [150.0, 300.0])
def test_a_ball_under_the_sky_alone_shows_no_light_however_much_darker_the_ground_is_beside_it(
    azimuth_deg: float,
) -> None:
    region, where = shown(ball_under_the_sky())
    for ratio in (0.2, 0.5):
        shading = shading_of(region, where, BALL, [sun(azimuth_deg, 40.0)], [ratio])
        assert shading.contrast < -0.5
        assert shading.sunlit < 1


def test_two_lights_show_both() -> None:
    lights = [sun(170.0, 40.0), sun(300.0, 40.0)]
    region, where = shown(lit_ball(*lights))
    both = shading_of(region, where, BALL, lights, [0.6, 0.6])
    alone = [shading_of(region, where, BALL, [light], [0.6]) for light in lights]
    assert all(both.contrast > one.contrast for one in alone)
    assert all(both.sunlit > one.sunlit for one in alone)


def test_a_lamp_far_away_shades_like_a_sun() -> None:
    region, where = shown(lit_ball(sun(200.0, 40.0)))
    far = np.append(1e6 * direction(200.0, 40.0), 1.0)
    one, other = (shading_of(region, where, BALL, [light], [LEFT_OVER]) for light in (sun(200.0, 40.0), far))
    assert (one.contrast, one.sunlit) == pytest.approx((other.contrast, other.sunlit), rel=1e-3)


@pytest.mark.parametrize("azimuth_deg", [200.0, 300.0])
def test_a_near_lamp_shows_itself_and_less_of_the_sun_in_its_direction(azimuth_deg: float) -> None:
    """A few radii away its light falls off across the ball, and comes to every point from elsewhere."""
    to_lamp = direction(azimuth_deg, 50.0)
    lamp = np.append(CENTRE * (1, 1, 0) + 3 * RADIUS * to_lamp, 1.0)
    region, where = shown(lit_ball(lamp))
    true, wrong = (shading_of(region, where, BALL, [light], [LEFT_OVER]) for light in (lamp, at_infinity(to_lamp)))
    assert true.contrast > wrong.contrast + 0.1
    assert true.sunlit > wrong.sunlit


def test_a_light_is_the_more_surely_seen_the_more_of_the_shading_it_makes() -> None:
    light = sun(200.0, 40.0)
    found = []
    for ambient in (3.0, 1.0, 0.3):
        region, where = shown(lit_ball(light, ambient=ambient))
        found.append(shading_of(region, where, BALL, [light], [LEFT_OVER]).sunlit)
    assert np.all(np.diff(found) > 0)


def test_a_light_that_shades_the_object_like_the_sky_is_not_seen_apart_from_it() -> None:
    """With next to no shadow there is next to no light of its own to be seen."""
    light = sun(200.0, 40.0)
    region, where = shown(lit_ball(light))
    assert abs(shading_of(region, where, BALL, [light], [1.0]).sunlit) < 1e-3


def test_exposure_and_the_colour_of_the_object_do_not_matter() -> None:
    light = sun(200.0, 40.0)
    logs = lit_ball(light)
    found = []
    for offset in (0.0, -3.0, 1.0):
        region, where = shown(logs + offset)
        shading = shading_of(region, where, BALL, [light], [LEFT_OVER])
        found.append((shading.contrast, shading.sunlit))
    np.testing.assert_allclose(found[1:], [found[0]] * 2, atol=1e-4)


def test_what_is_as_bright_all_over_is_not_lit_by_a_strong_light() -> None:
    region, where = shown(np.where(np.isfinite(lit_ball(sun(200.0, 40.0))), -0.7, np.nan))
    assert shading_of(region, where, BALL, [sun(200.0, 40.0)], [LEFT_OVER]).contrast < 0


def test_a_handful_of_pixels_is_no_evidence() -> None:
    here = painted_region(BOX)
    few = np.zeros_like(here.body)
    few[30:36, 30:36] = True
    for body in (few, few & False):
        shading = shading_of(
            here.region, body, body_of(here, BOX).body.proxy, [at_infinity(here.scene.to_light)], [LEFT_OVER]
        )
        assert shading == UNKNOWN


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_turning_the_marker_by_quarters_changes_nothing(quarters: int) -> None:
    here = painted_region(CYLINDER)
    c, s = ((0, 1), (-1, 0), (0, -1))[quarters - 1]
    R = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    view = replace(here.region.view, T_cam_marker=here.region.view.T_cam_marker @ R.T)
    spheroids = body_of(here, CYLINDER).body.proxy.spheroids_marker.copy()
    spheroids[:, :3] = spheroids[:, :3] @ R[:3, :3].T
    light = at_infinity(R[:3, :3] @ here.scene.to_light)
    turned = shading_of(replace(here.region, view=view), here.body, Proxy("frustum", spheroids), [light], [LEFT_OVER])
    assert (turned.contrast, turned.sunlit) == pytest.approx(
        (shading_in(CYLINDER).contrast, shading_in(CYLINDER).sunlit)
    )


@pytest.mark.parametrize(
    "light", [(1, 0, 0, 0), (0, 0, 1, 0), (0.6, 0.8, 1e-9, 0), (0, 1, -0.5, 0), (0.12, 0, 0.03, 1), (0.12, 0, 0.04, 1)]
)
@pytest.mark.parametrize("ratio", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("spheroid", [(0.12, 0, 0, 0, 0), (0.12, 0, 0.03, 0.03, 0.03), (0, -9.0, 1, 1, 1)])
def test_any_body_and_light_has_a_finite_shading(
    light: tuple[float, ...], ratio: float, spheroid: tuple[float, ...]
) -> None:
    here = painted_region(BOX)
    proxy = Proxy("sphere", np.array([spheroid]))
    shading = shading_of(here.region, here.body, proxy, [np.array(light, float)], [ratio])
    assert np.isfinite([shading.contrast, shading.sunlit]).all()
    assert predicted(proxy, np.empty((0, 4)), here.region.view).body.shape == here.body.shape
