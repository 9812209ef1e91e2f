"""Consecutive estimates become one answer, which follows the light and not the outliers."""

import math

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between, direction_from_angles, radius_of_68_percent, tangent_basis
from ashe_live.core.types import Illumination, Light, LightEstimate
from ashe_live.light.live.fusion import CHANGED_AFTER, MEMBERS, LightFusion, agree, fused

SUN = direction_from_angles(0.7, 0.8)
LAMP = direction_from_angles(3.0, 0.6)
NONE = LightEstimate("test", 0, Illumination(), "no shadow found")


def turned(direction, east_deg: float, up_deg: float):
    return direction + np.radians([east_deg, up_deg]) @ tangent_basis(direction)


def light(direction, sigmas_deg=(2.0, 2.0), confidence=0.8, depth: float = 0.4) -> Light:
    return Light(direction, np.diag(np.radians(sigmas_deg) ** 2), None, confidence, shadow_rgb_ratio=np.full(3, depth))


def estimate(*lights: Light) -> LightEstimate:
    return LightEstimate("test", 0, Illumination(lights))


def fusion_of(*estimates: LightEstimate) -> LightFusion:
    fusion = LightFusion()
    for each in estimates:
        fusion.add(each)
    return fusion


def error_deg(fusion: LightFusion, truth) -> float:
    return math.degrees(angle_between(fusion.answer.light.to_light_marker, truth))


def test_the_mean_of_many_is_nearer_to_the_truth():
    rng = np.random.default_rng(3)
    alone, together = [], []
    for _ in range(30):
        seen = [turned(SUN, *rng.normal(0, 2, 2)) for _ in range(MEMBERS)]
        alone.append(math.degrees(angle_between(seen[-1], SUN)))
        together.append(error_deg(fusion_of(*(estimate(light(each)) for each in seen)), SUN))
    assert np.mean(together) < 0.6 * np.mean(alone)


def test_each_axis_comes_from_those_who_know_it():
    a, b = light(turned(SUN, 4, 0), (8.0, 0.5)), light(turned(SUN, 0, 4), (0.5, 8.0))
    answer = fused([estimate(a), estimate(b)]).light
    assert math.degrees(angle_between(answer.to_light_marker, SUN)) < 0.35  # parallels are no great circles
    assert np.degrees(np.sqrt(np.diag(answer.covariance_rad2))) == pytest.approx([0.7, 0.7], abs=0.02)


def test_confidence_weighs():
    sure, doubtful = estimate(light(turned(SUN, 3, 0), confidence=0.9)), estimate(light(SUN, confidence=0.3))
    answer = fused([sure, doubtful]).light
    assert math.degrees(angle_between(answer.to_light_marker, SUN)) == pytest.approx(3 * 0.75, abs=0.02)


def test_saying_the_same_again_makes_nobody_surer():
    one = estimate(light(SUN, (1.0, 5.0)))
    answer = fused([one] * 5).light
    assert answer.covariance_rad2 == pytest.approx(one.light.covariance_rad2)
    assert answer.confidence == pytest.approx(0.8)
    assert angle_between(answer.to_light_marker, SUN) < 1e-9


def test_watching_on_makes_nobody_less_sure():
    """Vague and doubtful answers beside a sharp one hardly widen it, and take nothing of its confidence."""
    sharp = estimate(light(SUN, (1.0, 1.0), confidence=0.9))
    vague = [estimate(light(turned(SUN, 1, 0), (4.0, 6.0), confidence=share)) for share in (0.4, 0.5, 0.6)]
    for count in range(1, 4):
        answer = fused([*vague[:count], sharp]).light
        assert answer.confidence == 0.9
        assert answer.sigma_rad < 1.1 * radius_of_68_percent(sharp.light.covariance_rad2)


def test_azimuths_on_both_sides_of_the_zenith_meet_there():
    around = [estimate(light(direction_from_angles(azimuth, math.radians(88)))) for azimuth in (0, 1.57, 3.14, 4.71)]
    assert all(agree(around[0], each) for each in around)
    assert fused(around).light.elevation_deg > 89.9


def test_an_outlier_changes_nothing():
    fusion = fusion_of(*[estimate(light(SUN))] * 3)
    before = fusion.answer
    for outlier in (estimate(light(LAMP, confidence=0.95)), NONE):
        assert not fusion.add(outlier)
        assert fusion.answer is before
    assert fusion.add(estimate(light(SUN)))
    assert error_deg(fusion, SUN) < 1e-6


def test_a_doubtful_first_answer_gives_way_at_once_to_a_surer_one():
    fusion = fusion_of(estimate(light(LAMP, confidence=0.3)), estimate(light(SUN, confidence=0.8)))
    assert error_deg(fusion, SUN) < 1e-6
    assert error_deg(fusion_of(NONE, estimate(light(SUN, confidence=0.3))), SUN) < 1e-6


@pytest.mark.parametrize(
    "other",
    [estimate(light(LAMP)), estimate(light(SUN), light(LAMP)), estimate(light(SUN, depth=0.75)), NONE],
    ids=["another lamp", "a second lamp", "a thin cloud", "a thick cloud"],
)
def test_another_light_is_believed_after_a_few_estimates_and_nothing_is_left_of_the_old_one(other):
    fusion = fusion_of(*[estimate(light(SUN))] * MEMBERS)
    assert [fusion.add(other) for _ in range(CHANGED_AFTER)] == [False] * (CHANGED_AFTER - 1) + [True]
    assert fusion.count == CHANGED_AFTER
    assert agree(fusion.answer, other)
    assert not agree(fusion.answer, estimate(light(SUN)))


def test_outliers_that_contradict_each_other_are_never_believed():
    fusion = fusion_of(*[estimate(light(SUN))] * MEMBERS)
    for azimuth in range(6):
        fusion.add(estimate(light(direction_from_angles(float(azimuth), 0.3))))
    assert error_deg(fusion, SUN) < 1e-6


def test_two_lights_are_told_apart_whichever_seems_stronger():
    swapped = [estimate(light(SUN), light(LAMP)), estimate(light(LAMP), light(SUN))] * 3
    fusion = fusion_of(*swapped)
    assert fusion.count == len(swapped)
    (first, second) = fusion.answer.lights
    assert angle_between(first.to_light_marker, LAMP) < 1e-6
    assert angle_between(second.to_light_marker, SUN) < 1e-6


def test_a_slow_sun_is_followed():
    fusion = LightFusion()
    for step in range(60):
        now = direction_from_angles(0.7 + math.radians(step), 0.8)
        assert fusion.add(estimate(light(now)))
        assert error_deg(fusion, now) < MEMBERS / 2


def test_an_estimator_that_tells_no_uncertainty_is_averaged_alike():
    plain = [LightEstimate("test", 0, Illumination((Light(turned(SUN, side, 0)),))) for side in (-2, 2)]
    answer = fused(plain).light
    assert math.degrees(angle_between(answer.to_light_marker, SUN)) < 1e-2
    assert answer.covariance_rad2 is answer.sigma_rad is answer.confidence is None


def test_of_nothing_there_is_no_answer():
    assert LightFusion().answer is None
    with pytest.raises(ValueError, match="nothing to fuse"):
        fused([])
