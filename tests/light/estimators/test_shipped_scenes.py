"""The estimator on the repository's own scenes: grounds with patterns, penumbrae, contact shadows, noise and JPEG."""

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.proxy import ProxyEstimator
from tests.shipped_scenes import CASES, LIT


@pytest.mark.parametrize("name", LIT)
def test_an_answer_is_right_or_does_not_claim_to_be(name: str) -> None:
    case = CASES[name]
    assert case.to_lights_marker is not None
    light = ProxyEstimator().estimate(case.tracked()).light
    if light is None:
        return
    error_rad = min(angle_between(light.to_light_marker, true) for true in case.to_lights_marker)
    assert light.sigma_rad is not None
    assert error_rad < 3 * light.sigma_rad


def test_most_are_answered_well() -> None:
    errors = []
    for name in LIT:
        case = CASES[name]
        assert case.to_lights_marker is not None
        light = ProxyEstimator().estimate(case.tracked()).light
        if light is not None:
            errors.append(np.degrees(angle_between(light.to_light_marker, case.to_lights_marker[0])))
    assert len(errors) >= 0.75 * len(LIT)
    assert np.median(errors) < 2


def test_diffuse_light_has_no_direction() -> None:
    assert ProxyEstimator().estimate(CASES["diffuse_cylinder"].tracked()).light is None
