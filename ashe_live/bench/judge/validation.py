"""How the judge carries over: each picture judged by tables that were fitted without its families; risk by coverage."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from ashe_live.bench.cases import KINDS
from ashe_live.bench.judge.calibration import Answer
from ashe_live.bench.judge.samples import Candidate, Sample, of_one_view, with_mean_light
from ashe_live.bench.metrics import BAD_CONFIDENCE, BAD_DEG, risk_by_coverage
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.light.explanation.judgement.judge import (
    GOOD_RAD,
    MOST_LOG_ODDS,
    likeliest_direction,
    probabilities_of,
    recalibrated,
)
from ashe_live.light.explanation.judgement.judge_tables import Average, Score

FEWEST_PICTURES = 12  # least number of a family's pictures for it to be left out
# Kinds of families of which each picture's are left out where it is judged, and the number of parts that they are in.
LEFT_OUT, FOLDS = ("object_family", "ground"), 4

Pictures = Sequence[Mapping[ProxyPreset, Sample]]  # each by every look at it


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
        return self.error_rad > np.radians(BAD_DEG) and self.confidence > BAD_CONFIDENCE

    @property
    def answer(self) -> Answer | None:
        """None where there is no light, or nothing was tried."""
        if self.best is None or not self.sample.lights:
            return None
        return Answer(self.confidence, self.best.error_by_axis, self.best.covariance_rad2, self.best.unseen_end)


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
    counts = [each.lights for each in candidates]
    group, share = likeliest_direction(np.array(probabilities), [each.to_light_marker for each in candidates], counts)
    alike = [(candidates[i], probabilities[i]) for i in np.flatnonzero(group)]
    alike.sort(key=lambda each: each[1], reverse=True)
    best = with_mean_light(alike[0][0], alike, looks[0].truths)
    return Judged(looks[0], best, recalibrated(share, average))


def by_families_left_out(
    pictures: Pictures, fit: Callable[[Pictures], Score], preset: ProxyPreset, average: Average
) -> Iterator[tuple[str, str, list[Judged]]]:
    """For every kind of family and each family of it: the answers to its pictures, by a fit to all the others.

    preset: by which they are answered.
    """
    for kind in KINDS:
        for family in sorted({_family(picture, kind) for picture in pictures} - {""}):
            held = [picture for picture in pictures if _family(picture, kind) == family]
            rest = [picture for picture in pictures if _family(picture, kind) != family]
            if len(held) >= FEWEST_PICTURES and rest:
                score = fit(rest)
                yield kind, family, [judged(score, looks_by(picture, preset), average) for picture in held]


def scores_by_others(pictures: Pictures, fit: Callable[[Pictures], Score]) -> list[Score]:
    """For each picture, the score fitted to pictures that share neither its part of the objects nor of the grounds.

    So the score has seen neither the objects nor the grounds that it judges. Families are dealt to FOLDS parts;
    pictures without stated families follow each other in parts, as those of one scene do.
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


def _family(picture: Mapping[ProxyPreset, Sample], kind: str) -> str:
    return next(iter(picture.values())).tags.get(kind, "")


def mean_risk(answers: Sequence[Judged]) -> float:
    """The risk on average over all coverages: the area under the curve of risk by coverage."""
    curve = risk_curve(answers)
    covered = np.diff([0.0, *(coverage for _, coverage, _ in curve)])
    return float(covered @ [risk for *_, risk in curve])


def looks_by(picture: Mapping[ProxyPreset, Sample], preset: ProxyPreset) -> list[Sample]:
    """The looks at a picture that an estimate by this preset rests on."""
    return [picture[of_one_view(look)] for look in preset.looks]


def risk_curve(answers: Sequence[Judged]) -> list[tuple[float, float, float]]:
    """As `metrics.risk_by_coverage`, of answers that are all given."""
    is_lit = [each.sample.lights > 0 for each in answers]
    good = [each.is_good for each in answers]
    return risk_by_coverage([each.confidence for each in answers], good, is_lit, sum(is_lit))
