"""Following a light with a known body, in pictures painted with a known light."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import TrackedFrame
from ashe_live.light.views.following import follow, has_lost_shadows
from ashe_live.light.views.ground_height import seen_from_ground, seen_from_marker
from tests.light.painted_scenes import BOX, SHADOW_RATIO, Caster
from tests.light.painted_views import painted_from, true_box
from tests.light.synthetic_masks import direction


def seen_from(heading_deg: float, *casters: Caster, **how: Any) -> TrackedFrame:
    return painted_from(heading_deg, *casters, **how).tracked


def known(azimuth_deg: float = 200, elevation_deg: float = 40) -> LightEstimate:
    light = Light(direction(azimuth_deg, elevation_deg), 0.001 * np.eye(2), 0.04, 0.9, shadow_rgb_ratio=SHADOW_RATIO)
    return LightEstimate("proxy", 3, Illumination((light,), real_object=true_box()))


@pytest.mark.parametrize("ground", ["plain", "bricks"])
@pytest.mark.parametrize("heading_deg", [90, 120])
@pytest.mark.parametrize("turned_deg", [0, 6, -6])
def test_the_light_is_followed(ground: str, heading_deg: float, turned_deg: float) -> None:
    tracked = seen_from(heading_deg, BOX, ground=ground, azimuth_deg=200 + turned_deg)
    found = follow(known(), tracked)
    assert found is not None
    assert found.light is not None
    truth = direction(200 + turned_deg, 40)
    assert math.degrees(angle_between(found.light.to_light_marker, truth)) < 1.0
    assert found.frame_index == found.views[0] == tracked.frame.index
    np.testing.assert_allclose(found.light.covariance_rad2, known().light.covariance_rad2, atol=1e-15)


@pytest.mark.parametrize("heading_deg", [60, 90, 120])
def test_a_body_below_the_markers_plane_stands_on_a_plane_of_its_own(heading_deg: float) -> None:
    card_m = 0.01
    estimate = known()
    lowered = dataclasses.replace(estimate, illumination=seen_from_marker(estimate.illumination, card_m))
    found = follow(lowered, seen_from_ground(seen_from(heading_deg, BOX, ground="bricks"), -card_m))
    assert found is not None
    assert found.light is not None
    assert math.degrees(angle_between(found.light.to_light_marker, direction(200, 40))) < 1.0
    assert found.illumination.real_object is not None
    assert found.illumination.real_object.points_marker()[:, 2].min() == pytest.approx(-card_m)


@pytest.mark.parametrize("farther_m", [-0.04, 0.04])
def test_a_lamp_is_followed_at_its_height(farther_m: float) -> None:
    at_m = np.array([-0.25, -0.1, 0.35])
    before_m = at_m * (1 + farther_m / 0.25, 1 + farther_m / 0.25, 1)
    distance_m = float(np.linalg.norm(before_m))
    estimate = known()
    lamp = dataclasses.replace(
        estimate.light, to_light_marker=before_m, inverse_distance=1 / distance_m, intensity_rgb_ratio=np.full(3, 2.0)
    ).with_angular_size(0.05)
    estimate = dataclasses.replace(estimate, illumination=dataclasses.replace(estimate.illumination, lights=(lamp,)))
    found = follow(estimate, seen_from(90, BOX, lamp_m=at_m))
    assert found is not None
    assert found.light is not None
    assert found.light.position_marker_m is not None
    assert found.light.position_marker_m[2] == pytest.approx(at_m[2], rel=1e-6)
    assert np.linalg.norm(found.light.position_marker_m - at_m) < 0.01 < np.linalg.norm(before_m - at_m)
    # Of its light, which falls by the square of the distance and by the cosine; and how large it looks from there.
    received = [each.to_light_marker[2] * each.inverse_distance**2 for each in (lamp, found.light)]
    assert found.light.intensity_rgb_ratio == pytest.approx(np.full(3, 2.0 * received[1] / received[0]))
    assert math.tan(found.light.angular_size_rad / 2) == pytest.approx(lamp.radius_m * found.light.inverse_distance)


def test_a_light_that_is_elsewhere_is_not_followed() -> None:
    assert follow(known(), seen_from(90, BOX, azimuth_deg=300)) is None


def test_an_object_that_is_gone_is_not_followed() -> None:
    assert follow(known(), seen_from(90)) is None


@pytest.mark.parametrize("ground", ["plain", "bricks"])
@pytest.mark.parametrize("heading_deg", [60, 90, 120])
def test_shadows_are_gone_where_the_body_stands_without_them(ground: str, heading_deg: float) -> None:
    def shown(*casters: Caster, **rest) -> bool:
        return has_lost_shadows(known(), seen_from(heading_deg, *casters, ground=ground, **rest))

    assert shown(BOX, elevation_deg=89.9)
    assert not shown(BOX)
    assert not shown(BOX, azimuth_deg=205)
    assert not shown(), "who takes the body away does not switch off the light"


@pytest.mark.parametrize("elevation_deg", [40.0, 89.9])
def test_a_body_that_carries_the_marker_stands_there_and_its_shadow_may_be_gone(elevation_deg: float) -> None:
    tracked = seen_from(90, BOX, ground="bricks", elevation_deg=elevation_deg)
    assert tracked.marker is not None
    marker = dataclasses.replace(tracked.marker, body=known().illumination.real_object)
    assert has_lost_shadows(known(), dataclasses.replace(tracked, marker=marker)) is (elevation_deg > 80)


def test_a_body_that_carries_the_marker_is_not_followed_however_many_lights_it_has() -> None:
    tracked = seen_from(90, BOX, ground="bricks")
    assert tracked.marker is not None
    carried = dataclasses.replace(tracked, marker=dataclasses.replace(tracked.marker, body=true_box()))
    for count in (1, 2, 3):
        lights = tuple(known(azimuth_deg).lights[0] for azimuth_deg in (200, 300, 60)[:count])
        assert follow(LightEstimate("proxy", 3, Illumination(lights, real_object=true_box())), carried) is None


def test_nothing_to_follow_is_nothing() -> None:
    tracked = seen_from(90, BOX)
    assert follow(known(), dataclasses.replace(tracked, marker=None)) is None
    assert follow(LightEstimate("proxy", 0, Illumination(), "no shadow found"), tracked) is None
    bodiless = dataclasses.replace(known(), illumination=dataclasses.replace(known().illumination, real_object=None))
    assert follow(bodiless, tracked) is None
    assert not has_lost_shadows(bodiless, tracked)
    assert not has_lost_shadows(known(), dataclasses.replace(tracked, marker=None))
    assert not has_lost_shadows(LightEstimate("proxy", 0, Illumination(), "no shadow found"), tracked)
