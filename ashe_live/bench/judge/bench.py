"""`ashe-live bench fit-judge`: fits the tables of the judge to sets of pictures whose lights are known."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from ashe_live.bench.cases import Case
from ashe_live.bench.judge.confidence import fitted_confidences
from ashe_live.bench.judge.fit import FitBench
from ashe_live.bench.judge.logit import fitted_score
from ashe_live.bench.judge.samples import LOOKS, by_every_look
from ashe_live.bench.judge.tables import calibration_table, error_of, families_table, risk_table, score_table
from ashe_live.bench.judge.validation import Judged, Pictures, by_families_left_out, risk_curve, scores_by_others
from ashe_live.core.contract import Json
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.judgement.evidence import SIGNS
from ashe_live.light.explanation.judgement.judge import Judge
from ashe_live.light.explanation.judgement.judge_tables import Curve, Score, Tables
from ashe_live.light.explanation.judgement.uncertainty import Calibration

# The first round has no tables yet: every feature counts one unit of log odds over these ranges.
FIRST_RANGES = {
    "misfit": (-5.0, -3.5),
    "steps": (0.0, 2.0),
    "family": (0.0, 0.3),
    "uneven": (0.1, 0.4),
    "clear shadow": (0.0, 1.0),
    "flat": (0.0, 1.0),
    "contrast": (-0.5, 0.5),
    "sunlit": (-1.0, 2.0),
    "hue": (0.0, 0.2),
    "brightness": (0.0, 0.3),
    "short": (0.0, 2.0),
    "long": (0.0, 1.0),
    "missed": (-3.0, -1.0),
    "shaded": (2.0, 16.0),
    "in shadow": (0.0, 0.5),
    "lit": (0.0, 0.5),
    "edge": (0.0, 1.0),
    "border": (0.0, 1.0),
    "second": (0.0, 1.0),
    "grazing": (0.0, 0.2),
    "constrained": (-2.0, 0.0),
    "agreeing": (0.0, 1.0),
    "sheet": (-2.0, 1.0),
}
OF_SPLITS = ("hue", "brightness", "short", "long", "missed", "shaded", "edge", "border", "second")
WEIGHT = 1 / len(LOOKS)  # of a look: all look at the same pictures, each of which is to count once
# The first round takes every FIRST_EVERYth picture and fits FIRST_TRIED of its splits, to learn which are worth it.
FIRST_EVERY, FIRST_TRIED = 3, 24


@dataclass(frozen=True, slots=True)
class JudgeBench(FitBench):
    """Fits the judge to the folders `scenes`, with the explanations of each picture by all presets' looks.

    In the first round all features count alike, and more splits than usual are fitted; splits are judged by what
    followed from them. In the second, the explanations are those that the first round's judge fits and refines. The
    same pictures give the same tables.
    """

    def parts(self) -> Iterator[Json]:
        cases = self.cases()
        few = cases[::FIRST_EVERY]
        looked, what = partial(by_every_look, jobs=self.jobs, console=self.console), f"{len(cases)} pictures"
        first = looked(few, Judge(first_tables()), what=f"{len(few)} of {what}", tried=FIRST_TRIED)
        splits = splits_score(first)
        judge = Judge(self._fitted(few, first, splits)[1])
        pictures = looked(cases, judge, what=what)
        answers, tables = self._fitted(cases, pictures, splits)
        families = list(by_families_left_out(pictures, explanation_score, BALANCED, tables.averages[1]))
        every_answer = [each for several in answers.values() for each in several]
        self.console.print(score_table("explanations", tables.explanation))
        self.console.print(score_table("splits", tables.split))
        self.console.print(families_table(families))
        self.console.print(risk_table("by fits to other scenes", answers))
        self.console.print(calibration_table(tables.calibration, every_answer))
        yield {
            "scenes": self.names,
            "tables": tables.as_json(),
            "left_out": [
                {"kind": kind, "family": family, "answers": len(each), "calibration_error": error_of(each)}
                for kind, family, each in families
            ],
            "risk_by_coverage": {preset: risk_curve(each) for preset, each in answers.items()},
        }

    def _fitted(
        self, cases: Sequence[Case], pictures: Pictures, splits: Score
    ) -> tuple[dict[str, list[Judged]], Tables]:
        """The answers by fits to other scenes, by preset; and the tables, of which confidences are fitted to these."""
        explanation = explanation_score(pictures)
        answers, sure = fitted_confidences(pictures, scores_by_others(pictures, explanation_score))
        averages, least, calibration = sure.averages, sure.least_confidence, sure.calibration
        origin = self.origin(cases)
        return answers, Tables(splits, explanation, averages, least, calibration, origin, sure.good_if_open)


def explanation_score(pictures: Pictures) -> Score:
    """The explanations' score, fitted to all looks at these pictures."""
    samples = [sample for picture in pictures for sample in picture.values()]
    return fitted_score([sample.judged for sample in samples if sample.judged], WEIGHT)


def splits_score(pictures: Pictures) -> Score:
    """The splits' score, fitted to what came of those that were tried in all looks at these pictures."""
    samples = [sample for picture in pictures for sample in picture.values()]
    return fitted_score([sample.splits for sample in samples if sample.splits], WEIGHT)


def first_tables() -> Tables:
    """Tables by which every feature counts alike."""

    def score(names: Sequence[str]) -> Score:
        return Score(0.0, {name: Curve(FIRST_RANGES[name], (0.0, float(SIGNS[name]))) for name in names})

    return Tables(score(OF_SPLITS), score(list(FIRST_RANGES)), {}, 0.5, Calibration(1.0, 0.5, 2.0), {})
