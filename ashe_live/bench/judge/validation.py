"""How the judge carries over: each picture judged by tables that were fitted without its families; risk by coverage."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.cases import KINDS
from ashe_live.bench.judge.calibration import Answer
from ashe_live.bench.judge.samples import Candidate, Sample
from ashe_live.bench.metrics import risk_by_coverage
from ashe_live.core.arrays import Float
from ashe_live.light.explanation.judge import GOOD_RAD, MOST_LOG_ODDS, best_direction, probabilities_of
from ashe_live.light.explanation.judge_tables import Score

FEWEST_PICTURES = 12  # of a family that is left out
# The share of good answers at a confidence below which none is given. Their stated sigma is tens of degrees then.
LEAST_GOOD = 0.4
BAD_RAD, BAD_CONFIDENCE = np.radians(15.0), 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """One picture's likeliest answer."""

    sample: Sample
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


def judged(score: Score, sample: Sample) -> Judged:
    """The answer to a picture by the explanations' score, as the estimator would give it."""
    if not sample.judged:
        return Judged(sample, None, 0.0)
    log_odds = [score.log_odds(candidate.features) for candidate in sample.judged]
    probabilities = probabilities_of(np.clip(log_odds, -MOST_LOG_ODDS, MOST_LOG_ODDS).tolist())
    index, confidence = best_direction(probabilities, [each.to_light_marker for each in sample.judged])
    return Judged(sample, sample.judged[index], confidence)


def by_families_left_out(
    samples: Sequence[Sample], fit: Callable[[Sequence[Sample]], Score]
) -> Iterator[tuple[str, str, list[Judged]]]:
    """For every kind of family and each family of it: the answers to its pictures by a fit to all the others."""
    for kind in KINDS:
        for family in sorted({sample.tags.get(kind, "") for sample in samples} - {""}):
            held = [sample for sample in samples if sample.tags.get(kind) == family]
            rest = [sample for sample in samples if sample.tags.get(kind) != family]
            if len({sample.case for sample in held}) >= FEWEST_PICTURES and rest:
                score = fit(rest)
                yield kind, family, [judged(score, sample) for sample in held]


def risk_curve(answers: Sequence[Judged]) -> list[tuple[float, float, float]]:
    """As `metrics.risk_by_coverage`, of answers that are all given."""
    is_lit = [each.sample.lights > 0 for each in answers]
    good = [each.is_good for each in answers]
    return risk_by_coverage([each.confidence for each in answers], good, is_lit, sum(is_lit))


def least_confidence(answers: Sequence[Judged]) -> float:
    """The confidence below which fewer than LEAST_GOOD of the answers are good, by isotonic regression.

    To two decimals; pool adjacent violators (Ayer et al., 1955).
    """
    ranked = sorted(answers, key=lambda each: each.confidence)
    fitted = isotonic(np.array([float(each.is_good) for each in ranked]))
    above = [each.confidence for each, share in zip(ranked, fitted, strict=True) if share >= LEAST_GOOD]
    return round(min(above, default=1.0), 2)


def isotonic(values: Float) -> Float:
    """(n,) the rising values nearest to `values` (n,) by least squares."""
    blocks: list[tuple[float, int]] = []
    for value in values:
        mean, size = float(value), 1
        while blocks and blocks[-1][0] >= mean:
            other, count = blocks.pop()
            mean, size = (mean * size + other * count) / (size + count), size + count
        blocks.append((mean, size))
    return np.concatenate([np.full(size, mean) for mean, size in blocks]) if blocks else np.empty(0)
