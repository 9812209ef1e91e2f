"""The virtual light moves over to a new illumination, and stays there."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.light import Illumination, Light
from ashe_live.core.transforms import angle_between, direction_from_angles
from ashe_live.quality import FAST
from ashe_live.render.lights.lighting import angular_size, lighting_of
from ashe_live.render.lights.photometry import Photometry
from ashe_live.viewer.estimates.easing import EASED_OVER_S, LightEasing
from tests.render.lights.test_photometry import CARTON, GROUND, RATIO, seen

SUN = direction_from_angles(0.7, 0.8)
NONE = Illumination()
STEPS = np.linspace(0, 1.01 * EASED_OVER_S, 31)


def lit_from(*directions, depth: float = 0.4) -> Illumination:
    ratio = np.full(3, depth)
    lights = tuple(Light(direction, shadow_rgb_ratio=ratio) for direction in directions)
    return Illumination(lights, ambient_rgb_ratio=np.maximum(0, 1 - len(lights) * (1 - ratio)))


def passage(start: Illumination, end: Illumination) -> list[Illumination]:
    easing = LightEasing()
    easing.jump(start)
    return [easing.at(end, 5.0 + step) for step in STEPS]


def test_it_turns_without_a_jump_and_ends_at_the_illumination_itself():
    end = lit_from(direction_from_angles(1.5, 0.5))
    directions = [shown.light.to_light_marker for shown in passage(lit_from(SUN), end)]
    whole = angle_between(directions[0], directions[-1])
    assert angle_between(directions[0], SUN) < 1e-9
    steps = [angle_between(a, b) for a, b in itertools.pairwise(directions)]
    assert max(steps) < 0.1 * whole
    assert sum(steps) == pytest.approx(whole, rel=1e-6)
    easing = LightEasing()
    easing.jump(lit_from(SUN))
    easing.at(end, 0.0)
    assert easing.at(end, EASED_OVER_S) is end


@pytest.mark.parametrize("start", [NONE, Illumination(ambient_rgb_ratio=np.full(3, 0.3))])
def test_a_first_light_comes_up_and_one_that_is_gone_goes_down(start):
    lit = lit_from(SUN)
    up = [lighting_of(shown.lights, shown.ambient_rgb_ratio).sky[0] for shown in passage(start, lit)]
    down = [lighting_of(shown.lights, shown.ambient_rgb_ratio).sky[0] for shown in passage(lit, NONE)]
    for skies in (up, down[::-1]):
        assert (skies[0], skies[-1]) == pytest.approx((1.0, 0.4))
        assert max(a - b for a, b in itertools.pairwise(skies)) < 0.1
        assert all(a >= b for a, b in itertools.pairwise(skies))


MEASURED = lit_from(SUN)
LAMP = Light(
    direction_from_angles(1.2, 0.6),
    shadow_rgb_ratio=np.full(3, 0.5),
    inverse_distance=2.0,
    intensity_rgb_ratio=np.full(3, 3.0),
)
LIT = {
    "none": NONE,
    "sun": MEASURED,
    "lamp by its intensity": Illumination((LAMP,), ambient_rgb_ratio=np.full(3, 0.5)),
    "two that nobody measured": Illumination((Light(SUN), Light(direction_from_angles(3.0, 0.6)))),
    "sky that contradicts the shadow": replace(MEASURED, ambient_rgb_ratio=np.full(3, 0.7)),
    "lamp below the table": replace(MEASURED, lights=(replace(LAMP, to_light_marker=(0.5, 0.0, -0.2)), MEASURED.light)),
}


@pytest.mark.parametrize(("start", "end"), list(itertools.permutations(LIT, 2)))
def test_the_shares_of_sky_and_lights_change_without_a_jump(start: str, end: str):
    shown = [LIT[start], *passage(LIT[start], LIT[end])]
    drawn = [lighting_of(each.lights, each.ambient_rgb_ratio) for each in shown]
    skies, lit = (
        np.array(each) for each in ([each.sky[0] for each in drawn], [each.ground_shares.sum() for each in drawn])
    )
    for values in (skies, lit / 3):
        assert np.abs(np.diff(values)).max() < 0.06
    np.testing.assert_allclose(skies + lit / 3, 1, atol=1e-6)


def test_far_away_it_does_not_swing_through_the_room():
    other = direction_from_angles(0.7 + math.pi, 0.8)
    for shown in passage(lit_from(SUN), lit_from(other)):
        for light in shown.lights:
            assert min(angle_between(light.to_light_marker, each) for each in (SUN, other)) < 1e-9


def test_with_two_lights_each_goes_to_the_nearest():
    lamp, turned = direction_from_angles(3.0, 0.6), direction_from_angles(0.8, 0.8)
    halfway = passage(lit_from(SUN, lamp), lit_from(lamp, turned))[15]
    assert angle_between(halfway.lights[0].to_light_marker, lamp) < 1e-9
    assert angle_between(SUN, turned) > angle_between(halfway.lights[1].to_light_marker, SUN) > 0


def test_a_new_target_on_the_way_starts_from_what_is_shown():
    easing = LightEasing()
    easing.jump(lit_from(SUN))
    away = lit_from(direction_from_angles(1.5, 0.5))
    easing.at(away, 0.0)
    seen = easing.at(away, EASED_OVER_S / 2).light.to_light_marker
    back = easing.at(lit_from(SUN), EASED_OVER_S / 2).light.to_light_marker
    assert angle_between(seen, back) < 1e-9


def test_what_is_shown_at_once_stays_though_another_was_on_its_way():
    easing, end = LightEasing(), lit_from(direction_from_angles(1.5, 0.5))
    easing.jump(lit_from(SUN))
    easing.at(end, 0.0)
    assert easing.jump(end) is end
    assert easing.at(end, EASED_OVER_S / 3) is end


def test_without_any_light_nothing_is_on_its_way():
    assert LightEasing().at(NONE, 0.0).lights == ()


def test_on_the_way_only_what_changes_is_a_new_array():
    """What is drawn once for a ground colour is known by its identity."""
    end = replace(lit_from(SUN), ground_rgb=np.full(3, 0.4))
    for shown in passage(NONE, end):
        assert shown.ground_rgb is end.ground_rgb
        assert shown.sky_slope_rgb is None


@pytest.mark.parametrize("radius_m", [None, 0.02])
def test_a_sun_comes_nearer_until_it_is_the_lamp(radius_m):
    """Its inverse distance and the size that is seen change in small steps of one sign."""
    turned = direction_from_angles(0.9, 0.7)
    lamp = Light(turned, shadow_rgb_ratio=np.full(3, 0.4), inverse_distance=2.5, radius_m=radius_m)
    for start, end in ((lit_from(SUN), Illumination((lamp,))), (Illumination((lamp,)), lit_from(SUN))):
        lights = [shown.light for shown in passage(start, end)]
        inverse = np.array([light.inverse_distance for light in lights])
        sizes = np.array([angular_size(light) for light in lights])
        assert inverse[0] == start.light.inverse_distance
        assert lights[-1] is end.light
        for values in (inverse, sizes):
            steps = np.diff(values) * np.sign(values[-1] - values[0])
            assert (steps >= -1e-12).all()
            assert steps.max() < 0.1 * abs(values[-1] - values[0])
        # Both ends are seen as they are by themselves.
        assert sizes[0] == pytest.approx(angular_size(start.light))


def test_a_lamp_whose_share_was_measured_at_the_marker_fades_by_it():
    lamp = Light(SUN, shadow_rgb_ratio=np.full(3, 0.9), inverse_distance=2.0, intensity_rgb_ratio=np.full(3, 3.0))
    shares = [lighting_of(shown.lights).lights[0].ground_share[0] for shown in passage(NONE, Illumination((lamp,)))]
    assert (shares[0], shares[-1]) == pytest.approx((0.0, 0.75))
    assert max(np.diff(shares)) < 0.1


def test_a_sky_leans_over_without_a_jump():
    lit = lit_from(SUN)
    leaning = replace(lit, sky_slope_rgb=np.full((2, 3), 0.1))
    for start, end, ends in ((lit, leaning, (0.0, 0.1)), (leaning, lit, (0.1, 0.0))):
        slopes = [shown.sky_slope_rgb for shown in passage(start, end)]
        values = [0.0 if each is None else float(each[0, 0]) for each in slopes]
        assert (values[0], values[-1]) == ends
        assert np.abs(np.diff(values)).max() < 0.02
    assert slopes[-1] is None


def test_on_the_way_the_picture_is_read_as_it_is_lit():
    """At first the light stands behind a carton, whose shadow is not on the marker in the picture."""
    end = Illumination((Light((0.0, 0.2, 0.9), shadow_rgb_ratio=RATIO),), RATIO, GROUND, CARTON, seen())
    behind = replace(end, lights=(Light((0.6, 0.0, 0.4), shadow_rgb_ratio=RATIO),))
    shown = passage(behind, end)[1:]
    photometry = Photometry(FAST.render)
    assert {photometry.white_seen_in(each) for each in shown} == {photometry.white_seen_in(end)}
    skies = np.array([photometry.lighting(each).sky for each in shown])
    assert np.abs(np.diff(skies, axis=0)).max() < 0.01
    assert photometry.lighting(shown[-1]) is photometry.lighting(end)
