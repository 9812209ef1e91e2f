"""The conditional logit: it finds the odds that choices were drawn with, within the signs that physics allows."""

import numpy as np
import pytest

from ashe_live.bench.judge.logit import fitted_score
from ashe_live.bench.judge.samples import Candidate
from ashe_live.errors import UserError

GROUPS, TRIED = 600, 4


def candidate(features: dict[str, float], rightness: int = 0) -> Candidate:
    return Candidate(features, rightness, np.array([0.0, 0.0, 1.0]), 0.0, np.zeros(2), np.eye(2))


def drawn(slopes: dict[str, float], constant: float, seed: int, tried: int = TRIED) -> list[list[Candidate]]:
    """Groups of candidates with features from 0 to 1, of which one or none is right, with these odds."""
    rng = np.random.default_rng(seed)
    groups = []
    for _ in range(GROUPS):
        several = [{name: float(rng.random()) for name in slopes} for _ in range(tried)]
        odds = np.exp([constant + sum(slope * each[name] for name, slope in slopes.items()) for each in several])
        right = rng.choice(tried + 1, p=np.append(odds, 1) / (1 + odds.sum()))
        groups.append([candidate(each, 2 * (i == right)) for i, each in enumerate(several)])
    return groups


def test_the_odds_are_those_that_the_choices_were_drawn_with() -> None:
    score = fitted_score(drawn({"edge": 4.0, "hue": -4.0}, -1.0, seed=1))
    for name, slope in (("edge", 4.0), ("hue", -4.0)):
        curve = score.curves[name]
        assert curve(0.8) - curve(0.2) == pytest.approx(0.6 * slope, abs=0.6)
    middle = {"edge": 0.5, "hue": 0.5}
    assert score.log_odds(middle) == pytest.approx(-1.0, abs=0.4)


def test_what_physics_forbids_counts_nothing() -> None:
    """A picture set in which dull edges happen to be right does not make them so."""
    score = fitted_score(drawn({"edge": -4.0, "hue": -2.0}, 0.0, seed=2))
    assert set(score.curves["edge"].log_odds) == {0.0}
    assert score.curves["hue"](1.0) < score.curves["hue"](0.0)


def test_what_says_nothing_counts_little() -> None:
    score = fitted_score(drawn({"edge": 4.0, "border": 0.0}, -1.0, seed=3))
    assert abs(score.curves["border"](1.0)) < 0.5


def test_the_constant_falls_as_more_are_tried_in_vain() -> None:
    few, many = (fitted_score(drawn({"edge": 0.5}, np.log(0.5 / tried), 4, tried)).constant for tried in (2, 16))
    assert many < few - 1


def test_how_often_the_right_one_was_found_does_not_matter() -> None:
    groups = drawn({"edge": 3.0}, 0.0, seed=5)
    alone = fitted_score(groups)
    assert fitted_score(groups).constant == alone.constant
    none = [[candidate({"edge": 0.5}, 0)] for _ in range(5)]
    assert fitted_score(groups + 40 * none).constant < alone.constant


def test_of_two_that_are_right_the_one_with_all_lights_is_learned() -> None:
    groups = [[candidate({"second": 1.0}, 2), candidate({"second": 0.0}, 1)] for _ in range(50)]
    # A second light cannot count for an explanation, so that it can only be not held against it.
    assert set(fitted_score(groups).curves["second"].log_odds) == {0.0}


def test_curves_bend_where_values_lie() -> None:
    """At the least value and at quantiles of those above, where many have the least; at both, where there are two."""
    above = np.linspace(0, 1, 201)[1:]
    values = {"hue": [0.0] * 200 + above.tolist(), "edge": [2.0, 5.0] * 200, "border": [3.0] * 400}
    several = [
        candidate(dict(zip(values, each, strict=True)), i % 2)
        for i, each in enumerate(zip(*values.values(), strict=True))
    ]
    score = fitted_score([several[at : at + 4] for at in range(0, 400, 4)])
    assert score.curves["hue"].at == pytest.approx((0.0, 0.33, 0.66, 0.95), abs=0.01)
    assert score.curves["edge"].at == (2.0, 5.0)
    assert score.curves["border"].at == (3.0, 4.0)
    spread = fitted_score([[candidate({"edge": float(value)}, 1)] for value in np.linspace(0, 10, 401)])
    assert spread.curves["edge"].at == pytest.approx((0.3, 3.5, 6.5, 9.7), abs=0.01)


def test_without_anything_to_fit_to_it_says_so() -> None:
    for groups in ([], [[]]):
        with pytest.raises(UserError, match="nothing was tried"):
            fitted_score(groups)
