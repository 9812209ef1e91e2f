"""How wrong an answer is, and how honest."""

import math

import numpy as np
import pytest

from ashe_live.bench.metrics import (
    angular_error_deg,
    brier_score,
    calibration_error,
    largest,
    mean,
    median,
    overlap,
    percentile,
    risk_at,
    risk_by_coverage,
    rms_deg,
    share,
    squared_sigmas,
)
from ashe_live.core.transforms import ELLIPSE_95, direction_from_angles, tangent_basis


def test_the_error_is_the_angle_whatever_the_lengths():
    assert angular_error_deg((1, 0, 0), (0, 2, 0)) == pytest.approx(90)
    assert angular_error_deg((0, 0, 3), (0, 0, 1)) == 0
    assert angular_error_deg((1, 0, 0), (-1, 0, 0)) == pytest.approx(180)


def test_a_long_ellipse_forgives_along_its_length_only():
    answer = direction_from_angles(1.0, 0.6)
    covariance = np.diag([math.radians(1) ** 2, math.radians(4) ** 2])  # azimuth, elevation
    higher = direction_from_angles(1.0, 0.6 + math.radians(6))
    aside = answer * math.cos(math.radians(6)) + tangent_basis(answer)[0] * math.sin(math.radians(6))
    assert squared_sigmas(answer, covariance, higher) == pytest.approx(1.5**2)
    assert squared_sigmas(answer, covariance, aside) == pytest.approx(6**2)
    assert squared_sigmas(answer, covariance, answer) == pytest.approx(0, abs=1e-12)
    assert squared_sigmas(answer, covariance, -answer) > 40**2


def test_the_ellipse_holds_95_percent_of_what_it_promises():
    rng = np.random.default_rng(5)
    answer, covariance = direction_from_angles(4.0, 0.9), np.array([[4e-4, 1e-4], [1e-4, 9e-4]])
    offsets = rng.multivariate_normal((0, 0), covariance, 4000)
    inside = [
        squared_sigmas(answer, covariance, answer + offset @ tangent_basis(answer)) < ELLIPSE_95 for offset in offsets
    ]
    assert share(inside) == pytest.approx(0.95, abs=0.015)


def test_the_spread_is_about_what_is_given():
    low, middle, high = (direction_from_angles(0.0, 0.5 + math.radians(degrees)) for degrees in (-2, 0, 2))
    assert rms_deg([low, high], np.mean([low, high], axis=0)) == pytest.approx(2)
    assert rms_deg([low, middle, high], high) == pytest.approx(math.sqrt((4**2 + 2**2) / 3))


def test_certainty_pays_only_when_right():
    assert brier_score([1.0, 0.0], [True, False]) == 0
    assert brier_score([1.0], [False]) == 1
    assert brier_score([0.5, 0.5], [True, False]) == 0.25
    assert brier_score([], []) is None


def test_the_overlap_counts_what_either_has():
    left, all_of_it = np.array([[True, False]]), np.array([[True, True]])
    assert overlap(left, all_of_it) == 0.5
    assert overlap(left, ~left) == 0
    assert overlap(~all_of_it, ~all_of_it) == 1


def drawn(count: int, bias: float = 0.0) -> tuple[list[float], list[bool]]:
    """Confidences, and whether answers are good: as often as that says, or less often by `bias`."""
    rng = np.random.default_rng(3)
    confidences = rng.random(count)
    return confidences.tolist(), (rng.random(count) < confidences - bias).tolist()


def test_calibration_error_is_the_mean_distance_from_the_truth() -> None:
    assert calibration_error(*drawn(20_000)) < 0.02
    assert calibration_error(*drawn(20_000, bias=0.2)) == pytest.approx(0.18, abs=0.03)
    assert calibration_error([], []) is None


def test_risk_is_read_where_a_coverage_is_reached() -> None:
    curve = risk_by_coverage([0.5, 0.9, 0.8], [False, True, True], [True, True, True], lit=4)
    assert risk_at(curve, 0.5) == (0.8, 0.0)
    assert risk_at(curve, 0.75) == (0.5, pytest.approx(1 / 3))
    assert risk_at(curve, 0.9) is None


def test_statistics_are_those_of_the_known_values() -> None:
    values = [4.0, None, 1.0, 2.0]
    assert (mean(values), median(values), largest(values)) == (pytest.approx(7 / 3), 2.0, 4.0)
    assert (percentile(values, 0), percentile(values, 50), percentile(values, 100)) == (1.0, 2.0, 4.0)
    for none in ([], [None, None]):
        assert mean(none) is median(none) is largest(none) is percentile(none, 90) is None
