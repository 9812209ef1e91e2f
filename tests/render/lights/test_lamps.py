"""Lamps: shadows and light where projective geometry and the inverse square say, whatever the lamp's place."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import box_corners
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.models.primitives import box
from ashe_live.quality import BALANCED, QUALITIES
from ashe_live.render.lights.light_view import view_of
from ashe_live.render.lights.lighting import lighting_of
from ashe_live.render.scene import Scene
from tests.render.green_model import split
from tests.render.in_turns import in_turns
from tests.render.inside import inside_px

GREEN = (0.0, 1.0, 0.0, 1.0)
DARK_GREEN = (0.0, 0.3, 0.0, 1.0)  # which throws little of its colour onto its shadow
GROUND = 200
POLE = (0.02, 0.03, 0.07)
POLE_CORNERS = box_corners(np.array([(-POLE[0] / 2, -POLE[1] / 2, 0), (POLE[0] / 2, POLE[1] / 2, POLE[2])]))
RATIO = (0.2, 0.2, 0.2)
FAINT = (0.02, 0.02, 0.02)  # so little other light that shadows are dark far from the lamp as well
# From above and beside it, from 15 cm and from a metre, over another place than the marker.
PLACES = ((-0.12, 0.1, 0.2), (0.05, -0.02, 0.16), (0.6, 0.5, 0.6), (-0.3, -0.1, 0.12), (0.0, 0.0, 0.4))


def lamp_at(place, ratio=RATIO, radius_m: float = 0.002) -> Light:
    distance = float(np.linalg.norm(place))
    return Light(place, shadow_rgb_ratio=np.array(ratio), inverse_distance=1 / distance, radius_m=radius_m)


def shadows(points: np.ndarray, light: np.ndarray) -> np.ndarray:
    """(n, 3) of points (n, 3) on the plane z = 0, from a lamp at (3,)."""
    return points + (points - light) * (points[:, 2:] / (light[2] - points[:, 2:]))


def linear(picture: np.ndarray) -> np.ndarray:
    """(h, w) of the green channel."""
    return LINEAR_FROM_SRGB_8BIT[picture[..., 1]]


def pixel(tracked, point) -> tuple[int, int]:
    ((column, row),) = np.round(project(tracked.camera, tracked.marker.T_cam_marker, [point])).astype(int)
    return row, column


@pytest.mark.parametrize(("quality", "place"), in_turns((place,) for place in PLACES))
def test_shadow_falls_where_the_planar_projection_says(make_renderer, stage, quality: str, place) -> None:
    """And begins where the model stands: no light gets in between, not even 15 cm from the lamp."""
    renderer = make_renderer(QUALITIES[quality].render)
    tracked = stage.tracked(GROUND, stage.pose(-90, 50, 0.5))
    renderer.render(Scene(tracked, stage.placed(box(POLE, DARK_GREEN)), Illumination((lamp_at(place, FAINT),))))
    is_model, is_shadow = split(renderer.read_bgr())
    T_cam_marker = tracked.marker.T_cam_marker
    in_model = inside_px(project(tracked.camera, T_cam_marker, POLE_CORNERS))
    in_shadow = inside_px(project(tracked.camera, T_cam_marker, shadows(POLE_CORNERS, np.array(place))))
    assert is_model[in_model > 1].all()
    assert (is_shadow | is_model)[in_shadow > 1.5].all()
    assert not is_shadow[in_shadow < -1.5].any()
    assert is_shadow.sum() > 40


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("size_deg", [0.53, 6.0])
def test_a_lamp_a_kilometre_away_is_a_sun(make_renderer, stage, quality: str, size_deg: float) -> None:
    renderer = make_renderer(QUALITIES[quality].render)
    proxy = Proxy("can", np.array([(0.06, 0.05, 0.0, 0.02, 0.0), (0.06, 0.05, 0.06, 0.02, 0.0)]))
    sun = replace(stage.light(30, 50, RATIO), angular_size_rad=math.radians(size_deg))
    pictures = []
    for light in (sun, replace(sun, inverse_distance=1e-3)):
        tracked = stage.tracked(GROUND, stage.pose(-90, 45, 0.4))
        illumination = Illumination((light,), real_object=proxy, ground_rgb=np.full(3, 0.55), seen_in=tracked)
        renderer.render(Scene(tracked, stage.placed(box(POLE, GREEN)), illumination))
        pictures.append(renderer.read_bgr().astype(int))
    difference = np.abs(pictures[0] - pictures[1])
    # The taps of a penumbra are turned anew for each texel, and these do not all lie where they did.
    assert (difference.max(axis=2) > 1).mean() < 1.5e-3
    assert difference.max() < 30


def test_ground_is_darkened_by_what_is_blocked_there(make_renderer, stage) -> None:
    """Deep in the shadow all that is left is the other light: more where the lamp is far, less near it."""
    place = np.array((-0.25, 0.0, 0.15))
    light, ratio = lamp_at(place), RATIO[0]
    renderer = make_renderer(BALANCED.render)
    tracked = stage.tracked(255, stage.pose(-90, 60, 0.9, target=(0.1, 0, 0)))
    wall = box((0.01, 0.3, 0.1), GREEN)
    picture = linear(stage.picture(renderer, Scene(tracked, stage.placed(wall), Illumination((light,)))))
    for x in (0.17, 0.22, 0.27):
        distance = np.linalg.norm(place - (x, 0, 0)) / np.linalg.norm(place)
        lamp = (1 - ratio) / distance**3
        # So far from the wall that what it hides of the sky counts no more.
        found = picture[pixel(tracked, (x, 0.0, 0.0))] / LINEAR_FROM_SRGB_8BIT[255]
        assert found == pytest.approx(ratio / (ratio + lamp), rel=0.03)


def test_surfaces_are_lit_by_the_inverse_square_and_the_cosine(make_renderer, stage) -> None:
    """A white plate just above the plane has the brightness of white ground, everywhere on it."""
    place = np.array((0.1, 0.05, 0.2))
    light, ratio = lamp_at(place), RATIO[0]
    renderer = make_renderer(BALANCED.render)
    tracked = stage.tracked(90, stage.pose(-90, 60, 0.5))
    renderer.render(Scene(tracked, stage.placed(box((0.3, 0.2, 1e-4))), Illumination((light,))))
    picture = linear(renderer.read_bgr())
    white = picture[pixel(tracked, (0.0, 0.0, 0.0))]
    for x, y in itertools.product((-0.13, -0.06, 0.0), (-0.07, 0.0, 0.05)):
        distance = np.linalg.norm(place - (x, y, 0)) / np.linalg.norm(place)
        found = picture[pixel(tracked, (x, y, 0.0))] / white
        assert found == pytest.approx(ratio + (1 - ratio) / distance**3, rel=0.03)


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("radius_m", [0.01, 0.03])
def test_penumbra_grows_with_the_lamps_radius(make_renderer, stage, quality: str, radius_m: float) -> None:
    """Below a plate in the air, by the law of a disc that a straight edge covers."""
    height, top = 0.06, 0.36
    plate = box((0.1, 0.1, 0.002)).moved(1.0, np.array([0.0, 0.0, height - 0.002]))
    tracked = stage.tracked(255, stage.pose(0, 40, 0.35, target=(0.06, 0, 0)))
    renderer = make_renderer(QUALITIES[quality].render)
    lamp = lamp_at((0.0, 0.0, top), (0.0, 0.0, 0.0), radius_m)
    renderer.render(Scene(tracked, stage.placed(plate), Illumination((lamp,))))
    edge, half = 0.05 * top / (top - height), radius_m * height / (top - height)
    offsets = np.linspace(-1.6, 1.6, 33)
    lit = stage.along(renderer.read_bgr(), tracked, edge + half * offsets)
    t = np.clip(offsets, -1, 1)
    free = 0.5 + (t * np.sqrt(1 - t**2) + np.arcsin(t)) / math.pi
    assert np.abs(lit - free).mean() < 0.04


EVERY_PLACE = [
    (0.0, 0.0, 0.03),  # in the model
    (0.0, 0.0, 0.0701),  # on its top
    (0.0101, 0.0, 0.03),  # on its side
    (0.1, 0.0, 0.03),  # below its top
    (0.1, 0.0, 1e-4),  # nearly on the plane
    (0.1, 0.0, -0.2),  # below the plane
    (0.0, 0.0, -0.2),
    (0.06, 0.05, 0.03),  # in the real object
    (0.0, -0.8, 0.6),  # behind the camera
    (0.0, 0.0, 0.08),  # 8 cm straight above the marker
    (0.0, 0.0, 20.0),
    (0.001, 0.0, 0.0),
]


@pytest.mark.parametrize(("quality", "place"), in_turns((place,) for place in EVERY_PLACE))
def test_every_place_of_a_lamp_gives_a_picture(make_renderer, stage, quality: str, place) -> None:
    """The model is there, ground that it cannot shade is the video's, and no light comes from under the table."""
    renderer = make_renderer(QUALITIES[quality].render)
    proxy = Proxy("can", np.array([(0.06, 0.05, 0.0, 0.02, 0.0), (0.06, 0.05, 0.06, 0.02, 0.0)]))
    tracked = stage.tracked(GROUND, stage.pose(-90, 45, 0.4))
    illumination = Illumination(
        (lamp_at(place, FAINT),), real_object=proxy, ground_rgb=np.full(3, 0.55), seen_in=tracked
    )
    for shows_light in (True, False):
        renderer.render(Scene(tracked, stage.placed(box(POLE, GREEN)), illumination, shows_light=shows_light))
    picture = renderer.read_bgr()
    is_model, is_shadow = split(picture)
    T_cam_marker = tracked.marker.T_cam_marker
    in_model = inside_px(project(tracked.camera, T_cam_marker, POLE_CORNERS))
    assert is_model[in_model > 1].mean() > 0.6  # the rest is behind the real object
    beside = (inside_px(project(tracked.camera, T_cam_marker, 3 * POLE_CORNERS)) < 0) & ~is_model
    if place[2] <= 0:
        renderer.render(Scene(tracked, stage.placed(box(POLE, GREEN)), replace(illumination, lights=())))
        np.testing.assert_array_equal(picture, renderer.read_bgr())
    if place == (0.1, 0.0, 0.03):
        # Everything on the other side of the model is in its shadow, which has no end.
        in_shadow = inside_px(
            project(tracked.camera, T_cam_marker, [(-0.03, 0.01, 0), (-0.03, -0.01, 0), (-0.2, 0, 0)])
        )
        assert is_shadow[in_shadow > 1].all()
        assert not is_shadow[pixel(tracked, (0.05, -0.04, 0.0))]
    if place == (0.0, 0.0, 20.0):
        assert not is_shadow[beside].any()


@pytest.mark.parametrize("distance_m", [0.12, 0.4, 3.0, 1e4, 1e300])
def test_rays_from_the_lamp_are_parallel_in_its_view(distance_m: float) -> None:
    """And the depth orders what lies on one ray."""
    light = Light(direction_from_angles(0.4, 0.9), inverse_distance=1 / distance_m)
    (lamp,) = lighting_of((light,)).lights
    points = box_corners(np.array([(-0.03, -0.02, 0), (0.03, 0.02, 0.06)]))
    view = view_of(lamp, points)
    assert view is not None
    nearer = points + 0.1 * lamp.towards(points) * min(distance_m, 1.0)
    seen, seen_nearer = view.seen(points), view.seen(nearer)
    np.testing.assert_allclose(seen[:, :2], seen_nearer[:, :2], atol=1e-9)
    assert (seen_nearer[:, 2] > seen[:, 2]).all()


def test_what_is_within_reach_of_the_lamp_has_no_view() -> None:
    points = box_corners(np.array([(-0.03, -0.02, 0), (0.03, 0.02, 0.06)]))
    for place in ((0.0, 0.0, 0.03), (0.0, 0.0, 0.06), (0.03, 0.02, 0.06), (0.0301, 0.0, 0.03)):
        (lamp,) = lighting_of((lamp_at(place),)).lights
        assert view_of(lamp, points) is None
    for place in ((0.0, 0.0, 0.08), (0.06, 0.0, 0.03)):
        (lamp,) = lighting_of((lamp_at(place),)).lights
        assert view_of(lamp, points) is not None


def test_ground_below_a_lamp_that_lies_on_it_is_lit_finitely() -> None:
    lamp = Light((0.3, 0.0, 1e-9), shadow_rgb_ratio=np.array(RATIO), inverse_distance=1 / 0.3)
    lighting = lighting_of((lamp,))
    level = lighting.level_at(np.array([(0.3, 0.0), (0.0, 0.0), (-0.3, 0.0)]))
    np.testing.assert_allclose(level[1:], [[1.0] * 3, [0.2 + 0.8 / 8] * 3])
    assert np.isfinite(level).all()


def test_a_share_measured_at_the_marker_holds_against_a_shadow_elsewhere() -> None:
    lamp = replace(lamp_at((0.2, 0.0, 0.3)), intensity_rgb_ratio=np.array((1.0, 3.0, 0.25)))
    lighting = lighting_of((lamp,), ambient_rgb_ratio=np.full(3, 0.1))
    np.testing.assert_allclose(lighting.lights[0].ground_share, (0.5, 0.75, 0.2))
    np.testing.assert_allclose(lighting.sky, (0.5, 0.25, 0.8))
