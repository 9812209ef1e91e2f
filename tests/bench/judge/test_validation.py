"""Risk, coverage and calibration of judged answers, on answers whose risk is known."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from ashe_live.bench.judge.confidence import (
    LEAST_GOOD,
    PRIOR_ANSWERS,
    as_stated,
    fitted_average,
    fitted_confidence,
    least_confidence,
    with_open_directions,
)
from ashe_live.bench.judge.samples import Candidate, Sample, of_one_view
from ashe_live.bench.judge.tables import calibration_table, families_table, risk_table
from ashe_live.bench.judge.validation import (
    FOLDS,
    Judged,
    Pictures,
    by_families_left_out,
    judged,
    looks_by,
    mean_risk,
    risk_curve,
    scores_by_others,
)
from ashe_live.bench.metrics import tangent_offset
from ashe_live.core.arrays import Float
from ashe_live.light.estimators import preset
from ashe_live.light.explanation.judgement.judge import recalibrated
from ashe_live.light.explanation.judgement.judge_tables import Average, Curve, Score
from ashe_live.light.explanation.judgement.uncertainty import Calibration

FAST = of_one_view(preset.FAST)
OTHER = of_one_view(preset.BALANCED)
ONE, TWO = Average((1.0,)), Average((0.6, 0.4))
UP = np.array([0.0, 0.0, 1.0])
ONE_LIGHT = UP[None]  # the true one


def candidate(error_deg: float, edge: float = 1.0) -> Candidate:
    error = float(np.radians(error_deg))
    to_light_marker = np.array([np.sin(error), 0.0, np.cos(error)])
    by_axis = tangent_offset(to_light_marker, UP)
    return Candidate({"edge": edge}, int(error_deg < 10), to_light_marker, abs(error), by_axis, np.eye(2))


def answer(confidence: float, error_deg: float = 1.0, lights: int = 1, **tags: str) -> Judged:
    best = candidate(error_deg)
    return Judged(Sample(f"{confidence}{tags}", tags, np.tile(UP, (lights, 1)), [best], []), best, confidence)


def sample_of(candidates: list[Candidate]) -> Sample:
    return Sample("a", {}, ONE_LIGHT, candidates, [])


def drawn(count: int, bias: float = 0.0) -> list[Judged]:
    """Answers that are good as often as their confidence says, or less often by `bias` in log odds."""
    rng = np.random.default_rng(3)
    confidences = rng.random(count)
    good = rng.random(count) < recalibrated_by(confidences, bias)
    return [answer(float(c), 1.0 if is_good else 90.0) for c, is_good in zip(confidences, good, strict=True)]


def recalibrated_by(confidence: Float, bias: float) -> Float:
    return 1 / (1 + np.exp(bias) * (1 - confidence) / confidence)


def test_risk_falls_with_coverage_where_confidence_separates_right_from_wrong() -> None:
    curve = risk_curve([answer(0.9), answer(0.8), answer(0.5, 40.0), answer(0.3)])
    assert [covered for _, covered, _ in curve] == [0.25, 0.5, 0.75, 1.0]
    assert [risk for *_, risk in curve] == pytest.approx([0, 0, 1 / 3, 1 / 4])


def test_the_mean_risk_is_the_area_under_the_curve() -> None:
    assert mean_risk([answer(0.9), answer(0.8, 40.0), answer(0.7), answer(0.6)]) == pytest.approx(
        (0 + 1 / 2 + 1 / 3 + 1 / 4) / 4
    )


def test_an_answer_where_there_is_no_light_is_a_risk_and_covers_nothing() -> None:
    (confidence, covered, risk), _ = risk_curve([answer(0.9, 180.0, lights=0), answer(0.8)])
    assert (confidence, covered, risk) == (0.9, 0.0, 1.0)


def test_an_answer_is_bad_where_it_is_sure_and_far_off() -> None:
    assert [answer(*each).is_bad for each in ((0.51, 16.0), (0.49, 16.0), (0.51, 14.0))] == [True, False, False]


def test_families_and_coverages_have_their_shares_of_bad_answers() -> None:
    answers = [answer(0.9, 20.0), answer(0.8), answer(0.7), answer(0.6, 12.0), answer(0.6, 12.0, lights=0)]
    (family,) = zip(*(column.cells for column in families_table([("ground", "wood", answers)]).columns), strict=True)
    error = np.mean([0.9, 0.2, 0.3, 0.6, 0.6])
    assert family == ("ground: wood", "4", "20.0 %", f"{error:.3f}"), "two answers are to one picture"
    risks = [list(column.cells) for column in risk_table("tables", {"fast": answers}).columns]
    assert risks[0] == [f"{percent} %" for percent in (30, 40, 50, 60, 70, 80, 90)]
    assert risks[1] == ["50.0 % from 0.80"] * 3 + ["33.3 % from 0.70"] * 2 + ["50.0 % from 0.60"] * 2


def test_an_answer_where_there_is_no_light_counts_against_its_confidence() -> None:
    def cells(answers: list[Judged]) -> list[list[str]]:
        return [list(column.cells) for column in calibration_table(Calibration(1.0, 0.3, 2.0), answers).columns]

    unlit = answer(0.9, error_deg=180.0, lights=0)
    assert cells([answer(0.9), answer(0.9), answer(0.9), unlit])[1:] == [["4"], ["75 %"], ["100 %"], ["100 %"]]
    assert cells([unlit])[1:] == [["1"], ["0 %"], ["-"], ["-"]]


def test_answers_are_given_while_enough_of_them_are_good() -> None:
    assert least_confidence(drawn(4000)) == pytest.approx(LEAST_GOOD, abs=0.03)
    asked = least_confidence(drawn(4000, bias=1.0))
    assert recalibrated_by(np.array(asked), 1.0) == pytest.approx(LEAST_GOOD, abs=0.03)


def test_the_likeliest_candidate_answers_and_nothing_tried_is_no_answer() -> None:
    score = Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})
    tried = Sample("a", {}, ONE_LIGHT, [candidate(40.0, 0.0), candidate(2.0, 1.0)], [])
    best = judged(score, [tried], ONE)
    assert best.error_rad == pytest.approx(np.radians(2.0))
    assert best.confidence == pytest.approx(np.exp(2) / (2 + np.exp(2)))
    nothing = judged(score, [dataclasses.replace(tried, judged=[])], ONE)
    assert (nothing.best, nothing.confidence, nothing.answer) == (None, 0.0, None)


def test_looks_that_agree_are_surer_than_looks_that_do_not() -> None:
    score = Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})
    here = Sample("a", {}, ONE_LIGHT, [candidate(2.0)], [])
    elsewhere = Sample(
        "a", {}, ONE_LIGHT, [dataclasses.replace(candidate(90.0), to_light_marker=np.array([1.0, 0, 0]))], []
    )
    nothing = Sample("a", {}, ONE_LIGHT, [], [])
    once = judged(score, [here], ONE).confidence
    assert judged(score, [here, here], TWO).confidence == pytest.approx(once)
    assert judged(score, [here, elsewhere], TWO).confidence == pytest.approx(0.6 * once)
    assert judged(score, [nothing, here], TWO).confidence == pytest.approx(0.4 * once)


def test_what_outlines_leave_open_is_good_as_often_as_is_found() -> None:
    """Half of the answers leave the direction open, and 40 % of the right ones among these are good."""
    rng = np.random.default_rng(5)
    open_rad2, calibration = np.diag([1e-4, 4.0]), Calibration(1.0, 0.5, 2.0)
    answers = []
    for right in rng.uniform(0.5, 1.0, 4000):
        is_open = rng.random() < 0.5
        is_good = rng.random() < right * (0.4 if is_open else 1.0)
        each = answer(float(right), 1.0 if is_good else 90.0)
        best = dataclasses.replace(candidate(1.0 if is_good else 90.0), covariance_rad2=1e-4 * np.eye(2))
        best = dataclasses.replace(best, covariance_rad2=open_rad2) if is_open else best
        answers.append(dataclasses.replace(each, best=best))
    good_if_open, averages = with_open_directions({1: answers}, {1: ONE}, calibration)
    assert good_if_open == pytest.approx(0.4, abs=0.06)
    assert (averages[1].offset, averages[1].slope) == pytest.approx((0.0, 1.0), abs=0.15)
    stated = as_stated(answers, calibration, good_if_open)
    assert fitted_confidence(stated) == pytest.approx((0.0, 1.0), abs=0.15)


def test_recalibrated_answers_are_right_as_often_as_they_say() -> None:
    """Confidences whose log odds are half of what they should be are doubled, and right ones stay."""
    timid = drawn(6000)
    assert fitted_confidence(timid) == pytest.approx((0.0, 1.0), abs=0.1)
    half = Average((1.0,), 0.0, 0.5)
    halved = [dataclasses.replace(each, confidence=recalibrated(each.confidence, half)) for each in timid]
    assert fitted_confidence(halved) == pytest.approx((0.0, 2.0), abs=0.2)


@pytest.mark.parametrize("is_open", [False, True])
def test_fitted_confidences_are_the_likeliest_however_ill_they_fit(is_open: bool) -> None:
    """With a prior of PRIOR_ANSWERS answers at even odds, of which each has an information of a fourth."""
    rng = np.random.default_rng(8)
    answers = [
        answer(float(c), float(error)) for c, error in zip(rng.random(150), rng.choice([1.0, 90.0], 150), strict=True)
    ]
    factors = rng.uniform(0.3, 1.0, 150) if is_open else np.ones(150)
    good, said = np.array([each.is_good for each in answers]), np.array([each.confidence for each in answers])

    def likelihood(offset: float, slope: float) -> float:
        probability = factors / (1 + np.exp(-offset) * ((1 - said) / said) ** slope)
        prior = PRIOR_ANSWERS / 4 * (offset**2 + (slope - 1) ** 2) / 2
        return float(np.log(np.where(good, probability, 1 - probability)).sum() - prior)

    offset, slope = fitted_confidence(answers, factors)
    for more in ((0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)):
        assert likelihood(offset + more[0], slope + more[1]) < likelihood(offset, slope)


def test_few_answers_hardly_change_confidence() -> None:
    offset, slope = fitted_confidence([answer(0.9), answer(0.8)])
    assert abs(offset) < 0.5
    assert 0.5 < slope < 1.6


def fit_that_tells(seen: list[list[Sample]]) -> Callable[[Pictures], Score]:
    """A fit that keeps the first look at what it was given."""

    def fit(several: Pictures) -> Score:
        seen.append([picture[FAST] for picture in several])
        return Score(float(len(seen)), {"edge": Curve((0.0, 1.0), (0.0, 2.0))})

    return fit


def test_a_picture_is_judged_by_fits_that_have_not_seen_its_neighbours() -> None:
    pictures = [{FAST: Sample(str(i), {}, ONE_LIGHT, [candidate(2.0)], [])} for i in range(20)]
    seen: list[list[Sample]] = []
    assert len(scores_by_others(pictures, fit_that_tells(seen))) == 20
    for part, others in zip(np.array_split(np.arange(20), FOLDS), seen, strict=True):
        assert {other.case for other in others} == {str(i) for i in range(20)} - {str(i) for i in part}


def test_a_picture_is_judged_by_fits_that_have_seen_neither_its_object_nor_its_ground() -> None:
    objects, grounds = ("cup", "box", "toy", "tin", "book"), ("brick", "wood", "cloth", "stone", "tiles", "print")
    tags = [{"object_family": one, "ground": other} for one in objects for other in grounds]
    pictures = [{FAST: Sample(str(i), each, ONE_LIGHT, [candidate(2.0)], [])} for i, each in enumerate(tags)]
    seen: list[list[Sample]] = []
    for each, score in zip(tags, scores_by_others(pictures, fit_that_tells(seen)), strict=True):
        for other in seen[int(score.constant) - 1]:
            assert not set(each.values()) & set(other.tags.values())


def test_where_there_are_no_others_a_picture_is_judged_by_a_fit_to_all() -> None:
    pictures = [{FAST: Sample(str(i), {"ground": "wood"}, ONE_LIGHT, [candidate(2.0)], [])} for i in range(3)]
    seen: list[list[Sample]] = []
    assert len(scores_by_others(pictures, fit_that_tells(seen))) == 3
    assert {len(each) for each in seen} == {3}


def test_an_answer_is_the_mean_of_what_explains_the_picture_by_its_direction() -> None:
    score = Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})
    either_side = sample_of([candidate(3.0), candidate(-3.0)])
    assert judged(score, [either_side], ONE).error_rad == pytest.approx(0.0, abs=1e-3)
    # What is less likely moves it by less, and another direction not at all.
    less = sample_of([candidate(3.0), candidate(-3.0, 0.0), candidate(40.0, 0.0)])
    share = 1 / (1 + np.exp(-2.0))
    assert judged(score, [less], ONE).error_rad == pytest.approx(np.radians(3.0 * (2 * share - 1)), rel=0.01)


def test_of_what_explains_a_picture_alike_the_likeliest_says_how_sure_its_direction_is() -> None:
    score = Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})
    less, more = candidate(3.0, 0.0), dataclasses.replace(candidate(3.0), covariance_rad2=2 * np.eye(2))
    for several in ([less, more], [more, less]):
        best = judged(score, [sample_of(several)], ONE).best
        assert best is not None
        np.testing.assert_array_equal(best.covariance_rad2, more.covariance_rad2)


def test_the_better_look_weighs_more() -> None:
    """Of two looks one always finds the light, the other in every second picture, and is surer where it does not."""
    score = Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})
    wrong = dataclasses.replace(candidate(90.0), to_light_marker=np.array([1.0, 0, 0]))
    both = dataclasses.replace(FAST, second_look=OTHER)
    right = sample_of([candidate(2.0, edge=0.8)])
    pictures = [{FAST: right, OTHER: sample_of([wrong]) if i % 2 else right} for i in range(40)]
    average = fitted_average(pictures, [score] * 40, [both], 2)
    assert average.weights[0] > 0.5
    assert mean_risk([judged(score, looks_by(each, both), average) for each in pictures]) == 0


def test_a_family_is_judged_by_a_fit_that_has_not_seen_it() -> None:
    grounds = ["brick"] * 20 + ["wood"] * 20 + ["rare"] * 3
    pictures = [
        {FAST: Sample(str(i), {"ground": ground}, ONE_LIGHT, [candidate(2.0)], [])} for i, ground in enumerate(grounds)
    ]
    seen = []

    def fit(several: Pictures) -> Score:
        seen.append({picture[FAST].tags["ground"] for picture in several})
        return Score(0.0, {"edge": Curve((0.0, 1.0), (0.0, 2.0))})

    families = by_families_left_out(pictures, fit, FAST, ONE)
    found = [(kind, family, len(answers)) for kind, family, answers in families]
    assert found == [("ground", "brick", 20), ("ground", "wood", 20)]
    assert seen == [{"wood", "rare"}, {"brick", "rare"}]
    assert list(by_families_left_out(pictures[:20], fit, FAST, ONE)) == [], "no others to fit to"
