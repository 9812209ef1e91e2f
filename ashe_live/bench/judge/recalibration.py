"""`ashe-live bench fit-judge --confidence`: how sure answers are, by the curves of the judge's tables as they are.

What an estimate looks for, and by how many looks, changes how often its likeliest answer is right; the curves, which
say what makes one explanation likelier than another, stay.
"""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import ClassVar

from ashe_live.bench.bench import Bench
from ashe_live.bench.judge.bench import TABLES
from ashe_live.bench.judge.confidence import fitted_confidences
from ashe_live.bench.judge.origin import cases_to_fit, origin_of
from ashe_live.bench.judge.samples import by_every_look
from ashe_live.bench.judge.tables import calibration_table, risk_table
from ashe_live.bench.judge.validation import risk_curve
from ashe_live.core.contract import Json
from ashe_live.files.writing import write_json
from ashe_live.light.explanation.judgement.judge import fitted_judge


@dataclass(frozen=True, slots=True)
class RecalibrationBench(Bench):
    """Fits the confidences to the folders `scenes`, best of pictures that the curves were not fitted to."""

    SCHEMA: ClassVar[int] = 1

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every `every`th
    jobs: int = 1  # number of processes that look at pictures

    def parts(self) -> Iterator[Json]:
        judge, cases = fitted_judge(), cases_to_fit(self.scenes, self.limit, self.every)
        pictures = by_every_look(cases, judge, self.jobs, self.console, f"{len(cases)} pictures")
        answers, sure = fitted_confidences(pictures, [judge.tables.explanation] * len(pictures))
        self.console.print(risk_table("by the curves as they are", answers))
        self.console.print(calibration_table(sure.calibration, [each for some in answers.values() for each in some]))
        origin = {
            **judge.tables.origin,
            "confidence": origin_of(" --confidence", self.scenes, self.limit, self.every, cases),
        }
        found = {name: getattr(sure, name) for name in sure.__slots__}
        yield {
            "scenes": [folder.resolve().name for folder in self.scenes],
            "tables": replace(judge.tables, **found, origin=origin).as_json(),
            "averages": {str(looks): asdict(average) for looks, average in sure.averages.items()},
            "risk_by_coverage": {preset: risk_curve(each) for preset, each in answers.items()},
        }

    def plots(self) -> Sequence[str]:
        return (TABLES,)

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        """Writes all tables, as the package loads them, with the confidences in their place."""
        write_json(out / TABLES, record["tables"], overwrite)
