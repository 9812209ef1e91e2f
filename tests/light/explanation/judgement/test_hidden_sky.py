"""Ground beside a ball, whose share of the sky is known in closed form, in a light and without one."""

from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Camera
from ashe_live.core.colour import srgb_from_linear
from ashe_live.core.proxy import Proxy
from ashe_live.core.square import square_corners
from ashe_live.core.transforms import project, raycast_to_plane
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.explanation.judgement.hidden_sky import Depth, depths_beyond_sky, is_of_sky_alone
from ashe_live.light.pixels.view import View
from tests.light.synthetic_masks import camera_towards, direction

SIDE_M, RADIUS_M = 0.08, 0.03
PLACE = np.array((0.13, 0.02))
BALL = Proxy("ball", np.array([[*PLACE, RADIUS_M, RADIUS_M, RADIUS_M]]))
SKY = 0.3  # of the light on open ground
STRIPE_M = 0.04


def pixels() -> Float:
    """(n, 2) of the picture, row by row."""
    return np.column_stack([each.ravel() for each in np.mgrid[0:360, 0:480][::-1]]).astype(float)


def view(
    lit: float, elevation_deg: float, azimuth_deg: float = 200.0, towards=(0.08, 0.0), stripes_at_m: float | None = None
) -> View:
    """The ball on a grey table under an even sky and a sun, which gives `lit` of the light on open ground.

    stripes_at_m: where dark stripes of the table begin, as broad as what is between them; None for no stripes.
    """
    camera, T = Camera.from_hfov((480, 360), 60.0), camera_towards(towards, 0.45, 50.0, 80.0)
    ground = raycast_to_plane(camera, T, pixels())[:, :2]
    away = np.hypot(np.linalg.norm(ground - PLACE, axis=1), RADIUS_M)
    # A sphere that rests on a plane hides (r/d)^3 of the light of an even sky from a point of it: the sine of its
    # angular radius, squared, times the cosine of its middle's zenith angle.
    light = SKY * (1 - (RADIUS_M / away) ** 3)
    to_light = direction(azimuth_deg, elevation_deg)
    middle = np.array((*PLACE, RADIUS_M)) - np.column_stack([ground, np.zeros(len(ground))])
    past = np.linalg.norm(middle - (middle @ to_light)[:, None] * to_light, axis=1)
    light += lit * ~((past < RADIUS_M) & (middle @ to_light > 0))
    if stripes_at_m is not None:
        light *= np.where((ground[:, 0] - stripes_at_m) % (2 * STRIPE_M) < STRIPE_M, 0.15, 1.0)
    picture = 255 * srgb_from_linear(np.clip(0.6 * light, 0, 1)).reshape(360, 480, 1).repeat(3, axis=2)
    picture += np.random.default_rng(1).normal(0, 1.5, picture.shape)
    frame = Frame(np.clip(np.round(picture), 0, 255).astype(np.uint8), 0, 0.0)
    corners = project(camera, T, square_corners(SIDE_M))
    return View.of(TrackedFrame(frame, camera, MarkerPose(T, corners, SIDE_M, 0.0, None)), 640)


@pytest.mark.parametrize("elevation_deg", [30, 50, 65])
@pytest.mark.parametrize("lit", [0.2, 0.5])
def test_a_shadow_is_deeper_than_the_sky_that_is_hidden_by_what_its_light_gives(elevation_deg: int, lit: float) -> None:
    light = np.array([[*direction(200, elevation_deg), 0.0]])
    (depth,) = depths_beyond_sky(view(lit, elevation_deg), BALL, light)
    # Where most of the sky is in view, and a little more where less of it is.
    assert np.log(1 + lit / SKY) - 0.1 < depth.value < np.log(1 + lit / (0.6 * SKY)) + 0.1
    assert not is_of_sky_alone([depth], [np.log(1 + lit / SKY)])


@pytest.mark.parametrize("elevation_deg", [30, 50, 65, 80])
@pytest.mark.parametrize("azimuth_deg", [20, 140, 200, 290])
def test_under_the_sky_alone_no_shadow_is_deeper_than_that(elevation_deg: int, azimuth_deg: int) -> None:
    light = np.array([[*direction(azimuth_deg, elevation_deg), 0.0]])
    depths = depths_beyond_sky(view(0.0, elevation_deg), BALL, light)
    if depths[0] is not None:  # behind the ball no shadow is seen
        assert abs(depths[0].value) < 0.1
        assert depths[0].sigma < 0.08
        assert is_of_sky_alone(depths, [0.5])
    assert azimuth_deg != 200 or elevation_deg == 80 or depths[0] is not None


def test_each_of_two_lights_has_a_depth_of_its_own() -> None:
    lights = np.array([[*direction(200, 40), 0.0], [*direction(120, 50), 0.0]])
    first, second = depths_beyond_sky(view(0.5, 40), BALL, lights)
    assert first.value > 0.8
    assert abs(second.value) < 0.15
    assert not is_of_sky_alone([first, second], [0.9, 0.9])


def test_what_is_not_in_view_is_not_known() -> None:
    light = np.array([[*direction(200, 40), 0.0]])
    assert depths_beyond_sky(view(0.5, 40, towards=(-0.6, 0.0)), BALL, light) == [None]
    assert not is_of_sky_alone([None], [0.5])
    assert is_of_sky_alone([None, Depth(0.05, 0.0)], [0.5, 0.5])


def test_of_a_shadow_that_is_too_small_nothing_is_known() -> None:
    speck = Proxy("ball", np.array([[*PLACE, 0.001, 0.001, 0.001]]))
    assert depths_beyond_sky(view(0.5, 40), speck, np.array([[*direction(200, 40), 0.0]])) == [None]


def test_only_ground_near_the_body_is_compared() -> None:
    light, whole = np.array([[*direction(200, 40), 0.0]]), view(0.5, 40)
    ground = raycast_to_plane(whole.camera, whole.T_cam_marker, pixels())[:, :2]
    far = np.linalg.norm(ground - PLACE, axis=1).reshape(360, 480) > 7 * RADIUS_M
    assert far.mean() > 0.3
    dark = replace(whole, image_bgr=np.where(far[..., None], 5, whole.image_bgr).astype(np.uint8))
    assert depths_beyond_sky(dark, BALL, light) == depths_beyond_sky(whole, BALL, light)


def test_a_dark_thing_that_stands_beside_is_no_pattern() -> None:
    light, plain = np.array([[*direction(200, 80), 0.0]]), view(0.0, 80)
    ground = raycast_to_plane(plain.camera, plain.T_cam_marker, pixels())[:, :2].reshape(360, 480, 2)
    thing = np.abs(ground - PLACE - (2.5 * RADIUS_M, 0.0)).max(axis=2) < 1.2 * RADIUS_M
    beside = replace(plain, image_bgr=np.where(thing[..., None], 5, plain.image_bgr).astype(np.uint8))
    assert is_of_sky_alone(depths_beyond_sky(beside, BALL, light), [0.5])


@pytest.mark.parametrize("times", [0.2, 1.0, 5.0])
def test_what_is_left_of_a_shadow_counts_beside_what_it_seems_and_what_a_pattern_may_hide(times: float) -> None:
    def is_sky(value: float, sigma: float) -> bool:
        return is_of_sky_alone([Depth(times * value, times * sigma)], [times * 0.5])

    assert is_sky(0.1, 0.0)
    assert not is_sky(0.25, 0.0)
    assert is_sky(0.1, 0.15)
    assert not is_sky(0.1, 0.25)  # its 0.4 that are missing may be on brighter ground


@pytest.mark.parametrize("stripes_at_m", np.linspace(0, 2 * STRIPE_M, 8, endpoint=False))
def test_a_shadow_on_the_brighter_part_of_a_pattern_is_one(stripes_at_m: float) -> None:
    """There it is no darker than other ground, most of which may be dark."""
    light = np.array([[*direction(200, 40), 0.0]])
    seeming = [np.log(1 + 0.5 / SKY)]
    assert not is_of_sky_alone(depths_beyond_sky(view(0.5, 40, stripes_at_m=stripes_at_m), BALL, light), seeming)
