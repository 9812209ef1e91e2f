"""Fits confidences: averaged over looks, recalibrated, and the least one at which an answer is given."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.bench.judge.calibration import fitted_calibration
from ashe_live.bench.judge.validation import Judged, Pictures, judged, looks_by, mean_risk
from ashe_live.core.arrays import Float, Mask
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.explanation.judgement.judge import LEAST_PROBABILITY, good_if_right, logit
from ashe_live.light.explanation.judgement.judge_tables import Average, Score
from ashe_live.light.explanation.judgement.uncertainty import Calibration, covariance_of_outlines, overdispersed
from ashe_live.quality import LIGHT_PRESETS

# The share of good answers at a confidence below which none is given. Their stated sigma is tens of degrees then.
LEAST_GOOD = 0.4
NEWTON_STEPS, SMALLEST_STEP = 30, 1e-5  # in fitting the recalibration
LEAST_SLOPE = 0.1  # of the log odds of being right over those of the confidence: less tells nothing
# Weight of the prior on the recalibration: that of this many answers with even odds.
PRIOR_ANSWERS = 4.0
# Probabilities of a good direction where outlines leave it open that are tried; the likeliest is taken.
OPEN_TRIED = tuple(i / 20 for i in range(20))
# By the number of looks, the weights that are tried.
WEIGHTS: Mapping[int, Sequence[tuple[float, ...]]] = {1: [(1.0,)], 2: [(0.5, 0.5), (0.6, 0.4), (0.7, 0.3), (0.8, 0.2)]}


@dataclass(frozen=True, slots=True)
class Confidences:
    """What of the judge's tables says how sure an answer is, beside the curves."""

    averages: Mapping[int, Average]  # by the number of looks
    good_if_open: float
    calibration: Calibration
    least_confidence: float


def fitted_confidences(pictures: Pictures, scores: Sequence[Score]) -> tuple[dict[str, list[Judged]], Confidences]:
    """The answers by each preset with the confidences that the estimator states, and what these are fitted as.

    scores: of each picture's explanations, fitted to others.
    """
    looks_of = {name: len(preset.looks) for name, preset in LIGHT_PRESETS.items()}

    def answers_by(averages: Mapping[int, Average]) -> dict[str, list[Judged]]:
        return {
            name: _answers(pictures, scores, preset, averages[looks_of[name]]) for name, preset in LIGHT_PRESETS.items()
        }

    averages = {
        looks: fitted_average(
            pictures, scores, [preset for name, preset in LIGHT_PRESETS.items() if looks_of[name] == looks], looks
        )
        for looks in sorted(set(looks_of.values()))
    }
    answers = answers_by(averages)
    calibration = _calibration([each for several in answers.values() for each in several])
    good_if_open, averages = with_open_directions(
        {
            looks: [each for name in LIGHT_PRESETS if looks_of[name] == looks for each in answers[name]]
            for looks in averages
        },
        averages,
        calibration,
    )
    answers = {name: as_stated(several, calibration, good_if_open) for name, several in answers_by(averages).items()}
    every = [each for several in answers.values() for each in several]
    return answers, Confidences(averages, good_if_open, _calibration(every), least_confidence(every))


def fitted_average(pictures: Pictures, scores: Sequence[Score], several: Sequence[ProxyPreset], looks: int) -> Average:
    """The average of so many looks with the least risk over all coverages, recalibrated.

    several: presets with so many looks each, by whose answers it is chosen. scores: of each picture.
    """

    def answers(average: Average) -> list[Judged]:
        return [each for preset in several for each in _answers(pictures, scores, preset, average)]

    tried = [Average(weights) for weights in WEIGHTS[looks]]
    best = min(tried, key=lambda average: mean_risk(answers(average)))
    offset, slope = fitted_confidence(answers(best))
    return Average(best.weights, offset, slope)


def _answers(pictures: Pictures, scores: Sequence[Score], preset: ProxyPreset, average: Average) -> list[Judged]:
    """A preset's answer to each picture."""
    pairs = zip(pictures, scores, strict=True)
    return [judged(score, looks_by(picture, preset), average) for picture, score in pairs]


def with_open_directions(
    answers: Mapping[int, Sequence[Judged]], averages: Mapping[int, Average], calibration: Calibration
) -> tuple[float, dict[int, Average]]:
    """The tables' `good_if_open` that makes the answers likeliest, and the averages recalibrated beside it.

    answers: by the number of looks, as recalibrated by `averages`.
    """
    # Linear in the share that is sought, so that two values give those of all that are tried.
    none_open, all_open = (
        {looks: _good_if_right(several, calibration, share) for looks, several in answers.items()}
        for share in (0.0, 1.0)
    )

    def refitted(open_: float) -> dict[int, tuple[Float, tuple[float, float]]]:
        factors = {looks: each + open_ * (all_open[looks] - each) for looks, each in none_open.items()}
        return {looks: (each, fitted_confidence(answers[looks], each)) for looks, each in factors.items()}

    def cost(open_: float) -> float:
        return sum(_cost(answers[looks], *fitted) for looks, fitted in refitted(open_).items())

    best = min(OPEN_TRIED, key=cost)
    refits = {looks: fitted for looks, (_, fitted) in refitted(best).items()}
    return best, {looks: _recalibrated(average, *refits[looks]) for looks, average in averages.items()}


def _recalibrated(average: Average, offset: float, slope: float) -> Average:
    """The average with its log odds recalibrated once more."""
    return Average(average.weights, round(offset + slope * average.offset, 3), round(slope * average.slope, 3))


def as_stated(answers: Sequence[Judged], calibration: Calibration, good_if_open: float) -> list[Judged]:
    """The recalibrated answers with the confidences that the estimator states."""
    factors = _good_if_right(answers, calibration, good_if_open)
    return [
        replace(each, confidence=each.confidence * float(factor)) for each, factor in zip(answers, factors, strict=True)
    ]


def _good_if_right(answers: Sequence[Judged], calibration: Calibration, open_: float) -> Float:
    """(n,) `judge.good_if_right` of each answer; 1 where nothing was tried."""
    return np.array(
        [
            1.0
            if each.best is None
            else good_if_right(
                covariance_of_outlines(
                    overdispersed(each.best.covariance_rad2, each.best.unseen_end, calibration.overdispersion)
                ),
                open_,
            )
            for each in answers
        ]
    )


def _cost(answers: Sequence[Judged], factors: Float, fitted: tuple[float, float]) -> float:
    """Minus the log of the likelihood of which answers are good."""
    probability = _probability(_right(_log_odds_of(answers), *fitted), factors)
    return _missed(np.array([each.is_good for each in answers]), probability)


def _right(log_odds: Float, offset: float, slope: float) -> Float:
    """(n,) the probabilities of being right that log odds (n,) are recalibrated to."""
    return np.asarray(np.exp(-np.logaddexp(0.0, -offset - slope * log_odds)))


def _probability(right: Float, factors: Float | float) -> Float:
    """(n,) of being good, by those of being right."""
    return np.asarray(np.clip(factors * right, LEAST_PROBABILITY, 1 - LEAST_PROBABILITY))


def _missed(good: Mask, probability: Float) -> float:
    """Minus the log of the likelihood of what is good."""
    return -float(np.log(np.where(good, probability, 1 - probability)).sum())


def _log_odds_of(answers: Sequence[Judged]) -> Float:
    """(n,) of the answers' confidences."""
    inside = np.clip([each.confidence for each in answers], LEAST_PROBABILITY, 1 - LEAST_PROBABILITY)
    return np.asarray(np.log(inside / (1 - inside)))


def fitted_confidence(answers: Sequence[Judged], factors: Float | float = 1.0) -> tuple[float, float]:
    """Offset and slope of `judge.recalibrated` by which the answers are right as often as their confidences say.

    Logistic regression with a prior about no change, by Fisher's scoring (Platt, 1999). factors: (n,) by which the
    confidences are multiplied then.
    """
    log_odds = _log_odds_of(answers)
    design = np.column_stack([np.ones(len(answers)), log_odds])
    good = np.array([each.is_good for each in answers], dtype=np.bool_)
    prior = np.array([0.0, 1.0])

    def cost(values: Float) -> float:
        missed = _missed(good, _probability(_right(log_odds, *values), factors))
        return missed + PRIOR_ANSWERS / 8 * float(((values - prior) ** 2).sum())

    values, least = prior, cost(prior)
    for _ in range(NEWTON_STEPS):
        right = _right(log_odds, *values)
        probability = _probability(right, factors)
        slopes = factors * right * (1 - right)
        variance = probability * (1 - probability)
        gradient = design.T @ (slopes * (good - probability) / variance) - PRIOR_ANSWERS / 4 * (values - prior)
        information = (design.T * (slopes**2 / variance)) @ design + PRIOR_ANSWERS / 4 * np.eye(2)
        step = np.linalg.solve(information, gradient)
        # Where confidences fit ill, a whole step can lead far past the least cost.
        while (reached := cost(values + step)) > least and np.abs(step).max() > SMALLEST_STEP:
            step = step / 2
        if reached > least:
            break
        values, least = values + step, reached
    return round(float(values[0]), 3), round(float(max(values[1], 0.0)), 3)


def least_confidence(answers: Sequence[Judged]) -> float:
    """The confidence, to two decimals, at which LEAST_GOOD of the answers are good, by logistic regression."""
    offset, slope = fitted_confidence(answers)
    return round(float(1 / (1 + np.exp((offset - logit(LEAST_GOOD)) / max(slope, LEAST_SLOPE)))), 2)


def _calibration(answers: Sequence[Judged]) -> Calibration:
    """The calibration of the answers that are sure enough to be given."""
    least = least_confidence(answers)
    given = [each.answer for each in answers if each.confidence >= least]
    return fitted_calibration([each for each in given if each is not None])
