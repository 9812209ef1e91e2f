"""The judge's tables: curves between their points, what they refuse, known bodies, and the way through a file."""

import json
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.light.explanation.judgement.judge import fitted_judge
from ashe_live.light.explanation.judgement.judge_tables import (
    GIVEN,
    INDEPENDENT,
    UNCHANGED,
    Curve,
    OfKnownBody,
    Score,
    read_tables,
)

RISING = Curve((-1.0, 0.5, 0.75, 3.0), (-2.0, -2.0, 1.0, 4.0))
FALLING = Curve((0.0, 2.0), (5.0, 1.0))


@pytest.mark.parametrize("curve", [RISING, FALLING])
def test_a_curve_is_linear_between_its_points_and_constant_beyond_them(curve: Curve) -> None:
    for value in (*np.linspace(-2, 4, 121), *curve.at):
        assert curve(float(value)) == pytest.approx(np.interp(value, curve.at, curve.log_odds), abs=1e-12)


@pytest.mark.parametrize(
    ("at", "log_odds"),
    [
        ((0.0, 1.0, 2.0), (0.0, 1.0)),
        ((0.0,), (1.0,)),
        ((0.0, 0.0), (1.0, 2.0)),
        ((1.0, 0.0), (1.0, 2.0)),
        ((1.0, 0.0, 2.0), (0.0, 1.0, 2.0)),
    ],
)
def test_a_curve_needs_as_many_rising_values_as_contributions(
    at: tuple[float, ...], log_odds: tuple[float, ...]
) -> None:
    with pytest.raises(ValueError, match="rising values"):
        Curve(at, log_odds)


def test_a_curve_is_monotone() -> None:
    with pytest.raises(ValueError, match="rises or falls"):
        Curve((0.0, 1.0, 2.0), (0.0, 1.0, 0.5))


def test_of_a_known_body_odds_count_by_a_slope_but_for_what_is_not_of_the_body() -> None:
    (independent,) = INDEPENDENT
    score = Score(0.7, {"misfit": FALLING, independent: RISING})
    features = {"misfit": 1.2, independent: 0.6}
    of_known = OfKnownBody(-0.4, 0.5).applied(score)
    expected = -0.4 + 0.5 * (0.7 + FALLING(1.2)) + RISING(0.6)
    assert of_known.log_odds(features) == pytest.approx(expected)
    assert UNCHANGED.applied(score).log_odds(features) == pytest.approx(score.log_odds(features))
    with pytest.raises(KeyError):
        score.log_odds({"misfit": 1.2})


def test_what_counts_against_a_guessed_shape_says_nothing_of_a_given_one() -> None:
    tables = fitted_judge().tables
    assert set(GIVEN) <= tables.explanation.curves.keys()
    assert tables.known_body_score.curves.keys() == tables.explanation.curves.keys() - set(GIVEN)


def test_tables_are_read_as_they_were_written_and_those_without_known_bodies_as_of_any() -> None:
    tables = replace(fitted_judge().tables, of_known_body=OfKnownBody(-0.4, 0.5))
    written = tables.as_json()
    again = read_tables(json.dumps(written))
    assert again.as_json() == written
    assert again.of_known_body == tables.of_known_body
    del written["known_body"]
    assert read_tables(json.dumps(written)).of_known_body == OfKnownBody(0.0, 1.0)
