"""`ashe-live bench light`: the estimators' angular errors on pictures with a known light."""

import os
import platform
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from ashe_live.bench.cases import Case, read_cases
from ashe_live.bench.metrics import GOOD_DEG, ErrorSummary, angular_error_deg, summarise
from ashe_live.core.output_files import cannot_write, write_json
from ashe_live.core.types import LightEstimate
from ashe_live.light.estimator import Estimator, make_estimator

ALL_LIT = "all lit"
SMALL_SET = 12  # up to this many cases every one gets its line


@dataclass(frozen=True, slots=True)
class CaseResult:
    """What one estimator said of one case."""

    estimator: str
    case: str
    category: str
    directional: bool  # whether there is a light to be found
    to_light_marker: tuple[float, ...] | None
    error_deg: float | None  # of the strongest light to the strongest true one; None without either
    reason: str | None
    ms: float


def run_light_bench(
    scenes: Sequence[Path], out: Path | None, estimators: Sequence[str] = ("proxy",), limit: int | None = None
) -> list[CaseResult]:
    """Runs `estimators` on every case with a known light of the folders `scenes`, at most `limit` of each folder.

    Prints a table by category, and with few cases a line each; writes everything to `out` as JSON when given.
    Raises UserError for an unknown estimator, an unreadable folder or an unwritable `out`.
    """
    made = [make_estimator(name) for name in estimators]
    cases = [case for folder in scenes for case in _known(read_cases(folder))[:limit]]
    console = Console()
    results: list[CaseResult] = []
    for estimator in made:
        for index, case in enumerate(track(cases, estimator.name, console=console, transient=True)):
            result = _attempt(estimator, case, index)
            results.append(result)
            if len(cases) <= SMALL_SET:
                said = result.reason if result.error_deg is None else f"{result.error_deg:.1f}°"
                console.print(f"{estimator.name} {case.id}: {said} ({result.ms:.0f} ms)", highlight=False)
        console.print(_table(estimator.name, [result for result in results if result.estimator == estimator.name]))
    if out is not None:
        _write(out, results)
    return results


def summaries(results: Iterable[CaseResult]) -> dict[str, ErrorSummary]:
    """By category in the order of their coming, then all that have a directional light.

    Cases without one have no error; of those, `attempted - abstained` were answered wrongly.
    """
    groups: dict[str, list[CaseResult]] = {}
    lit: list[CaseResult] = []
    for result in results:
        groups.setdefault(result.category, []).append(result)
        if result.directional:
            lit.append(result)
    return {name: _summary(group) for name, group in {**groups, ALL_LIT: lit}.items()}


def _summary(results: Sequence[CaseResult]) -> ErrorSummary:
    errors = [result.error_deg for result in results if result.error_deg is not None]
    abstained = sum(result.to_light_marker is None for result in results)
    return summarise(errors, len(results), abstained, [result.ms for result in results])


def _known(cases: Iterable[Case]) -> list[Case]:
    return [case for case in cases if case.to_lights_marker is not None]


def _attempt(estimator: Estimator, case: Case, index: int) -> CaseResult:
    estimate: LightEstimate = estimator.estimate(case.tracked(index))
    light, truths = estimate.light, case.to_lights_marker
    assert truths is not None
    error_deg = angular_error_deg(light.to_light_marker, truths[0]) if light is not None and len(truths) else None
    to_light = None if light is None else tuple(float(value) for value in light.to_light_marker)
    ms = estimate.timing_ms["total"]
    return CaseResult(estimator.name, case.id, case.category, len(truths) > 0, to_light, error_deg, estimate.reason, ms)


def _table(estimator: str, results: Sequence[CaseResult]) -> Table:
    table = Table(title=f"estimator {estimator}: angular error")
    for heading in (
        "category",
        "cases",
        "none",
        "mean",
        "median",
        "p90",
        "max",
        f"< {GOOD_DEG:.0f}°",
        "median ms",
    ):
        table.add_column(heading, justify="left" if heading == "category" else "right")
    for category, summary in summaries(results).items():
        degrees = (summary.mean_deg, summary.median_deg, summary.p90_deg, summary.max_deg)
        table.add_row(
            category,
            str(summary.attempted),
            str(summary.abstained),
            *("-" if value is None else f"{value:.1f}°" for value in degrees),
            "-" if summary.good_share is None else f"{summary.good_share:.0%}",
            "-" if summary.median_ms is None else f"{summary.median_ms:.0f}",
        )
    return table


def _write(out: Path, results: Sequence[CaseResult]) -> None:
    names = dict.fromkeys(result.estimator for result in results)
    content = {
        "schema": 1,
        "machine": {"cpus": os.cpu_count(), "system": platform.system(), "processor": platform.machine()},
        "versions": {"python": platform.python_version(), "opencv": cv2.__version__, "numpy": np.__version__},
        "summaries": {
            name: {
                category: asdict(summary)
                for category, summary in summaries(result for result in results if result.estimator == name).items()
            }
            for name in names
        },
        "cases": [asdict(result) for result in results],
    }
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot_write(out, error) from error
    write_json(out, content)
