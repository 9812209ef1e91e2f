"""The estimator's trade-off of error against time: its main parameters, varied one at a time from `balanced`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from ashe_live.bench.cases import Case
from ashe_live.bench.light.results import GOOD_DEG, CaseResult, case_result, timed_estimate
from ashe_live.bench.light.takes import Take
from ashe_live.bench.plots import TradePoint, pareto_front
from ashe_live.bench.tables import figures_table
from ashe_live.light.estimators.estimator import Estimator
from ashe_live.light.estimators.preset import BALANCED, FAST, ProxyPreset
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.outline_fit import preset

MEDIAN_ERROR = "median error, no answer = 90° (degrees)"
MISSED = f"no answer, or more than {GOOD_DEG:.0f}° off (% of the lit scenes)"
COST = "median time of an estimate (ms)"
UNANSWERED_DEG = 90.0


@dataclass(frozen=True, slots=True)
class Variation:
    """`balanced` with some parameters changed."""

    series: str
    name: str
    changes: Mapping[str, Any]  # by field of ProxyPreset; dots separate the names of nested fields

    def preset(self) -> ProxyPreset:
        preset = BALANCED
        for path, value in self.changes.items():
            preset = replaced(preset, path, value)
        return preset


def _varied(series: str, field: str, *values: int) -> tuple[Variation, ...]:
    return tuple(Variation(series, str(value), {field: value}) for value in values)


def _fits(series: str, field: str, *presets: str) -> tuple[Variation, ...]:
    fits = {"fast": preset.FAST, "balanced": preset.BALANCED}
    return tuple(Variation(series, name, {field: fits[name]}) for name in presets)


VARIATIONS = (
    *(
        Variation(
            "working size, coarse and fine", f"{width} px", {"coarse_width_px": width // 2, "fine_width_px": width}
        )
        for width in (320, 480, 640, 960)
    ),
    *_varied("coarse width", "coarse_width_px", 160, 240, 320, 480),
    *_varied("fine width", "fine_width_px", 320, 480, 640, 960),
    *_varied("size of a region", "region_px", 60, 80, 100, 130, 200),
    *_varied("regions", "regions", 1, 2, 3, 5),
    *_varied("colours of the ground", "ground.palette_colours", 4, 7, 10, 16),
    *_varied("shadow colours tried", "shifts", 2, 4, 8, 12),
    *_varied("splits fitted", "tried", 2, 4, 6, 10, 16, 24),
    *_varied("fits refined", "refined", 1, 2, 3, 4, 6),
    *_fits("fine fit", "fine_fit", "fast", "balanced"),
    Variation("second look", "none", {"second_look": None}),
    Variation("second look", "fast", {"second_look": FAST}),
    *_varied("views", "views", 1, 2, 4, 8, 12),
    *_varied("views searched beside the first", "companions", 0, 1, 3),
    *_varied("explanations aligned in all views", "joint", 2, 3, 4, 6),
)


def replaced(record: Any, path: str, value: Any) -> Any:
    """A frozen dataclass with the field at `path` (names joined by dots) changed; TypeError when there is none."""
    name, _, rest = path.partition(".")
    return replace(record, **{name: replaced(getattr(record, name), rest, value) if rest else value})


def sweep(
    cases: Sequence[Case], takes: Sequence[Take], presets: Mapping[str, Estimator], console: Console
) -> list[TradePoint]:
    """Measures every variation and preset on the lit ones of `cases` and `takes`; presets come last.

    All are run on each of them in turn, so that other load on the machine affects them equally. Empty without any.
    """
    tried: list[tuple[str, str, Estimator, bool]] = [
        (variation.series, variation.name, ProxyEstimator(variation.preset()), False) for variation in VARIATIONS
    ]
    tried += [("presets", name, estimator, True) for name, estimator in presets.items()]
    results: list[list[CaseResult]] = [[] for _ in tried]
    pictures: list[tuple[Case, Take | None]] = [(case, None) for case in cases]
    pictures += [(take.case, take) for take in takes]
    lit = [(case, take) for case, take in pictures if case.to_lights_marker is not None and len(case.to_lights_marker)]
    for case, take in track(lit, "trade", console=console, transient=True):
        frames = [case.tracked()] if take is None else take.frames_by_spread()
        if not frames:
            continue
        tracked, *others = frames
        for of_setting, (_, name, estimator, _) in zip(results, tried, strict=True):
            of_setting.append(case_result(name, case, *timed_estimate(estimator, tracked, others)))
    return [
        TradePoint(name, series, float(np.median([one.wall_ms["total"] for one in group])), _errors(group), is_preset)
        for group, (series, name, _, is_preset) in zip(results, tried, strict=True)
        if group
    ]


def print_trade(console: Console, points: Sequence[TradePoint]) -> None:
    """Prints one line per setting; those on the Pareto front of a measure are marked."""
    fronts = {measure: pareto_front(points, measure) for measure in (MEDIAN_ERROR, MISSED)}
    table = figures_table("trade (* on the Pareto front)", "varied", "to", "ms", "median", "missed")
    for point in points:
        median, missed = (
            f"{point.errors[measure]:.1f}{unit}{'*' if point in fronts[measure] else ' '}"
            for measure, unit in ((MEDIAN_ERROR, "°"), (MISSED, " %"))
        )
        table.add_row(point.series, point.name, f"{point.cost:.0f}", median, missed)
    console.print(table)


def _errors(results: Sequence[CaseResult]) -> dict[str, float]:
    errors = np.array([UNANSWERED_DEG if result.error_deg is None else result.error_deg for result in results])
    return {MEDIAN_ERROR: float(np.median(errors)), MISSED: 100 * float(np.mean(errors >= GOOD_DEG))}
