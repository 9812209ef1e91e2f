"""The tables of `ashe-live bench light` that compare sets, presets and takes, or are of clips and lamps."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from rich.console import Console

from ashe_live.bench.light.clips import EVERY, ClipResult
from ashe_live.bench.light.lamps import summarise_lamps
from ashe_live.bench.light.results import CONFIDENT_DEG, CaseResult, summarise
from ashe_live.bench.light.takes import TakeResult, confidence_falls, grouped_by_span
from ashe_live.bench.metrics import (
    calibration_error,
    largest,
    mean,
    median,
    percentile,
    risk_at,
    risk_by_coverage,
    share,
)
from ashe_live.bench.tables import cell, degrees, figures_table, fraction, percent

NEAR_M, FAR_M, FARTHEST_M = 0.6, 1.1, 1e6  # distances up to which lamps are summarised by themselves
# Distances of lights, above the first and up to the second.
DISTANCES = {
    "sun": (FARTHEST_M, math.inf),
    f"lamp up to {100 * NEAR_M:.0f} cm": (0.0, NEAR_M),
    f"up to {100 * FAR_M:.0f} cm": (NEAR_M, FAR_M),
    "farther": (FAR_M, FARTHEST_M),
    "all lamps": (0.0, FARTHEST_M),
}
WIDE_DEG = 12.0  # span of a take from which its views are expected to tell a lamp's place
COVERAGES = (0.5, 0.6, 0.7, 0.8, 0.9)


def print_risk(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints risk by coverage, set by set and preset by preset: more work should never answer less, or worse."""
    columns = ("lit", "answered", *(f"risk at {coverage:.0%}" for coverage in COVERAGES), "calibration error")
    table = figures_table(f"risk (answers over {CONFIDENT_DEG:.0f}° off) by coverage", ("set", "preset"), *columns)
    for folder in dict.fromkeys(result.folder for result in results):
        for preset in dict.fromkeys(result.preset for result in results):
            members = [each for each in results if (each.folder, each.preset) == (folder, preset)]
            answers = [each for each in members if each.confidence is not None]
            lit = sum(each.is_lit for each in members)
            confidences, good = [each.confidence or 0.0 for each in answers], [each.is_good for each in answers]
            curve = risk_by_coverage(confidences, good, [each.is_lit for each in answers], lit)
            risks = [risk_at(curve, coverage) for coverage in COVERAGES]
            covered = share([each.is_answered for each in members if each.is_lit])
            cells = (percent(None if risk is None else risk[1]) for risk in risks)
            error = calibration_error(confidences, good)
            table.add_row(folder, preset, str(lit), percent(covered), *cells, fraction(error))
    console.print(table)


def print_takes(console: Console, results: Sequence[TakeResult]) -> None:
    """Prints, for each preset, errors and confidence by the takes' span and the number of views."""
    columns = ("lit", "answered", "median", "p95", "within 1 σ", "95 % ellipse", "sure and wrong", "confidence", "ms")
    for preset in dict.fromkeys(each.result.preset for each in results):
        table = figures_table(f"{preset}: takes by span and number of views", ("span", "views"), *columns)
        members = [each for each in results if each.result.preset == preset]
        for span, of_span in grouped_by_span(members).items():
            for views in dict.fromkeys(each.views for each in of_span):
                some = summarise([each.result for each in of_span if each.views == views])
                lit = [each for each in of_span if each.views == views and each.result.is_lit]
                table.add_row(
                    span,
                    str(views),
                    str(len(lit)),
                    percent(share([each.result.is_answered for each in lit])),
                    degrees(some.median_deg),
                    degrees(percentile((each.result.error_deg for each in lit), 95)),
                    *map(percent, (some.within_1_sigma, some.within_ellipse_95, some.bad_share)),
                    fraction(mean(each.result.confidence for each in lit)),
                    cell(some.median_ms, ".0f"),
                )
        console.print(table)
        falls = confidence_falls(members)
        console.print(
            f"right answers whose confidence falls by more than 0.02 with more views: {falls[0]} of {falls[1]}"
        )


def print_lamps(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints how lamps and suns were told apart in single pictures, set by set, if there is a lamp in any."""
    groups: dict[str, list[CaseResult]] = {}
    for result in results:
        groups.setdefault(f"{result.folder}, {result.preset}", []).append(result)
    _print_by_distance(console, "one light, by its distance: error of the direction at the marker, and beside", groups)


def print_places(console: Console, results: Sequence[CaseResult]) -> None:
    """Prints how single pictures were answered category by category, if there are several and a lamp is in any."""
    table = figures_table(
        "one light, by category",
        ("preset", "category"),
        *("q 1/m", "lit", "answered", "as a lamp", "median", "largest", "sure and wrong", "distance off", "q off, σ"),
    )
    for preset in dict.fromkeys(result.preset for result in results):
        alone = [(result, result.lamp) for result in results if result.lamp is not None and result.preset == preset]
        for category in dict.fromkeys(result.category for result, _ in alone):
            members = [pair for pair in alone if pair[0].category == category]
            lamps = [lamp for _, lamp in members]
            summary = summarise_lamps(lamps, [result.is_answered for result, _ in members])
            errors = [result.error_deg for result, _ in members]
            q = np.median([1 / (lamp.true_distance_m or math.inf) for lamp in lamps])
            table.add_row(
                preset,
                category,
                f"{q:.2f}",
                str(summary.attempted),
                percent(summary.answered),
                percent(summary.stated),
                degrees(median(errors)),
                degrees(largest(errors)),
                str(sum(result.is_bad for result, _ in members)),
                percent(summary.distance_error),
                fraction(largest(abs(lamp.sigmas) for lamp in lamps if lamp.sigmas is not None)),
            )
    if table.row_count > 1 and any(result.lamp and result.lamp.true_distance_m for result in results):
        console.print(table)


def print_lamp_takes(console: Console, results: Sequence[TakeResult]) -> None:
    """Prints the same for takes by number of views, for all and for those of a wide span, if any has a lamp."""
    for least_deg, which in ((0.0, "takes"), (WIDE_DEG, f"takes of {WIDE_DEG:.0f}° and more")):
        groups: dict[str, list[CaseResult]] = {}
        for each in sorted(results, key=lambda each: each.views):
            if each.span_deg >= least_deg:
                groups.setdefault(f"{each.result.preset}, {each.views} views", []).append(each.result)
        _print_by_distance(console, f"{which}, by the light's distance", groups)


def _print_by_distance(console: Console, title: str, groups: Mapping[str, Sequence[CaseResult]]) -> None:
    """Prints for each named group how its answers stand to the places of lights, by their distance; if it has lamps."""
    if not any(each.lamp and each.lamp.true_distance_m for results in groups.values() for each in results):
        return
    table = figures_table(
        title,
        ("", "light"),
        *("lit", "answered", "as a lamp", "median", "p90", "beside the object", "distance off"),
        *("q within 1 σ", "95 % ellipsoid", "radius told", "radius off"),
    )
    for name, results in groups.items():
        alone = [(result, result.lamp) for result in results if result.lamp is not None]
        for kind, (least_m, most_m) in DISTANCES.items():
            members = [pair for pair in alone if least_m < (pair[1].true_distance_m or math.inf) <= most_m]
            if not members:
                continue
            summary = summarise_lamps([lamp for _, lamp in members], [result.is_answered for result, _ in members])
            errors = [result.error_deg for result, _ in members]
            table.add_row(
                name,
                kind,
                str(summary.attempted),
                percent(summary.answered),
                percent(summary.stated),
                *(degrees(percentile(errors, percent_below)) for percent_below in (50, 90)),
                degrees(summary.beside_deg),
                percent(summary.distance_error),
                percent(summary.within_1_sigma),
                percent(summary.within_ellipsoid_95),
                percent(summary.radius_told),
                percent(summary.radius_error),
            )
    console.print(table)


def print_clips(console: Console, clips: Sequence[ClipResult]) -> None:
    table = figures_table(
        f"clips: every {EVERY}th frame", ("clip", "preset"), "frames", "no marker", "none", "about", "RMS", "max"
    )
    for clip in clips:
        counts = (str(count) for count in (clip.frames, clip.without_marker, clip.abstained))
        table.add_row(clip.clip, clip.preset, *counts, clip.about, degrees(clip.rms_deg), degrees(clip.max_deg))
    console.print(table)
