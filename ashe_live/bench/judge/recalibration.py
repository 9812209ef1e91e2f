"""`ashe-live bench fit-judge --confidence`: how sure answers are, by the curves of the judge's tables as they are.

What an estimate looks for, and by how many looks, changes how often its likeliest answer is right; the curves, which
say what makes one explanation likelier than another, stay.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

from ashe_live.bench.judge.confidence import fitted_confidences
from ashe_live.bench.judge.fit import FitBench
from ashe_live.bench.judge.samples import by_every_look
from ashe_live.bench.judge.tables import calibration_table, risk_table
from ashe_live.bench.judge.validation import risk_curve
from ashe_live.core.contract import Json
from ashe_live.light.explanation.judgement.judge import fitted_judge


@dataclass(frozen=True, slots=True)
class RecalibrationBench(FitBench):
    """Fits the confidences to the folders `scenes`, best of pictures that the curves were not fitted to."""

    def parts(self) -> Iterator[Json]:
        judge, cases = fitted_judge(), self.cases()
        pictures = by_every_look(cases, judge, self.jobs, self.console, f"{len(cases)} pictures")
        answers, sure = fitted_confidences(pictures, [judge.tables.explanation] * len(pictures))
        self.console.print(risk_table("by the curves as they are", answers))
        self.console.print(calibration_table(sure.calibration, [each for some in answers.values() for each in some]))
        origin = {**judge.tables.origin, "confidence": self.origin(cases, " --confidence")}
        found = {name: getattr(sure, name) for name in sure.__slots__}
        yield {
            "scenes": self.names,
            "tables": replace(judge.tables, **found, origin=origin).as_json(),
            "averages": {str(looks): asdict(average) for looks, average in sure.averages.items()},
            "risk_by_coverage": {preset: risk_curve(each) for preset, each in answers.items()},
        }
