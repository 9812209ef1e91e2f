"""How the judge carries over: each picture judged by tables that were fitted without its families; risk by coverage."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from ashe_live.bench.cases import KINDS
from ashe_live.bench.judge.calibration import Answer
from ashe_live.bench.judge.samples import Candidate, Sample, of_one_view
from ashe_live.bench.metrics import risk_by_coverage
from ashe_live.light.estimators.steps import ProxySteps
from ashe_live.light.explanation.judgement.judge import (
    GOOD_RAD,
    LEAST_PROBABILITY,
    MOST_LOG_ODDS,
    best_direction,
    probabilities_of,
    recalibrated,
)
from ashe_live.light.explanation.judgement.judge_tables import Average, Score

FEWEST_PICTURES = 12  # of a family that is left out
# The share of good answers at a confidence below which none is given. Their stated sigma is tens of degrees then.
LEAST_GOOD = 0.4
BAD_RAD, BAD_CONFIDENCE = np.radians(15.0), 0.5  # of an answer that is sure and wrong
# Kinds of families of which each picture's are left out where it is judged, and the number of parts that they are in.
LEFT_OUT, FOLDS = ("object_family", "ground"), 4
NEWTON_STEPS = 30  # in fitting the recalibration
LEAST_SLOPE = 0.1  # of the log odds of being right over those of the confidence: less tells nothing
# Prior information on how confidence is recalibrated: as much as so many answers of even odds have.
PRIOR_ANSWERS = 4.0

# By the number of looks, the weights that are tried.
WEIGHTS: Mapping[int, Sequence[tuple[float, ...]]] = {1: [(1.0,)], 2: [(0.5, 0.5), (0.6, 0.4), (0.7, 0.3), (0.8, 0.2)]}

Pictures = Sequence[Mapping[ProxySteps, Sample]]  # each by every look at it


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """One picture's likeliest answer."""

    sample: Sample  # of the first look
    best: Candidate | None  # None where nothing was tried
    confidence: float

    @property
    def error_rad(self) -> float:
        return np.pi if self.best is None else self.best.error_rad

    @property
    def is_good(self) -> bool:
        return self.error_rad < GOOD_RAD

    @property
    def is_bad(self) -> bool:
        """Whether it is sure of a wrong answer, or of any where there is no light."""
        return self.error_rad > BAD_RAD and self.confidence > BAD_CONFIDENCE

    @property
    def answer(self) -> Answer | None:
        """None where there is no light, or nothing was tried."""
        if self.best is None or not self.sample.lights:
            return None
        return Answer(self.confidence, self.best.error_by_axis, self.best.covariance_rad2)


def judged(score: Score, looks: Sequence[Sample], average: Average) -> Judged:
    """The answer to a picture by the explanations' score, as the estimator would give it after these looks."""
    candidates: list[Candidate] = []
    probabilities: list[float] = []
    for sample, weight in zip(looks, average.weights, strict=True):
        log_odds = [score.log_odds(candidate.features) for candidate in sample.judged]
        found = probabilities_of(np.clip(log_odds, -MOST_LOG_ODDS, MOST_LOG_ODDS).tolist())
        candidates += sample.judged
        probabilities += (weight * found).tolist()
    if not candidates:
        return Judged(looks[0], None, 0.0)
    index, share = best_direction(np.array(probabilities), [each.to_light_marker for each in candidates])
    return Judged(looks[0], candidates[index], recalibrated(share, average))


def by_families_left_out(
    pictures: Pictures, fit: Callable[[Pictures], Score], steps: ProxySteps, average: Average
) -> Iterator[tuple[str, str, list[Judged]]]:
    """For every kind of family and each family of it: the answers to its pictures, by a fit to all the others.

    steps: by which they are answered.
    """

    for kind in KINDS:
        for family in sorted({_family(picture, kind) for picture in pictures} - {""}):
            held = [picture for picture in pictures if _family(picture, kind) == family]
            rest = [picture for picture in pictures if _family(picture, kind) != family]
            if len(held) >= FEWEST_PICTURES and rest:
                score = fit(rest)
                yield kind, family, [judged(score, looks_by(picture, steps), average) for picture in held]


def scores_by_others(pictures: Pictures, fit: Callable[[Pictures], Score]) -> list[Score]:
    """For each picture the score fitted to those that share neither its part of the objects nor that of the grounds.

    So confidences are of objects and grounds that the score has not seen. Families are dealt to FOLDS parts; pictures
    without stated families follow each other in parts, as those of one scene do.
    """
    parts = list(zip(*(_parts(pictures, kind) for kind in LEFT_OUT), strict=True))

    @cache
    def score(held: tuple[int, ...]) -> Score:
        rest = [
            picture
            for picture, part in zip(pictures, parts, strict=True)
            if all(one != other for one, other in zip(part, held, strict=True))
        ]
        return fit(rest or pictures)

    return [score(part) for part in parts]


def _parts(pictures: Pictures, kind: str) -> list[int]:
    """Each picture's part of FOLDS, by its family of a kind."""
    families = sorted({_family(picture, kind) for picture in pictures} - {""})
    return [
        families.index(family) % FOLDS if (family := _family(picture, kind)) else i * FOLDS // len(pictures)
        for i, picture in enumerate(pictures)
    ]


def _family(picture: Mapping[ProxySteps, Sample], kind: str) -> str:
    return next(iter(picture.values())).tags.get(kind, "")


def fitted_average(pictures: Pictures, scores: Sequence[Score], several: Sequence[ProxySteps], looks: int) -> Average:
    """The average of so many looks with the least risk over all coverages, recalibrated.

    several: steps with so many looks each, by whose answers it is chosen. scores: of each picture.
    """

    def answers(average: Average) -> list[Judged]:
        return [
            judged(score, looks_by(picture, steps), average)
            for steps in several
            for picture, score in zip(pictures, scores, strict=True)
        ]

    tried = [Average(weights) for weights in WEIGHTS[looks]]
    best = min(tried, key=lambda average: mean_risk(answers(average)))
    offset, slope = fitted_confidence(answers(best))
    return Average(best.weights, offset, slope)


def mean_risk(answers: Sequence[Judged]) -> float:
    """The risk on average over all coverages: the area under the curve of risk by coverage."""
    curve = risk_curve(answers)
    covered = np.diff([0.0, *(coverage for _, coverage, _ in curve)])
    return float(covered @ [risk for *_, risk in curve])


def fitted_confidence(answers: Sequence[Judged]) -> tuple[float, float]:
    """Offset and slope of `judge.recalibrated` by which the answers are right as often as their confidences say.

    Logistic regression with a prior about no change, by Newton's method (Platt, 1999).
    """
    inside = np.clip([each.confidence for each in answers], LEAST_PROBABILITY, 1 - LEAST_PROBABILITY)
    design = np.column_stack([np.ones(len(answers)), np.log(inside / (1 - inside))])
    good = np.array([each.is_good for each in answers], dtype=np.float64)
    prior = np.array([0.0, 1.0])
    values = prior.copy()
    for _ in range(NEWTON_STEPS):
        probability = 1 / (1 + np.exp(-design @ values))
        gradient = design.T @ (good - probability) - PRIOR_ANSWERS / 4 * (values - prior)
        information = (design.T * (probability * (1 - probability))) @ design + PRIOR_ANSWERS / 4 * np.eye(2)
        values = values + np.linalg.solve(information, gradient)
    return round(float(values[0]), 3), round(float(max(values[1], 0.0)), 3)


def looks_by(picture: Mapping[ProxySteps, Sample], steps: ProxySteps) -> list[Sample]:
    """The looks at a picture that an estimate with these steps rests on."""
    return [picture[of_one_view(look)] for look in steps.looks]


def risk_curve(answers: Sequence[Judged]) -> list[tuple[float, float, float]]:
    """As `metrics.risk_by_coverage`, of answers that are all given."""
    is_lit = [each.sample.lights > 0 for each in answers]
    good = [each.is_good for each in answers]
    return risk_by_coverage([each.confidence for each in answers], good, is_lit, sum(is_lit))


def least_confidence(answers: Sequence[Judged]) -> float:
    """The confidence, to two decimals, at which LEAST_GOOD of the answers are good, by logistic regression."""
    offset, slope = fitted_confidence(answers)
    return round(float(1 / (1 + np.exp((offset - _log_odds(LEAST_GOOD)) / max(slope, LEAST_SLOPE)))), 2)


def _log_odds(probability: float) -> float:
    return float(np.log(probability / (1 - probability)))
