"""The tables of `ashe-live bench light` for one preset."""

from collections import Counter
from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.table import Table

from ashe_live.bench.light.results import ALL, GOOD_DEG, CaseResult, Summary
from ashe_live.bench.tables import cell, degrees, figures_table, fraction, percent

WORST = 10


def print_preset(
    console: Console,
    name: str,
    summaries: Mapping[str, Summary],
    stages: Mapping[str, Mapping[str, float]],
    results: Sequence[CaseResult],
) -> None:
    """Prints all tables of one preset."""
    console.print(_errors(name, summaries))
    console.print(_shares_of_stages(name, summaries))
    console.print(_honesty(name, summaries))
    console.print(_times(name, stages, summaries[ALL]))
    console.print(_worst(name, results))
    _print_reasons(console, results)


def _errors(name: str, summaries: Mapping[str, Summary]) -> Table:
    columns = ("cases", "none", "mean", "median", "p90", "max", f"< {GOOD_DEG:.0f}°", "count right", "ms", "p95")
    table = figures_table(f"{name}: angular error", "category", *columns)
    for category, summary in summaries.items():
        errors = (summary.mean_deg, summary.median_deg, summary.p90_deg, summary.max_deg)
        table.add_row(
            category,
            str(summary.attempted),
            str(summary.abstained),
            *map(degrees, errors),
            percent(summary.good_share),
            percent(summary.right_count_share),
            *(cell(ms, ".0f") for ms in (summary.median_ms, summary.p95_ms)),
        )
    return table


def _shares_of_stages(name: str, summaries: Mapping[str, Summary]) -> Table:
    """Errors by origin: the masks' overlap with the true ones for segmentation, runs from true labels for geometry."""
    columns = ("IoU object", "IoU shadow", "mean", "from true labels: mean", "median", "max")
    table = figures_table(f"{name}: errors of segmentation and of geometry (medians of IoU)", "category", *columns)
    for category, summary in summaries.items():
        alone = (summary.true_labels_mean_deg, summary.true_labels_median_deg, summary.true_labels_max_deg)
        overlaps = map(fraction, (summary.object_iou, summary.shadow_iou))
        table.add_row(category, *overlaps, *map(degrees, (summary.mean_deg, *alone)))
    return table


def _honesty(name: str, summaries: Mapping[str, Summary]) -> Table:
    columns = ("within 1 σ", "2 σ", "95 % ellipse", "Brier", "wrong with confidence")
    table = figures_table(f"{name}: calibration", "category", *columns)
    for category, summary in summaries.items():
        within = (summary.within_1_sigma, summary.within_2_sigma, summary.within_ellipse_95)
        table.add_row(category, *map(percent, within), fraction(summary.brier), percent(summary.bad_share))
    return table


def _times(name: str, stages: Mapping[str, Mapping[str, float]], everything: Summary) -> Table:
    table = figures_table(f"{name}: milliseconds by stage", "stage", "median", "p95")
    for stage, ms in stages.items():
        table.add_row(stage, *(f"{ms[key]:.1f}" for key in ("p50", "p95")))
    cpu_ms = (everything.median_cpu_ms, everything.p95_cpu_ms)
    table.add_row("total, CPU of all threads", *(cell(ms, ".1f") for ms in cpu_ms))
    return table


def _worst(name: str, results: Sequence[CaseResult]) -> Table:
    """The cases with the largest errors."""
    columns = ("error", "σ", "confidence", "from true labels", "IoU object", "IoU shadow")
    table = figures_table(f"{name}: the largest errors", ("case", "caster"), *columns)
    wrong = [result for result in results if result.error_deg is not None]
    for result in sorted(wrong, key=lambda result: -(result.error_deg or 0.0))[:WORST]:
        errors = map(degrees, (result.error_deg, result.sigma_deg))
        overlaps = map(fraction, (result.object_iou, result.shadow_iou))
        confidence, alone = fraction(result.confidence), degrees(result.true_labels_deg)
        table.add_row(f"{result.folder}/{result.case}", result.caster or "-", *errors, confidence, alone, *overlaps)
    return table


def _print_reasons(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints how often each reason was given for not answering a lit case."""
    reasons = Counter(result.reason for result in results if result.is_lit and not result.is_answered)
    for reason, count in reasons.most_common():
        console.print(f"{count:4d} x {reason}", highlight=False)
