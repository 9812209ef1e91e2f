"""`ashe-live bench fit-judge`: fits the tables of the judge to sets of pictures whose lights are known."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import ClassVar

from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import Case, read_cases
from ashe_live.bench.judge.calibration import fitted_calibration
from ashe_live.bench.judge.logit import fitted_score
from ashe_live.bench.judge.samples import Sample, sample_of
from ashe_live.bench.judge.tables import calibration_table, error_of, families_table, risk_table, score_table
from ashe_live.bench.judge.validation import (
    by_families_left_out,
    judged,
    least_confidence,
    risk_curve,
)
from ashe_live.core.contract import Json
from ashe_live.files.writing import write_json
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.estimators.steps import PRESETS
from ashe_live.light.explanation.evidence import SIGNS
from ashe_live.light.explanation.judge import Judge
from ashe_live.light.explanation.judge_tables import Curve, Score, Tables
from ashe_live.light.explanation.uncertainty import Calibration

TABLES = "judge.json"
# The first round has no tables yet: every feature counts one unit of log odds over these ranges.
FIRST_RANGES = {
    "misfit": (-5.0, -3.5),
    "clear body": (0.0, 1.0),
    "clear shadow": (0.0, 1.0),
    "flat": (0.0, 1.0),
    "contrast": (-0.5, 0.5),
    "sunlit": (-1.0, 2.0),
    "hue": (0.0, 0.2),
    "brightness": (0.0, 0.3),
    "short": (0.0, 2.0),
    "long": (0.0, 1.0),
    "lit side": (-0.5, 0.9),
    "missed": (-3.0, -1.0),
    "edge": (0.0, 1.0),
    "border": (0.0, 1.0),
    "second": (0.0, 1.0),
    "constrained": (-2.0, 0.0),
}
OF_SPLITS = ("hue", "brightness", "short", "long", "lit side", "missed", "edge", "border", "second")
WEIGHT = 1 / len(PRESETS)  # all presets look at the same pictures, which are to count once
ROUNDS = (3, 1)  # of which every so many-th picture is explained: the first only finds which features matter


@dataclass(frozen=True, slots=True)
class JudgeBench(Bench):
    """Fits the judge to the folders `scenes`, with all presets' explanations of each picture.

    In the first round all features count alike; in the next, the explanations are those that its judge refines.
    The same pictures give the same tables.
    """

    SCHEMA: ClassVar[int] = 1

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every so many-th

    def parts(self) -> Iterator[Json]:
        cases = [case for folder in self.scenes for case in read_cases(folder)[: self.limit : self.every]]
        cases = [case for case in cases if case.to_lights_marker is not None]
        judge = Judge(first_tables())
        for every in ROUNDS:
            chosen = cases[::every]
            samples = self._samples(chosen, judge, f"{len(chosen)} of {len(cases)} pictures")
            judge = Judge(self._fitted(chosen, samples))
        answers = [judged(judge.tables.explanation, sample) for sample in samples]
        held_out = list(by_families_left_out(samples, explanation_score))
        self.console.print(score_table("explanations", judge.tables.explanation))
        self.console.print(score_table("splits", judge.tables.split))
        self.console.print(families_table(held_out))
        self.console.print(risk_table("fitted to these pictures", answers))
        self.console.print(calibration_table(judge.tables.calibration, answers))
        yield {
            "scenes": [folder.resolve().name for folder in self.scenes],
            "tables": judge.tables.as_json(),
            "left_out": [
                {"kind": kind, "family": family, "answers": len(each), "calibration_error": error_of(each)}
                for kind, family, each in held_out
            ],
            "risk_by_coverage": risk_curve(answers),
        }

    def plots(self) -> Sequence[str]:
        return (TABLES,)

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        """Writes the tables alone too, as the package loads them."""
        write_json(out / TABLES, record["tables"], overwrite)

    def _command(self) -> str:
        folders = " ".join(folder.resolve().name for folder in self.scenes)
        limit = "" if self.limit is None else f" --limit {self.limit}"
        every = "" if self.every == 1 else f" --every {self.every}"
        return f"ashe-live bench fit-judge --scenes {folders}{limit}{every}"

    def _samples(self, cases: Sequence[Case], judge: Judge, what: str) -> list[Sample]:
        estimators = {preset: ProxyEstimator(steps, judge) for preset, steps in PRESETS.items()}
        return [
            sample_of(case, preset, estimator)
            for case in track(cases, what, console=self.console, transient=True)
            for preset, estimator in estimators.items()
        ]

    def _fitted(self, cases: Sequence[Case], samples: Sequence[Sample]) -> Tables:
        explanation = explanation_score(samples)
        split = fitted_score([sample.splits for sample in samples if sample.splits], WEIGHT)
        answers = [judged(explanation, sample) for sample in samples]
        least = least_confidence(answers)
        given = [each.answer for each in answers if each.confidence >= least]
        origin = {
            "command": self._command(),
            "scenes": [folder.resolve().name for folder in self.scenes],
            "pictures": len(cases),
            "categories": dict(sorted(Counter(case.category for case in cases).items())),
            "date": datetime.now(UTC).date().isoformat(),
        }
        calibration = fitted_calibration([each for each in given if each is not None])
        return Tables(split, explanation, least, calibration, origin)


def explanation_score(samples: Sequence[Sample]) -> Score:
    return fitted_score([sample.judged for sample in samples if sample.judged], WEIGHT)


def first_tables() -> Tables:
    """Tables by which every feature counts alike."""

    def score(names: Sequence[str]) -> Score:
        return Score(0.0, {name: Curve(FIRST_RANGES[name], (0.0, float(SIGNS[name]))) for name in names})

    return Tables(score(OF_SPLITS), score(list(FIRST_RANGES)), 0.5, Calibration(1.0, 0.5, 2.0), {})
