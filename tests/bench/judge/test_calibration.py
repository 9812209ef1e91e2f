"""The calibration of covariances: errors that were drawn with some spread are found to have it."""

import numpy as np
import pytest

from ashe_live.bench.judge.calibration import Answer, fitted_calibration, squared_distances
from ashe_live.core.transforms import ELLIPSE_68, ELLIPSE_95
from ashe_live.light.explanation.judgement.uncertainty import FLOOR_RAD, Calibration


def drawn(calibration: Calibration, count: int = 3000) -> list[Answer]:
    rng = np.random.default_rng(0)
    answers = []
    for confidence in rng.uniform(0.3, 1.0, count):
        outlines = np.diag(rng.uniform(0.005, 0.05, 2) ** 2)
        doubt = calibration.doubt_rad * (1 - confidence) ** calibration.doubt_power
        spread = calibration.overdispersion * outlines + (FLOOR_RAD**2 + doubt**2) * np.eye(2)
        answers.append(Answer(float(confidence), rng.multivariate_normal(np.zeros(2), spread), outlines))
    return answers


@pytest.mark.parametrize("true", [Calibration(1.0, 0.3, 2.0), Calibration(3.0, 0.8, 3.0)])
def test_errors_are_as_large_as_they_were_drawn(true: Calibration) -> None:
    answers = drawn(true)
    found = fitted_calibration(answers)
    assert found.overdispersion == pytest.approx(true.overdispersion, rel=0.2)
    for confidence in (0.4, 0.6, 0.8):
        doubts = [each.doubt_rad * (1 - confidence) ** each.doubt_power for each in (found, true)]
        assert doubts[0] == pytest.approx(doubts[1], rel=0.25)
    squared = squared_distances(found, answers)
    assert np.mean(squared <= ELLIPSE_68) == pytest.approx(0.68, abs=0.02)
    assert np.mean(squared <= ELLIPSE_95) == pytest.approx(0.95, abs=0.01)


def test_a_few_answers_that_are_quite_wrong_hardly_widen_the_others() -> None:
    answers = drawn(Calibration(2.0, 0.2, 2.0))
    wrong = [Answer(0.9, np.array([1.5, 1.0]), np.diag([1e-4, 1e-4])) for _ in range(40)]
    alone, beside = fitted_calibration(answers), fitted_calibration(answers + wrong)
    assert beside.overdispersion < 1.3 * alone.overdispersion
