"""`ashe-live bench fit-judge --sheets`: how the shadow of the marker's own sheet counts, beside the tables as they are.

It is independent of objects and of marks at their feet, which all other features share. So two numbers are enough, and
far fewer pictures than the tables need: what full agreement with that shadow adds to the log odds, and what full
disagreement takes from them. A sheet without a shadow says nothing.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import Case, read_cases
from ashe_live.bench.judge.bench import TABLES
from ashe_live.bench.judge.samples import Sample, in_processes, of_one_view, sample_of
from ashe_live.bench.judge.tables import risk_table
from ashe_live.bench.judge.validation import Judged, Pictures, judged, scores_by_others
from ashe_live.core.arrays import Float, Mask
from ashe_live.core.contract import Json
from ashe_live.files.writing import write_json
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.steps import BALANCED, ProxySteps
from ashe_live.light.explanation.judgement.judge import Judge, fitted_judge, probabilities_of
from ashe_live.light.explanation.judgement.judge_tables import Curve, Score, read_tables

FEATURE = "sheet"
LOOK = of_one_view(BALANCED)
HEIGHTS = np.arange(0.0, 4.01, 0.1)  # of either number, of which the likeliest pair is taken
RIDGE = 1.0  # inverse variance of either, as of the steps of all curves
LEAST = 1e-12


@dataclass(frozen=True, slots=True)
class SheetsBench(Bench):
    """Fits the two numbers to the folders `scenes`, cross-validated by families of objects and of grounds."""

    SCHEMA: ClassVar[int] = 1

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every so many-th
    jobs: int = 1  # number of processes that look at pictures

    def parts(self) -> Iterator[Json]:
        tables = fitted_judge().tables
        without = without_sheets(tables.explanation)
        pictures = self._pictures(Judge(replace(tables, explanation=without)))
        score = fitted_to(without, pictures)
        by_others = scores_by_others(pictures, partial(fitted_to, without))
        before = [judged(without, [picture[LOOK]], tables.averages[1]) for picture in pictures]
        after = [
            judged(other, [picture[LOOK]], tables.averages[1])
            for other, picture in zip(by_others, pictures, strict=True)
        ]
        against, _, agreeing = score.curves[FEATURE].log_odds
        self.console.print(f"{against:+.1f} to {agreeing:+.1f} by {len(pictures)} pictures")
        self.console.print(risk_table("the sheet's shadow", {"without": before, "by other families": after}))
        gains = [
            log_likelihood(other, picture[LOOK]) - log_likelihood(without, picture[LOOK])
            for other, picture in zip(by_others, pictures, strict=True)
        ]
        self.console.print(f"mean log score {np.mean(gains):+.3f}")
        for name, several in (("without", before), ("by other families", after)):
            self.console.print(f"{name}: {_counts(several, tables.least_confidence)}")
        origin = {
            "command": f"ashe-live bench fit-judge --sheets --scenes {' '.join(each.name for each in self.scenes)}"
            + ("" if self.limit is None else f" --limit {self.limit}")
            + ("" if self.every == 1 else f" --every {self.every}"),
            "pictures": len(pictures),
            "date": datetime.now(UTC).date().isoformat(),
        }
        fitted = replace(tables, explanation=score, origin=MappingProxyType({**tables.origin, "sheets": origin}))
        yield {"pictures": len(pictures), "tables": fitted.as_json()}

    def plots(self) -> Sequence[str]:
        return (TABLES,)

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        """Writes all tables, as the package loads them, with the two numbers in their place."""
        write_json(out / TABLES, record["tables"], overwrite)

    def _pictures(self, judge: Judge) -> Pictures:
        cases = [case for folder in self.scenes for case in read_cases(folder)[: self.limit : self.every]]
        known = [case for case in cases if case.to_lights_marker is not None]
        looked = partial(_looked_at, json.dumps(judge.tables.as_json()))
        return in_processes(looked, known, self.jobs, self.console, "sheets")


def _looked_at(tables: str, case: Case) -> dict[ProxySteps, Sample]:
    """A picture by one look, by a judge with these tables, in a process of its own."""
    return {LOOK: sample_of(case, ProxyEstimator(LOOK, Judge(read_tables(tables))))}


def without_sheets(score: Score) -> Score:
    curves = {name: curve for name, curve in score.curves.items() if name != FEATURE}
    return Score(score.constant, MappingProxyType(curves))


def fitted_to(without: Score, pictures: Pictures) -> Score:
    """The score, with the sheets' curve, by which it is likeliest which of the explanations are right, or none."""
    samples = [sample for picture in pictures for sample in picture.values() if sample.judged]
    odds = [np.array([without.log_odds(each.features) for each in sample.judged]) for sample in samples]
    cosines = [np.array([each.features[FEATURE] for each in sample.judged]) for sample in samples]
    right = [_right(sample) for sample in samples]

    def penalised(pair: tuple[float, float]) -> float:
        agreeing, against = pair
        total = -RIDGE * (agreeing**2 + against**2)
        for log_odds, cosine, is_right in zip(odds, cosines, right, strict=True):
            by_sheet = np.where(cosine > 0, agreeing, against) * cosine
            total += _log_of_right(log_odds + by_sheet, is_right)
        return total

    agreeing, against = max(((float(a), float(b)) for a in HEIGHTS for b in HEIGHTS), key=penalised)
    curve = Curve((-1.0, 0.0, 1.0), (-round(against, 1), 0.0, round(agreeing, 1)))
    return Score(without.constant, MappingProxyType({**without.curves, FEATURE: curve}))


def log_likelihood(score: Score, sample: Sample) -> float:
    """Log of the probability that a score gives to a picture's right explanations, or to none where none is right."""
    return _log_of_right(np.array([score.log_odds(each.features) for each in sample.judged]), _right(sample))


def _right(sample: Sample) -> Mask:
    most = max((each.rightness for each in sample.judged), default=0)
    return np.array([each.rightness == most > 0 for each in sample.judged], np.bool_)


def _log_of_right(log_odds: Float, is_right: Mask) -> float:
    probabilities = probabilities_of(log_odds.tolist())
    of_right = probabilities[is_right].sum() if is_right.any() else 1 - probabilities.sum()
    return float(np.log(max(float(of_right), LEAST)))


def _counts(several: Sequence[Judged], least: float) -> str:
    given = [each for each in several if each.confidence >= least]
    lit = [each for each in several if each.sample.lights]
    answered = [each for each in given if each.sample.lights]
    return (
        f"{len(answered)} of {len(lit)} lit ones answered, {sum(each.is_good for each in answered)} within 10°, "
        f"{sum(each.is_bad for each in several)} of {len(several)} sure and wrong, "
        f"{len(given) - len(answered)} of {len(several) - len(lit)} without a light answered"
    )
