"""The printed tables of `ashe-live bench light`."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from ashe_live.bench.light.clips import EVERY, ClipResult
from ashe_live.bench.light.lamps import FAR_M, FARTHEST_M, NEAR_M, summarise_lamps
from ashe_live.bench.light.results import ALL, CONFIDENT_DEG, GOOD_DEG, CaseResult, Summary, summarise
from ashe_live.bench.light.takes import TakeResult, confidence_falls, grouped_by_span, p95_deg
from ashe_live.bench.light.targets import DEG, MS, Verdict
from ashe_live.bench.metrics import calibration_error, risk_at, risk_by_coverage, share

WORST = 10
# Distances of lights, above the first and up to the second.
DISTANCES = {
    "sun": (FARTHEST_M, math.inf),
    f"lamp up to {100 * NEAR_M:.0f} cm": (0.0, NEAR_M),
    f"up to {100 * FAR_M:.0f} cm": (NEAR_M, FAR_M),
    "farther": (FAR_M, FARTHEST_M),
    "all lamps": (0.0, FARTHEST_M),
}
COVERAGES = (0.5, 0.6, 0.7, 0.8, 0.9)


def print_preset(
    console: Console,
    name: str,
    summaries: Mapping[str, Summary],
    stages: Mapping[str, Mapping[str, float]],
    results: Sequence[CaseResult],
    verdicts: Iterable[Verdict],
) -> None:
    """Prints all tables of one preset."""
    console.print(_errors(name, summaries))
    console.print(_shares_of_stages(name, summaries))
    console.print(_honesty(name, summaries))
    console.print(_times(name, stages, summaries[ALL]))
    console.print(_worst(name, results))
    _print_reasons(console, results)
    console.print(_targets(name, verdicts))


def print_risk(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints risk by coverage, set by set and preset by preset: more work should never answer less, or worse."""
    columns = ("lit", "answered", *(f"risk at {coverage:.0%}" for coverage in COVERAGES), "calibration error")
    table = _table(f"risk (answers over {CONFIDENT_DEG:.0f}° off) by coverage", ("set", "preset"), columns)
    for folder in dict.fromkeys(result.folder for result in results):
        for preset in dict.fromkeys(result.preset for result in results):
            members = [each for each in results if (each.folder, each.preset) == (folder, preset)]
            answers = [each for each in members if each.confidence is not None]
            lit = sum(each.is_lit for each in members)
            confidences, good = [each.confidence or 0.0 for each in answers], [each.is_good for each in answers]
            curve = risk_by_coverage(confidences, good, [each.is_lit for each in answers], lit)
            risks = [risk_at(curve, coverage) for coverage in COVERAGES]
            covered = share([each.is_answered for each in members if each.is_lit])
            cells = (_percent(None if risk is None else risk[1]) for risk in risks)
            error = calibration_error(confidences, good)
            table.add_row(folder, preset, str(lit), _percent(covered), *cells, _fraction(error))
    console.print(table)


def print_takes(console: Console, results: Sequence[TakeResult]) -> None:
    """Prints, for each preset, errors and confidence by the takes' span and the number of views."""
    columns = ("lit", "answered", "median", "p95", "within 1 σ", "95 % ellipse", "sure and wrong", "confidence", "ms")
    for preset in dict.fromkeys(each.result.preset for each in results):
        table = _table(f"{preset}: takes by span and number of views", ("span", "views"), columns)
        members = [each for each in results if each.result.preset == preset]
        for span, of_span in grouped_by_span(members).items():
            for views in dict.fromkeys(each.views for each in of_span):
                some = summarise([each.result for each in of_span if each.views == views])
                answered = [each for each in of_span if each.views == views and each.result.is_lit]
                p95 = p95_deg([each.result for each in answered])
                table.add_row(
                    span,
                    str(views),
                    str(len(answered)),
                    _percent(share([each.result.is_answered for each in answered])),
                    _degrees(some.median_deg),
                    _degrees(p95),
                    *map(_percent, (some.within_1_sigma, some.within_ellipse_95, some.bad_share)),
                    _fraction(_mean([each.result.confidence for each in answered])),
                    "-" if some.median_ms is None else f"{some.median_ms:.0f}",
                )
        console.print(table)
        falls = confidence_falls(members)
        console.print(
            f"right answers whose confidence falls by more than 0.02 with more views: {falls[0]} of {falls[1]}"
        )


def print_lamps(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints how lamps and suns were told apart, set by set, if there is a lamp in any."""
    alone = [(result, result.lamp) for result in results if result.lamp is not None]
    if not any(lamp.true_distance_m for _, lamp in alone):
        return
    columns = (
        "pictures",
        "answered",
        "as a lamp",
        "median",
        "p90",
        "beside the object",
        "distance off",
        "q within 1 σ",
    )
    table = _table("one light, by its distance: error of the direction at the marker, and beside", ("set", ""), columns)
    for folder, preset in dict.fromkeys((result.folder, result.preset) for result, _ in alone):
        of_set = [pair for pair in alone if (pair[0].folder, pair[0].preset) == (folder, preset)]
        for kind, (least_m, most_m) in DISTANCES.items():
            members = [pair for pair in of_set if least_m < (pair[1].true_distance_m or math.inf) <= most_m]
            if not members:
                continue
            summary = summarise_lamps([lamp for _, lamp in members], [result.is_answered for result, _ in members])
            errors = [result.error_deg for result, _ in members if result.error_deg is not None]
            at_marker = [_degrees(float(np.percentile(errors, part)) if errors else None) for part in (50, 90)]
            table.add_row(
                f"{folder}, {preset}",
                kind,
                str(summary.attempted),
                _percent(summary.answered),
                _percent(summary.stated),
                *at_marker,
                _degrees(summary.beside_deg),
                _percent(summary.distance_error),
                _percent(summary.within_1_sigma),
            )
    console.print(table)


def print_clips(console: Console, clips: Sequence[ClipResult]) -> None:
    table = _table(
        f"clips: every {EVERY}th frame", ("clip", "preset"), ("frames", "no marker", "none", "about", "RMS", "max")
    )
    for clip in clips:
        counts = (str(count) for count in (clip.frames, clip.without_marker, clip.abstained))
        table.add_row(clip.clip, clip.preset, *counts, clip.about, _degrees(clip.rms_deg), _degrees(clip.max_deg))
    console.print(table)


def _errors(name: str, summaries: Mapping[str, Summary]) -> Table:
    columns = ("cases", "none", "mean", "median", "p90", "max", f"< {GOOD_DEG:.0f}°", "count right", "ms", "p95")
    table = _table(f"{name}: angular error", ("category",), columns)
    for category, summary in summaries.items():
        errors = (summary.mean_deg, summary.median_deg, summary.p90_deg, summary.max_deg)
        table.add_row(
            category,
            str(summary.attempted),
            str(summary.abstained),
            *map(_degrees, errors),
            _percent(summary.good_share),
            _percent(summary.right_count_share),
            *("-" if ms is None else f"{ms:.0f}" for ms in (summary.median_ms, summary.p95_ms)),
        )
    return table


def _shares_of_stages(name: str, summaries: Mapping[str, Summary]) -> Table:
    """Errors by origin: the masks' overlap with the true ones for segmentation, runs from true labels for geometry."""
    columns = ("IoU object", "IoU shadow", "mean", "from true labels: mean", "median", "max")
    table = _table(f"{name}: errors of segmentation and of geometry (medians of IoU)", ("category",), columns)
    for category, summary in summaries.items():
        alone = (summary.true_labels_mean_deg, summary.true_labels_median_deg, summary.true_labels_max_deg)
        overlaps = map(_fraction, (summary.object_iou, summary.shadow_iou))
        table.add_row(category, *overlaps, *map(_degrees, (summary.mean_deg, *alone)))
    return table


def _honesty(name: str, summaries: Mapping[str, Summary]) -> Table:
    columns = ("within 1 σ", "2 σ", "95 % ellipse", "Brier", "wrong with confidence")
    table = _table(f"{name}: calibration", ("category",), columns)
    for category, summary in summaries.items():
        within = (summary.within_1_sigma, summary.within_2_sigma, summary.within_ellipse_95)
        table.add_row(category, *map(_percent, within), _fraction(summary.brier), _percent(summary.bad_share))
    return table


def _times(name: str, stages: Mapping[str, Mapping[str, float]], everything: Summary) -> Table:
    table = _table(f"{name}: milliseconds by stage", ("stage",), ("median", "p95"))
    for stage, ms in stages.items():
        table.add_row(stage, *(f"{ms[key]:.1f}" for key in ("p50", "p95")))
    cpu_ms = (everything.median_cpu_ms, everything.p95_cpu_ms)
    table.add_row("total, CPU of all threads", *("-" if ms is None else f"{ms:.1f}" for ms in cpu_ms))
    return table


def _targets(name: str, verdicts: Iterable[Verdict]) -> Table:
    """The figures beside their targets, and for a miss the stage responsible."""
    table = _table(f"{name}: targets", ("data", "figure"), ("measured", "target", "from true labels", "", "missed by"))
    for verdict in verdicts:
        measured = "-" if verdict.value is None else _value(verdict.value, verdict.unit)
        alone = "" if verdict.on_true_labels is None else _value(verdict.on_true_labels, verdict.unit)
        mark = "[green]met[/]" if verdict.is_met else "[red]missed[/]"
        by = verdict.missed_by or ""
        table.add_row(verdict.group, verdict.figure, measured, _bounds(verdict), alone, mark, by)
    return table


def _worst(name: str, results: Sequence[CaseResult]) -> Table:
    """The cases with the largest errors."""
    columns = ("error", "σ", "confidence", "from true labels", "IoU object", "IoU shadow")
    table = _table(f"{name}: the largest errors", ("case", "caster"), columns)
    wrong = [result for result in results if result.error_deg is not None]
    for result in sorted(wrong, key=lambda result: -(result.error_deg or 0.0))[:WORST]:
        degrees = (_degrees(value) for value in (result.error_deg, result.sigma_deg))
        overlaps = map(_fraction, (result.object_iou, result.shadow_iou))
        confidence, alone = _fraction(result.confidence), _degrees(result.true_labels_deg)
        table.add_row(f"{result.folder}/{result.case}", result.caster or "-", *degrees, confidence, alone, *overlaps)
    return table


def _print_reasons(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints how often each reason was given for not answering a lit case."""
    reasons = Counter(result.reason for result in results if result.is_lit and not result.is_answered)
    for reason, count in reasons.most_common():
        console.print(f"{count:4d} x {reason}", highlight=False)


def _table(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    table = Table(title=title, title_justify="left")
    for heading in left:
        table.add_column(heading, no_wrap=True)
    for heading in right:
        table.add_column(heading, justify="right")
    return table


def _bounds(verdict: Verdict) -> str:
    least, most = (_value(bound, verdict.unit) for bound in (verdict.least, verdict.most))
    if verdict.least <= 0:
        return f"≤ {most}"
    return f"≥ {least}" if verdict.most >= 1 else f"{least} to {most}"


def _value(value: float, unit: str) -> str:
    return {DEG: f"{value:.1f}°", MS: f"{value:.0f} ms"}.get(unit, f"{value:.0%}")


def _degrees(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}°"


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:.0%}"


def _mean(values: Sequence[float | None]) -> float | None:
    """Of those that are known."""
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None


def _fraction(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
