import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from ashe_live.core.arrays import Float, Image
from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import direction_from_angles, project, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.quality import FAST
from ashe_live.render.lights.cast_shadows import is_inside, shadow_hull_of_point
from ashe_live.render.lights.light_map import HEIGHT_PX, light_map
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.lights.open_sky import _irradiance, open_sky
from ashe_live.render.lights.photometry import Photometry
from ashe_live.render.lights.seen_light import lighting_in

SIDE_M = 0.08
CAMERA = Camera((320, 240), np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]), np.zeros(5), "file")
# From the front and above, so that box and shadow stand side by side.
POSE = rigid([[1, 0, 0], [0, -0.6, -0.8], [0, 0.8, -0.6]], [0.0, 0.0, 0.6])
CORNERS = [(x, y, z, 0.0, 0.0) for x in (-0.03, 0.03) for y in (-0.02, 0.02) for z in (0.0, 0.1)]
BOX = Proxy("box", np.array(CORNERS))
TO_LIGHT = direction_from_angles(math.radians(10), math.radians(40))
RATIO = np.array([0.2, 0.3, 0.4])
WHITE = np.full(3, 0.9)
GROUND = np.full(3, 0.3)


def seen(object_level: int) -> TrackedFrame:
    """A box of one colour on grey ground; its shadow is not painted, as the light says what it is."""
    image: Image = np.full((240, 320, 3), 120, np.uint8)
    outline = cv2.convexHull(project(CAMERA, POSE, BOX.points_marker()).astype(np.float32))
    cv2.fillConvexPoly(image, np.round(outline).astype(np.int32), (object_level,) * 3)
    corners = project(CAMERA, POSE, square_corners(SIDE_M))
    return TrackedFrame(Frame(image, 0, 0.0), CAMERA, MarkerPose(POSE, corners, SIDE_M, 0.0, None))


def found(object_level: int, body: Proxy = BOX) -> Float:
    lighting = lighting_of((Light(TO_LIGHT, shadow_rgb_ratio=RATIO),), None, GROUND)
    return open_sky(seen(object_level), body, lighting, WHITE)


def test_a_black_object_only_hides_the_sky() -> None:
    random = np.random.default_rng(3)
    shadow = shadow_hull_of_point(BOX.points_marker(), np.append(TO_LIGHT, 0.0))
    foot = shadow_hull_of_point(BOX.points_marker(), np.array([0.0, 0.0, 1.0, 0.0]))
    places = random.uniform(shadow.min(axis=0), shadow.max(axis=0), (2000, 2))
    places = places[is_inside(shadow, places) & ~is_inside(foot, places)]
    squared, azimuth = random.uniform(size=1000), random.uniform(0, math.tau, 1000)
    flat = np.sqrt(squared)
    sky = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sqrt(1 - squared), 0 * flat])
    hidden = np.mean([is_inside(shadow_hull_of_point(BOX.points_marker(), way), places) for way in sky], axis=0)
    assert np.median(hidden) > 0.05
    assert found(0) == pytest.approx(RATIO / (1 - np.median(hidden)), rel=0.06)


def test_what_an_object_sends_back_is_not_missing() -> None:
    black, grey, white = (found(level) for level in (0, 120, 200))
    assert (black > grey).all()
    assert (grey > white).all()


@pytest.mark.parametrize(("from_m", "to_m", "shaded"), [(0.0, 9.0, 1.0), (0.15, 0.2, 1 / 3), (0.0, 0.05, 0.0)])
@pytest.mark.parametrize("inverse_distance", [0.0, 1.5])
def test_a_wall_gets_half_of_sky_and_ground_and_less_of_that_where_the_shadow_lies_before_it(
    from_m: float, to_m: float, shaded: float, inverse_distance: float
) -> None:
    """Of ground to the horizon a third of a wall's light is from about 1.7 times the height away."""
    lamp = Light(TO_LIGHT, shadow_rgb_ratio=RATIO, inverse_distance=inverse_distance)
    lighting = lighting_of((lamp,), None, GROUND)
    (light,) = lighting.lights
    shadow = np.array([(from_m, -9.0), (to_m, -9.0), (to_m, 9.0), (from_m, 9.0)])
    place, normal = np.array([(0.0, 0.0, 0.1)]), np.array([(1.0, 0.0, 0.0)])
    away = TO_LIGHT - inverse_distance * place[0]
    direct = normal[0] @ away / np.linalg.norm(away) ** 3 * np.array(light.irradiance)
    ground = np.array(lighting.bounce) * (1 - shaded * np.array(light.ground_share))
    expected = 0.5 * np.array(lighting.sky) + 0.5 * ground + direct
    assert _irradiance(lighting, shadow, place, normal)[0] == pytest.approx(expected)
    (top,) = _irradiance(lighting, shadow, place, np.array([(0.0, 0.0, 1.0)]))
    level = np.array(lighting.sky) + away[2] / np.linalg.norm(away) ** 3 * np.array(light.irradiance)
    assert top == pytest.approx(level)


def test_without_object_or_shadow_in_view_nothing_is_known() -> None:
    aside = Proxy("box", BOX.spheroids_marker + np.array([5.0, 0, 0, 0, 0]))
    assert found(0, aside) == pytest.approx(RATIO)
    assert found(0, Proxy("point", np.zeros((1, 5)))) == pytest.approx(RATIO)


def test_the_sky_is_that_of_the_open_where_its_share_was_seen_in_a_shadow() -> None:
    tracked = seen(0)
    light = Light(TO_LIGHT, shadow_rgb_ratio=RATIO)
    lit = Illumination((light,), real_object=BOX, ground_rgb=GROUND, seen_in=tracked)
    photometry = Photometry(FAST.render)
    assert (np.array(photometry.lighting(lit).sky) > 1.05 * RATIO).all()
    without = Illumination((light,), ground_rgb=GROUND, seen_in=tracked)
    assert photometry.lighting(without).sky == pytest.approx(tuple(RATIO), rel=0.01)


@pytest.mark.parametrize("case", ["two lights", "by its intensity", "no shadow was measured", "of a known body"])
def test_a_sky_that_was_not_read_in_the_shadow_of_one_light_is_that_of_the_open_already(case: str) -> None:
    tracked, light = seen(0), Light(TO_LIGHT, shadow_rgb_ratio=RATIO)
    other = Light(direction_from_angles(2.0, 0.9), shadow_rgb_ratio=np.full(3, 0.9))
    by_intensity = Light(TO_LIGHT, shadow_rgb_ratio=RATIO, intensity_rgb_ratio=1 / RATIO - 1, inverse_distance=1.0)
    lights = {
        "two lights": (light, other),
        "by its intensity": (by_intensity,),
        "no shadow was measured": (Light(TO_LIGHT),),
    }
    if case == "of a known body":
        assert tracked.marker is not None
        tracked = replace(tracked, marker=replace(tracked.marker, body=BOX))
    lit = Illumination(lights.get(case, (light,)), real_object=BOX, ground_rgb=GROUND, seen_in=tracked)
    skies = [Photometry(FAST.render).lighting(each).sky for each in (lit, replace(lit, real_object=None))]
    assert skies[0] == pytest.approx(skies[1])


def test_on_a_tilted_sheet_the_open_skys_share_changes_as_the_ambient_light_does() -> None:
    light = Light(TO_LIGHT, shadow_rgb_ratio=RATIO)
    lit = Illumination((light,), ambient_rgb_ratio=RATIO, real_object=BOX, ground_rgb=GROUND, seen_in=seen(0))
    open_air = np.array(lighting_in(lit).sky)
    assert (open_air > 1.05 * RATIO).all()
    tilted = lit.relit((light,), 1.5 * RATIO)
    for sky in (lighting_in(tilted).sky, Photometry(FAST.render).lighting(tilted).sky):
        assert np.array(sky) == pytest.approx(1.5 * open_air)


def test_shares_of_sky_and_light_are_all_of_the_light() -> None:
    lit = Illumination((Light(TO_LIGHT, shadow_rgb_ratio=RATIO),), real_object=BOX, ground_rgb=GROUND, seen_in=seen(0))
    lighting = Photometry(FAST.render).lighting(lit)
    assert np.array(lighting.sky) + lighting.ground_shares.sum(axis=0) == pytest.approx(np.ones(3))


def test_the_sky_that_is_saved_is_the_one_that_models_are_drawn_in() -> None:
    lit = Illumination((Light(TO_LIGHT, shadow_rgb_ratio=RATIO),), real_object=BOX, ground_rgb=GROUND, seen_in=seen(0))
    sky = Photometry(FAST.render).lighting(lit).sky
    assert np.median(light_map(lit)[: HEIGHT_PX // 2], axis=(0, 1)) == pytest.approx(np.array(sky), rel=1e-5)


def test_they_are_so_in_a_colour_that_no_shadow_is_darker_in() -> None:
    light = Light(TO_LIGHT, shadow_rgb_ratio=np.array([1.0, 0.5, 0.4]))
    lighting = lighting_of((light,), np.array([0.9, 0.5, 0.4]))
    assert np.array(lighting.sky) + lighting.ground_shares.sum(axis=0) == pytest.approx(np.ones(3))
