"""How much the sheet's shadow counts is fitted to which explanations are right, and to nothing where it says nothing."""

import numpy as np
import pytest

from ashe_live.bench.judge.samples import Candidate, Sample
from ashe_live.bench.judge.sheets import FEATURE, LOOK, fitted_to, log_likelihood, without_sheets
from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.judgement.judge_tables import Curve, Score

WITHOUT = Score(0.0, {"clear shadow": Curve((-4.0, 4.0), (-4.0, 4.0))})


def pictures(agreeing: float, against: float, count: int = 4000) -> list[dict[object, Sample]]:
    """Pictures with one explanation, which is right with log odds as these two numbers have it."""
    rng = np.random.default_rng(5)
    made = []
    for number in range(count):
        odds, cosine = rng.uniform(-2, 2), rng.uniform(-1, 1)
        by_sheet = cosine * (agreeing if cosine > 0 else against)
        is_right = rng.random() < 1 / (1 + np.exp(-odds - by_sheet))
        features = {"clear shadow": odds, FEATURE: cosine}
        one = Candidate(features, int(is_right), np.array([0.0, 0.0, 1.0]), 0.0, np.zeros(2), np.eye(2))
        made.append({LOOK: Sample(str(number), {}, 1, [one], [])})
    return made


@pytest.mark.parametrize(("agreeing", "against"), [(1.0, 3.0), (2.0, 0.5)])
def test_both_numbers_are_those_by_which_explanations_are_right(agreeing: float, against: float) -> None:
    several = pictures(agreeing, against)
    score = fitted_to(WITHOUT, several)
    low, none, high = score.curves[FEATURE].log_odds
    assert (-low, none, high) == pytest.approx((against, 0.0, agreeing), abs=0.4)
    gains = [log_likelihood(score, each[LOOK]) - log_likelihood(WITHOUT, each[LOOK]) for each in several]
    assert np.mean(gains) > 0.02


def test_a_sheet_that_tells_nothing_counts_nothing() -> None:
    *_, high = fitted_to(WITHOUT, pictures(0.0, 0.0)).curves[FEATURE].log_odds
    assert high <= 0.2


def test_the_other_curves_stay() -> None:
    shipped = fitted_judge().tables.explanation
    others = without_sheets(shipped)
    assert FEATURE not in others.curves
    assert all(others.curves[name] is curve for name, curve in shipped.curves.items() if name != FEATURE)
