"""How far a fit is believed: probabilities, what they fall with, and the radius that holds the truth."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.proxy import Proxy
from ashe_live.core.types import DirectionalLight
from ashe_live.light.associate import Split
from ashe_live.light.fit import Fit, FittedLight
from ashe_live.light.judge import Candidate, confidence_in, evidence, judged

DAYLIGHT_SHIFT = np.array([-1.3, -0.5, 0.12])  # darker and bluer
TO_LIGHT = np.array([0.5, 0.3, 0.8])


def covariance(larger_deg: float, smaller_deg: float, turn_rad: float = 0.4) -> Float:
    axes = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    return axes @ np.diag(np.radians([larger_deg, smaller_deg]) ** 2) @ axes.T


def candidate(residual_px: float = 0.3, covariance_rad2: Float | None = None, rank: int = 0, **changes) -> Candidate:
    body, shadow = np.zeros((2, 60, 80), bool)
    body[10:40, 20:40] = True
    shadow[30:45, 40:70] = True
    spread = covariance(1.0, 0.7) if covariance_rad2 is None else covariance_rad2
    fit = Fit(
        (FittedLight(TO_LIGHT, spread),), Proxy("ball", np.array([[0, 0, 0.03, 0.03, 0.03]])), residual_px, 24.5, {}
    )
    split = dataclasses.replace(Split(body, shadow, DAYLIGHT_SHIFT), **changes)
    return Candidate(split, fit, rank)


def test_a_good_fit_is_believed_and_told_as_it_is():
    light = judged(candidate())
    assert isinstance(light, DirectionalLight)
    assert light.confidence == confidence_in(candidate()) > 0.8
    np.testing.assert_allclose(light.to_light_marker, TO_LIGHT / np.linalg.norm(TO_LIGHT))
    np.testing.assert_array_equal(light.covariance_rad2, covariance(1.0, 0.7))


def test_confidence_falls_as_the_outlines_fit_worse():
    confidences = [confidence_in(candidate(residual_px)) for residual_px in (0.2, 0.5, 1, 2, 5, 20)]
    assert (np.diff(confidences) < 0).all()


def test_confidence_falls_as_the_direction_is_less_certain():
    confidences = [confidence_in(candidate(covariance_rad2=covariance(deg, 0.5))) for deg in (1, 2, 5, 10, 40)]
    assert (np.diff(confidences) < 0).all()


def test_confidence_falls_with_less_voted_for_shifts():
    assert confidence_in(candidate(rank=2)) < confidence_in(candidate(rank=0))


def test_a_shadow_of_another_colour_than_daylights_is_less_believed():
    green = candidate(shift=np.array([-1.3, -0.5, 0.7]))
    assert confidence_in(green) < confidence_in(candidate())


@pytest.mark.parametrize("residual_px", [0.0, 1e-12, 0.3, 1e3, 1e9])
@pytest.mark.parametrize("spread_deg", [0.0, 1e-9, 1.0, 60.0, 1e6])
def test_confidence_is_a_probability_at_the_extremes(residual_px, spread_deg):
    extreme = candidate(residual_px, covariance(spread_deg, 0.0), rank=50)
    assert np.isfinite(evidence(extreme)).all()
    assert 0 <= confidence_in(extreme) <= 1
    verdict = judged(extreme)
    assert verdict if isinstance(verdict, str) else np.isfinite(verdict.sigma_rad)


def test_what_is_not_believed_is_no_light_but_a_reason():
    hopeless = candidate(residual_px=30.0, covariance_rad2=covariance(60, 40), rank=3)
    verdict = judged(hopeless)
    assert isinstance(verdict, str)
    assert len(verdict.split()) > 3


def held_by(radius: float, deviations: tuple[float, float]) -> float:
    """The probability that a normal sample lies within `radius`: over the angle, the radial part is exponential."""
    angles = np.linspace(0, np.pi, 20_001)[:-1] + 1e-5
    along = (deviations[0] * np.cos(angles)) ** 2 + (deviations[1] * np.sin(angles)) ** 2
    return float(1 - np.exp(-0.5 * radius**2 / along).mean())


@pytest.mark.parametrize("turn_rad", [0.0, 1.1])
@pytest.mark.parametrize("share", [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0])
def test_sigma_holds_the_truth_with_probability_68_percent(share, turn_rad):
    light = judged(candidate(covariance_rad2=covariance(2.0, 2.0 * share, turn_rad)))
    assert isinstance(light, DirectionalLight)
    deviations = np.radians(2.0), np.radians(2.0 * share)
    assert held_by(light.sigma_rad / 1.01, deviations) < 0.68 < held_by(light.sigma_rad * 1.01, deviations)
