"""What the benches that fit the judge's tables share: which pictures they take, and the tables that they write."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import Case, cases_of
from ashe_live.core.contract import Json
from ashe_live.errors import UserError
from ashe_live.files.writing import write_json

TABLES = "judge.json"


@dataclass(frozen=True, slots=True)
class FitBench(Bench):
    """A bench that fits all or some of the judge's tables, `tables` in its record, to the folders `scenes`."""

    scenes: Sequence[Path]
    limit: int | None = None  # number of pictures of each folder, the first ones; None: all
    every: int = 1  # of these, only every `every`th
    jobs: int = 1  # number of processes that look at pictures

    def plots(self) -> Sequence[str]:
        return (TABLES,)

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        """Writes the tables alone too, as the package loads them."""
        write_json(out / TABLES, record["tables"], overwrite)

    def cases(self) -> list[Case]:
        """The pictures that it fits to, whose lights are known; raises UserError where there is none."""
        several = cases_of(self.scenes, self.limit, self.every)
        known = [case for case in several if case.to_lights_marker is not None]
        if not known:
            raise UserError("there is no picture with a known light in these sets", "give a training set of scenes")
        return known

    def origin(self, cases: Sequence[Case], options: str = "") -> Json:
        """The command, with these `options`, and the pictures that tables come from."""
        limit = "" if self.limit is None else f" --limit {self.limit}"
        every = "" if self.every == 1 else f" --every {self.every}"
        return {
            "command": f"ashe-live bench fit-judge{options} --scenes {' '.join(self.names)}{limit}{every}",
            "scenes": self.names,
            "pictures": len(cases),
            "categories": dict(sorted(Counter(case.category for case in cases).items())),
            "date": datetime.now(UTC).date().isoformat(),
        }

    @property
    def names(self) -> list[str]:
        """Of the folders."""
        return [folder.resolve().name for folder in self.scenes]
