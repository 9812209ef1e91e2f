"""How far an explanation is believed: what its odds fall with, and what rivals take from the best."""

import dataclasses
from collections.abc import Sequence

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.edges.step_costs import MISSED, StepCosts
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.judgement.evidence import SIGNS
from ashe_live.light.explanation.judgement.judge import (
    GOOD_RAD,
    best_direction,
    fitted_judge,
    likeliest_direction,
    probabilities_of,
    recalibrated,
)
from ashe_live.light.explanation.judgement.judge_tables import Average
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted
from tests.light.painted_bodies import alignment_of, body_of, explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster
from tests.light.synthetic_masks import direction

TO_LIGHT = direction(200.0, 40.0)
JUDGE = fitted_judge()


def best_of(explanations: Sequence[Explanation]) -> tuple[Explanation, float]:
    """The likeliest of these and the confidence in it."""
    probabilities = probabilities_of([JUDGE.log_odds(each) for each in explanations])
    index, confidence = best_direction(probabilities, [each.lights[0].to_light_marker for each in explanations])
    return explanations[index], confidence


def covariance(larger_deg: float, smaller_deg: float, turn_rad: float = 0.4) -> Float:
    axes = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    return np.asarray(axes @ np.diag(np.radians([larger_deg, smaller_deg]) ** 2) @ axes.T)


def explanation(
    misfit_px: float = 0.3, covariance_rad2: Float | None = None, to_light: Float = TO_LIGHT
) -> Explanation:
    """The painted truth, missed by this much."""
    here = painted_region(BOX)
    spread = covariance(1.0, 0.7) if covariance_rad2 is None else covariance_rad2
    lights = (FittedLight(at_infinity(to_light), spread),)
    cost = min((misfit_px / 0.3) ** 2, MISSED)
    alignment = alignment_of(here, misfit_px=misfit_px)
    return explanation_of(here, alignment=alignment, lights=lights, steps=StepCosts(cost, cost))


# One explanation


def test_odds_fall_as_the_outlines_fit_worse() -> None:
    odds = [JUDGE.log_odds(explanation(misfit_px)) for misfit_px in (0.2, 0.5, 1, 2, 5, 20)]
    assert (np.diff(odds) <= 0).all()
    assert odds[-1] < odds[0] - 1


def test_odds_fall_as_the_direction_is_less_certain() -> None:
    odds = [JUDGE.log_odds(explanation(covariance_rad2=covariance(deg, 0.5))) for deg in (3, 5, 10, 20, 40)]
    assert (np.diff(odds) <= 0).all()
    assert odds[-1] < odds[0]


def test_no_answer_is_surer_than_its_outlines_determine_it() -> None:
    """Where they leave it open, no more than what directions left open were found to be."""
    judge = fitted_judge()
    sharp, open_height = explanation(), explanation(covariance_rad2=covariance(30.0, 0.7))
    assert judge.probability_if_right(sharp) > 0.99
    assert judge.probability_if_right(open_height) == pytest.approx(judge.tables.good_if_open, abs=0.05)
    (light,) = open_height.lights
    known = dataclasses.replace(open_height, lights=(dataclasses.replace(light, covariance_rad2=covariance(5.0, 0.7)),))
    assert judge.probability_if_right(open_height) < judge.probability_if_right(known)


def test_odds_fall_as_other_families_would_have_it_elsewhere() -> None:
    here = painted_region(BOX)
    body = body_of(here, BOX)
    lights = [
        dataclasses.replace(body, lights=at_infinity(direction(200.0, elevation))[None])
        for elevation in (40, 45, 55, 80)
    ]
    odds = [JUDGE.log_odds(dataclasses.replace(explanation(), bodies=(lit,))) for lit in lights]
    assert (np.diff(odds) <= 0).all()
    assert odds[-1] < odds[0]


@pytest.mark.parametrize("outline", ["clear_body", "clear_shadow"])
def test_odds_fall_as_borders_are_less_clear(outline: str) -> None:
    here = painted_region(BOX)
    odds = [
        JUDGE.log_odds(explanation_of(here, alignment=alignment_of(here, **{outline: share})))
        for share in (1, 0.7, 0.3)
    ]
    assert (np.diff(odds) <= 0).all()


def test_a_shadow_of_another_hue_than_daylights_is_less_believed() -> None:
    here = painted_region(BOX)
    green = materials_of(here.region, here.ground, here.true_shift + np.array([0, 0, 0.6]))
    assert JUDGE.log_odds(dataclasses.replace(explanation(), materials=green)) < JUDGE.log_odds(explanation())


def test_object_and_shadow_do_not_change_places() -> None:
    here = painted_region(BOX)
    truth = alignment_of(here)
    swapped = dataclasses.replace(truth.placed, predicted=Predicted(here.shadow, here.body))
    changed = dataclasses.replace(explanation(), alignment=dataclasses.replace(truth, placed=swapped))
    assert JUDGE.log_odds(changed) < JUDGE.log_odds(explanation()) - 1


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_true_split_scores_higher_than_wrong_ones(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)

    def score(split: Split) -> float:
        return JUDGE.split_score(here.region, here.materials, split)

    rows = np.arange(here.body.shape[0])[:, None] < np.median(np.nonzero(here.body)[0])
    truth = score(Split(here.body, here.shadow))
    assert truth > score(Split(here.shadow, here.body))
    assert truth > score(Split(here.body & rows, here.body & ~rows))


@pytest.mark.parametrize("misfit_px", [0.0, 1e-12, 1e3, 1e9])
@pytest.mark.parametrize("spread_deg", [0.0, 1e-9, 60.0, 1e6])
def test_odds_are_finite_at_the_extremes(misfit_px: float, spread_deg: float) -> None:
    extreme = explanation(misfit_px, covariance(spread_deg, 0.0))
    assert np.isfinite(JUDGE.log_odds(extreme))
    _, confidence = best_of([extreme])
    assert 0 <= confidence <= 1


# Several


def directions(*angles_deg: tuple[float, float]) -> Float:
    return np.array([direction(*angles) for angles in angles_deg])


def test_all_explanations_and_none_of_them_share_one_probability() -> None:
    several = [explanation(misfit_px) for misfit_px in (0.3, 1.0, 3.0)]
    log_odds = [JUDGE.log_odds(each) for each in several]
    probabilities = probabilities_of(log_odds)
    none = 1 - probabilities.sum()
    assert none > 0
    np.testing.assert_allclose(np.log(probabilities / none), log_odds)


def test_more_work_that_finds_nothing_better_makes_less_sure() -> None:
    """The look-elsewhere effect is paid for: every further wrong explanation takes its part."""
    good, far = explanation(0.3), direction(20.0, 40.0)
    confidences = [best_of([good, *(explanation(1.0, to_light=far) for _ in range(count))])[1] for count in range(5)]
    assert (np.diff(confidences) < 0).all()


def test_a_rival_elsewhere_takes_its_share_and_one_nearby_gives_it() -> None:
    probabilities = np.array([0.5, 0.4])
    assert best_direction(probabilities, directions((200, 40), (20, 40))) == (0, 0.5)
    assert best_direction(probabilities, directions((200, 40), (203, 42))) == (0, pytest.approx(0.9))


def test_several_of_one_direction_outweigh_one_elsewhere() -> None:
    index, confidence = best_direction(np.array([0.4, 0.2, 0.3]), directions((200, 40), (20, 40), (22, 41)))
    assert index == 2
    assert confidence == pytest.approx(0.5)


def test_the_number_of_lights_is_that_of_most_of_the_probability() -> None:
    one_direction = directions((200, 40), (201, 40), (200, 41), (20, 40))
    probabilities = np.array([0.4, 0.2, 0.25, 0.1])
    for counts, alike in (((1, 2, 2, 2), (1, 2)), ((1, 2, 1, 2), (0, 2))):
        group, share = likeliest_direction(probabilities, one_direction, counts)
        assert tuple(np.flatnonzero(group)) == alike
        assert share == pytest.approx(0.85)


def test_the_order_of_explanations_does_not_matter() -> None:
    rng = np.random.default_rng(1)
    probabilities, towards = rng.dirichlet(np.ones(9)), np.array([normalised(rng.normal(size=3)) for _ in range(9)])
    order = rng.permutation(9)
    index, confidence = best_direction(probabilities, towards)
    other, same = best_direction(probabilities[order], towards[order])
    assert order[other] == index
    assert same == pytest.approx(confidence)


def test_within_ten_degrees_is_near() -> None:
    good_deg = np.degrees(GOOD_RAD)
    near, far = (
        best_direction(np.array([0.5, 0.5]), directions((200, 40), (200, 40 + apart_deg)))[1]
        for apart_deg in (good_deg - 0.1, good_deg + 0.1)
    )
    assert far == 0.5
    assert near == 1.0


def test_the_best_explanation_wins_and_a_strong_rival_makes_it_less_believed() -> None:
    good, worse = explanation(0.3), explanation(3.0)
    rival = explanation(1.5, to_light=direction(20.0, 40.0))
    ally = explanation(1.5, to_light=direction(202.0, 41.0))
    alone = best_of([good])
    for others in ([worse], [rival], [ally], [rival, ally, worse]):
        best, confidence = best_of([*others, good])
        assert best is good
        assert 0 < confidence < 1
    assert best_of([rival, good])[1] < alone[1]
    assert best_of([rival, good])[1] < best_of([ally, good])[1]
    assert best_of([worse])[1] < alone[1]


@pytest.mark.parametrize("looks", [1, 2])
def test_confidence_rises_with_the_looks_average_probability(looks: int) -> None:
    average = JUDGE.average(looks)
    assert sum(average.weights) == pytest.approx(1)
    confidences = [recalibrated(probability, average) for probability in (0.0, 0.01, 0.3, 0.5, 0.9, 0.999, 1.0)]
    assert (np.diff(confidences) > 0).all()
    assert 0 <= confidences[0] < confidences[-1] <= 1


def test_no_recalibration_leaves_a_probability_as_it_is() -> None:
    assert recalibrated(0.3, Average((1.0,))) == pytest.approx(0.3)
    assert recalibrated(0.3, Average((1.0,), 1.0, 0.0)) == pytest.approx(1 / (1 + np.exp(-1)))


# The tables


@pytest.mark.parametrize("score", ["split", "explanation"])
def test_nothing_counts_with_a_sign_that_physics_forbids(score: str) -> None:
    for name, curve in getattr(JUDGE.tables, score).curves.items():
        assert (SIGNS[name] * np.diff(curve.log_odds) >= 0).all(), name


def test_the_tables_say_where_they_come_from() -> None:
    assert {"command", "scenes", "pictures", "date"} <= JUDGE.tables.origin.keys()
