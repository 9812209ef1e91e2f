"""The base of all benches: each measures, prints, and writes one record with the machine and versions it ran on."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from rich.console import Console

from ashe_live.bench.machine import header_json, measured_with
from ashe_live.bench.plots import check_can_draw
from ashe_live.bench.tables import bench_console
from ashe_live.core.contract import Json
from ashe_live.files.writing import check_folder, make_folder, write_json

RESULTS = "results.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench(ABC):
    """A bench; its fields are its settings."""

    SCHEMA: ClassVar[int] = 1  # version of its record; incremented when a figure changes its name or meaning
    NEEDS_OPENGL: ClassVar[bool] = False
    console: Console = field(default_factory=bench_console)

    def run(self, out: Path | None = None, overwrite: bool = False) -> Json:
        """Measures, prints, and writes results.json and the plots into the folder `out`; returns the record.

        Raises UserError for an unwritable `out`, when the measurement is impossible (an unknown estimator, an
        unreadable folder, no OpenGL), or when plots are to be drawn and Matplotlib is missing.
        """
        if out is not None:
            plots = self.plots()
            if plots:
                check_can_draw()
            check_folder(out, (RESULTS, *plots), overwrite)
        record = header_json(self.SCHEMA, self.NEEDS_OPENGL)
        self.console.print(measured_with(record), highlight=False)
        written: Path | None = None
        for part in self.parts():
            record |= _with_nulls(part)
            if out is not None:  # at once, so that an interruption of the next part loses nothing of this one
                make_folder(out)
                written = write_json(written or out / RESULTS, record, overwrite or written is not None, beside=True)
        if out is not None:
            self.draw(record, out, overwrite)
        return record

    @abstractmethod
    def parts(self) -> Iterator[Json]:
        """Measures and prints, yielding the record part by part."""

    def plots(self) -> Sequence[str]:
        """The names of the files that `draw` writes."""
        return ()

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:  # noqa: B027 - a bench without plots draws nothing
        """Writes the plots of the record into the folder `out`; keeps existing files unless `overwrite`."""


def _with_nulls(value: Any) -> Any:
    """`value` for JSON, which has null for numbers that could not be measured."""
    if isinstance(value, Mapping):
        return {key: _with_nulls(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_with_nulls(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
