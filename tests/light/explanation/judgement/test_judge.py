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
    explanation_features,
    fitted_judge,
    is_settled,
    likeliest_direction,
    probabilities_of,
    recalibrated,
    split_features,
)
from ashe_live.light.explanation.judgement.judge_tables import Average
from ashe_live.light.explanation.judgement.uncertainty import covariance_of_outlines
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.labels.two_lights import materials_of_two
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted
from tests.light.painted_bodies import alignment_of, body_of, explanation_of
from tests.light.painted_regions import painted_region, shift_of
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


def test_odds_fall_as_the_shadows_border_is_less_clear() -> None:
    here = painted_region(BOX)
    alignments = (alignment_of(here, clear_shadow=share) for share in (1, 0.7, 0.3))
    odds = [JUDGE.log_odds(explanation_of(here, alignment=alignment)) for alignment in alignments]
    assert (np.diff(odds) < 0).all()


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
    group, _ = likeliest_direction(np.array([0.6, 0.1, 0.1, 0.1]), one_direction, (1, 2, 2, 2))
    assert tuple(np.flatnonzero(group)) == (0,)


def test_the_search_ends_where_one_direction_is_surely_likelier_than_any_other() -> None:
    here, there = directions((200, 40), (20, 40))
    assert is_settled([4.0], [here])
    assert is_settled([3.0, 3.0], [here, here])
    assert not is_settled([4.0, 4.0], [here, there])
    assert not is_settled([0.0], [here])
    assert not is_settled([], [])


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


@pytest.mark.parametrize("looks", [1, 2, 7])
def test_confidence_rises_with_the_looks_average_probability(looks: int) -> None:
    average = JUDGE.average(looks)
    assert sum(average.weights) == pytest.approx(1)
    confidences = [recalibrated(probability, average) for probability in (0.0, 0.01, 0.3, 0.5, 0.9, 0.999, 1.0)]
    assert (np.diff(confidences) > 0).all()
    assert 0 <= confidences[0] < confidences[-1] <= 1


def test_no_recalibration_leaves_a_probability_as_it_is() -> None:
    assert recalibrated(0.3, Average((1.0,))) == pytest.approx(0.3)
    assert recalibrated(0.3, Average((1.0,), 1.0, 0.0)) == pytest.approx(1 / (1 + np.exp(-1)))


def test_pixels_that_may_be_of_either_count_as_shadow_before_a_fit() -> None:
    here = painted_region(BOX)
    part = here.shadow & (np.arange(here.shadow.shape[1]) % 2 > 0)
    by_parts = Split(here.body, here.shadow & ~part, undecided=part)
    of_parts, of_whole = (
        split_features(here.region, here.materials, each) for each in (by_parts, Split(here.body, here.shadow))
    )
    assert of_parts == of_whole


def test_of_two_lights_the_less_certain_one_counts() -> None:
    sure, unsure = explanation(), explanation(covariance_rad2=covariance(8.0, 6.0))
    here = painted_region(BOX)
    pale = materials_of(here.region, here.ground, shift_of(np.full(3, 0.8)))
    of_both = materials_of_two(here.region, here.ground, here.materials, pale)
    assert of_both is not None
    both = dataclasses.replace(sure, materials=of_both)
    told = [
        explanation_features(dataclasses.replace(both, lights=lights))["constrained"]
        for lights in (sure.lights * 2, sure.lights + unsure.lights, unsure.lights * 2)
    ]
    assert told[0] > told[1] == told[2]


def test_what_all_objects_share_is_what_no_outline_makes_better() -> None:
    tracked = painted_region(BOX).scene.tracked
    assert tracked.marker is not None
    turned = dataclasses.replace(tracked.marker, covariance=1e-4 * np.diag([1.0, 2.0, 3.0, 1.0, 1.0, 1.0]))
    unsure = dataclasses.replace(tracked, marker=turned)
    fitted = FittedLight(at_infinity(TO_LIGHT), covariance(1.0, 0.7))
    own = JUDGE.calibration.of_outlines(fitted) - JUDGE.calibration.of_outlines(
        dataclasses.replace(fitted, covariance_rad2=np.zeros((2, 2)))
    )
    shared = JUDGE.shared_rad2(TO_LIGHT, unsure)
    np.testing.assert_allclose(shared + own, JUDGE.calibration.covariance(fitted, 1.0, unsure))
    assert np.linalg.eigvalsh(shared - JUDGE.shared_rad2(TO_LIGHT, tracked)).min() > 1e-9


def test_a_hulls_light_is_as_uncertain_as_its_posterior() -> None:
    one, tracked = explanation(), painted_region(BOX).scene.tracked
    of_family, of_hull = (
        JUDGE.lights_of(dataclasses.replace(one, hull=hull), 1.0, tracked)[0] for hull in (None, one.proxy)
    )
    assert JUDGE.calibration.overdispersion > 1
    np.testing.assert_allclose(of_hull.covariance_rad2, covariance_of_outlines(one.lights[0].covariance_rad2))
    assert of_family.sigma_rad > of_hull.sigma_rad > 0


def test_a_known_body_is_judged_by_its_own_score() -> None:
    known = JUDGE.of_known_body()
    features = explanation_features(explanation())
    assert known.log_odds_of(features) == pytest.approx(JUDGE.tables.known_body_score.log_odds(features))
    assert known.log_odds_of(features) != JUDGE.log_odds_of(features)


# The tables


@pytest.mark.parametrize("score", ["split", "explanation"])
def test_nothing_counts_with_a_sign_that_physics_forbids(score: str) -> None:
    for name, curve in getattr(JUDGE.tables, score).curves.items():
        assert (SIGNS[name] * np.diff(curve.log_odds) >= 0).all(), name


def test_the_tables_say_where_they_come_from() -> None:
    assert {"command", "scenes", "pictures", "date"} <= JUDGE.tables.origin.keys()
