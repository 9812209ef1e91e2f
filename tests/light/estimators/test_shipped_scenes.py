"""The estimator on the repository's own scenes: grounds with patterns, penumbrae, contact shadows, noise and JPEG."""

from dataclasses import replace

import numpy as np

from ashe_live.core.transforms import angle_between, normalised
from ashe_live.light.estimators.preset import FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.judgement.judge import likeliest_direction
from ashe_live.light.lamps.kinds import SUN
from tests.shipped_scenes import CASES, LIT


def test_answers_are_right_or_do_not_claim_to_be_and_most_are_good() -> None:
    errors, too_sure = [], []
    for name in LIT:
        case = CASES[name]
        assert case.to_lights_marker is not None
        light = ProxyEstimator().estimate(case.tracked()).light
        if light is None:
            continue
        errors.append(angle_between(light.to_light_marker, case.to_lights_marker[0]))
        assert light.sigma_rad is not None
        if min(angle_between(light.to_light_marker, true) for true in case.to_lights_marker) > 3 * light.sigma_rad:
            too_sure.append(name)
    assert not too_sure
    assert len(errors) >= 0.75 * len(LIT)
    assert np.degrees(np.median(errors)) < 2


def test_diffuse_light_has_no_direction() -> None:
    assert ProxyEstimator().estimate(CASES["diffuse_cylinder"].tracked()).light is None


def test_a_sun_is_stated_in_the_mean_direction_of_all_that_explain_it() -> None:
    estimate, trace = ProxyEstimator(replace(FAST, light=SUN)).traced(CASES["high_box"].tracked())
    probabilities = np.array(trace.probabilities)
    alike, _ = likeliest_direction(probabilities, [each.to_light_from_body for each in trace.judged])
    directions = np.array([each.lights[0].to_light_marker for each in trace.judged])
    mean, likeliest = normalised((alike * probabilities) @ directions), directions[probabilities.argmax()]
    assert estimate.light is not None
    assert np.degrees(angle_between(estimate.light.to_light_marker, mean)) < 0.01
    assert np.degrees(angle_between(estimate.light.to_light_marker, likeliest)) > 0.05
