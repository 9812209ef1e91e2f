"""How far an explanation is believed: what its odds fall with, and what rivals take from the best."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import normalised
from ashe_live.light.explanation.evidence import Explanation
from ashe_live.light.explanation.judge import GOOD_RAD, best_of, contest, likeliest, log_odds, split_score
from ashe_live.light.labels.associate import Split
from ashe_live.light.labels.materials import materials_of
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.predicted import Predicted
from tests.light.painted_bodies import alignment_of, explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, GROUNDS, Caster
from tests.light.synthetic_masks import direction

TO_LIGHT = direction(200.0, 40.0)


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
    return explanation_of(here, alignment=alignment_of(here, misfit_px=misfit_px), lights=lights)


# One explanation


def test_odds_fall_as_the_outlines_fit_worse() -> None:
    odds = [log_odds(explanation(misfit_px)) for misfit_px in (0.2, 0.5, 1, 2, 5, 20)]
    assert (np.diff(odds) < 0).all()


def test_odds_fall_as_the_direction_is_less_certain() -> None:
    odds = [log_odds(explanation(covariance_rad2=covariance(deg, 0.5))) for deg in (3, 5, 10, 20, 40)]
    assert (np.diff(odds) < 0).all()


@pytest.mark.parametrize("outline", ["clear_body", "clear_shadow"])
def test_odds_fall_as_borders_are_less_clear(outline: str) -> None:
    here = painted_region(BOX)
    odds = [log_odds(explanation_of(here, alignment=alignment_of(here, **{outline: share}))) for share in (1, 0.7, 0.3)]
    assert (np.diff(odds) < 0).all()


def test_a_shadow_of_another_hue_than_daylights_is_less_believed() -> None:
    here = painted_region(BOX)
    green = materials_of(here.region, here.ground, here.true_shift + np.array([0, 0, 0.6]))
    assert log_odds(dataclasses.replace(explanation(), materials=green)) < log_odds(explanation())


def test_object_and_shadow_do_not_change_places() -> None:
    here = painted_region(BOX)
    truth = alignment_of(here)
    swapped = dataclasses.replace(truth.placed, predicted=Predicted(here.shadow, here.body))
    changed = dataclasses.replace(explanation(), alignment=dataclasses.replace(truth, placed=swapped))
    assert log_odds(changed) < log_odds(explanation()) - 1


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
@pytest.mark.parametrize("ground", GROUNDS)
def test_the_true_split_scores_higher_than_wrong_ones(ground: str, caster: Caster) -> None:
    here = painted_region(caster, ground=ground)

    def score(split: Split) -> float:
        return split_score(here.region, here.materials, split)

    rows = np.arange(here.body.shape[0])[:, None] < np.median(np.nonzero(here.body)[0])
    truth = score(Split(here.body, here.shadow))
    assert truth > score(Split(here.shadow, here.body))
    assert truth > score(Split(here.body & rows, here.body & ~rows))


@pytest.mark.parametrize("misfit_px", [0.0, 1e-12, 1e3, 1e9])
@pytest.mark.parametrize("spread_deg", [0.0, 1e-9, 60.0, 1e6])
def test_odds_are_finite_at_the_extremes(misfit_px: float, spread_deg: float) -> None:
    extreme = explanation(misfit_px, covariance(spread_deg, 0.0))
    assert np.isfinite(log_odds(extreme))
    _, confidence = best_of([extreme])
    assert 0 <= confidence <= 1


# Several


def directions(*angles_deg: tuple[float, float]) -> Float:
    return np.array([direction(*angles) for angles in angles_deg])


def test_one_explanation_has_no_rivals() -> None:
    for odds in (-30.0, -2.0, 0.0, 4.0, 30.0):
        np.testing.assert_array_equal(contest(np.array([odds]), TO_LIGHT[None]), [odds, 0, 0])


def test_shares_are_logs_of_shares() -> None:
    rng = np.random.default_rng(0)
    for count in range(1, 12):
        odds = rng.normal(0, 5, count)
        best, share, near = contest(odds, np.array([normalised(rng.normal(size=3)) for _ in range(count)]))
        assert best == odds.max()
        assert share <= 1e-12
        assert near <= 1e-12
        assert np.exp(share) >= 1 / count - 1e-12
        assert np.exp(near) >= 1 / count - 1e-12


def test_a_rival_elsewhere_takes_its_share_and_one_nearby_does_not() -> None:
    odds = np.array([1.0, 1.0])
    apart = contest(odds, directions((200, 40), (20, 40)))
    together = contest(odds, directions((200, 40), (203, 42)))
    np.testing.assert_allclose(apart, [1, np.log(0.5), np.log(0.5)])
    np.testing.assert_allclose(together, [1, 0, 0], atol=1e-12)


def test_rivals_of_one_direction_count_once_and_their_word_all_the_same() -> None:
    _, share, near = contest(np.zeros(4), directions((200, 40), (20, 40), (21, 40), (22, 40)))
    assert np.exp(share) == pytest.approx(1 / 2)
    assert np.exp(near) == pytest.approx(1 / 4)


def test_the_weaker_a_rival_the_less_it_takes() -> None:
    shares = [
        contest(np.array([2.0, rival]), directions((200, 40), (20, 40)))[1:] for rival in (2.0, 1.0, 0.0, -3.0, -30.0)
    ]
    assert (np.diff(shares, axis=0) > 0).all()
    np.testing.assert_allclose(shares[-1], 0, atol=1e-8)


def test_the_order_of_explanations_does_not_matter() -> None:
    rng = np.random.default_rng(1)
    odds, towards = rng.normal(0, 2, 9), np.array([normalised(rng.normal(size=3)) for _ in range(9)])
    order = rng.permutation(9)
    np.testing.assert_allclose(contest(odds, towards), contest(odds[order], towards[order]))


def test_within_ten_degrees_is_near() -> None:
    good_deg = np.degrees(GOOD_RAD)
    near, far = (
        contest(np.zeros(2), directions((200, 40), (200, 40 + apart_deg)))[1]
        for apart_deg in (good_deg - 0.1, good_deg + 0.1)
    )
    assert far < near == pytest.approx(0, abs=1e-12)


def test_the_best_explanation_wins_and_a_strong_rival_makes_it_less_believed() -> None:
    good, worse = explanation(0.3), explanation(3.0)
    rival = explanation(0.4, to_light=direction(20.0, 40.0))
    ally = explanation(0.4, to_light=direction(202.0, 41.0))
    alone = best_of([good])
    for others in ([worse], [rival], [ally], [rival, ally, worse]):
        best, confidence = best_of([*others, good])
        assert best is good
        assert 0 < confidence < 1
    assert best_of([rival, good])[1] < alone[1]
    assert best_of([rival, good])[1] < best_of([ally, good])[1]
    assert best_of([worse])[1] < alone[1]


def test_the_likeliest_explanation_is_so_however_little_is_known_of_its_light() -> None:
    vague, poor = explanation(0.3, covariance(40.0, 30.0)), explanation(1.0)
    assert log_odds(vague) < log_odds(poor)
    assert best_of([vague, poor])[0] is poor
    assert likeliest([poor, vague]) is vague
