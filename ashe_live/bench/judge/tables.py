"""The printed tables of `ashe-live bench fit-judge`."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from rich.table import Table

from ashe_live.bench.judge.calibration import squared_distances
from ashe_live.bench.judge.validation import Judged, risk_curve
from ashe_live.bench.metrics import calibration_error, risk_at, share
from ashe_live.bench.tables import figures_table
from ashe_live.core.transforms import ELLIPSE_68, ELLIPSE_95
from ashe_live.light.explanation.judgement.judge_tables import Score
from ashe_live.light.explanation.judgement.uncertainty import Calibration

COVERAGES = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)


def score_table(name: str, score: Score) -> Table:
    """The curves of a score: from which value of a feature to which, and what that adds to the log odds."""
    table = figures_table(f"{name}: constant {score.constant:+.2f}", "feature", "at", "adds to the log odds")
    for feature, curve in score.curves.items():
        values = ", ".join(f"{value:.2f}" for value in curve.at)
        table.add_row(feature, values, ", ".join(f"{value:+.2f}" for value in curve.log_odds))
    return table


def families_table(held_out: Sequence[tuple[str, str, Sequence[Judged]]]) -> Table:
    """How tables that were fitted without a family judge its pictures."""
    table = figures_table("families left out of the fit", "kind", "pictures", "sure and wrong", "calibration error")
    for kind, family, answers in held_out:
        pictures = len({each.sample.case for each in answers})
        bad = np.mean([each.is_bad for each in answers])
        error = error_of(answers)
        table.add_row(f"{kind}: {family}", str(pictures), f"{100 * bad:.1f} %", f"{error:.3f}")
    return table


def error_of(answers: Sequence[Judged]) -> float:
    """The expected calibration error in five bins, as a family has few pictures."""
    confidences, good = [each.confidence for each in answers], [each.is_good for each in answers]
    return calibration_error(confidences, good, bins=5) or 0.0


def risk_table(name: str, answers: Mapping[str, Sequence[Judged]]) -> Table:
    """For each preset, the share of answers that are over 10° off, as more of the lit pictures are answered."""
    table = figures_table(f"{name}: risk (over 10° off) by coverage", "coverage", *answers)
    curves = [risk_curve(each) for each in answers.values()]
    for coverage in COVERAGES:
        cells = []
        for curve in curves:
            reached = risk_at(curve, coverage)
            cells.append("-" if reached is None else f"{100 * reached[1]:.1f} % from {reached[0]:.2f}")
        table.add_row(f"{100 * coverage:.0f} %", *cells)
    return table


def calibration_table(calibration: Calibration, answers: Sequence[Judged]) -> Table:
    """By confidence, the share of good answers, and of errors within what is stated where there is a light."""
    title = (
        f"calibration: overdispersion {calibration.overdispersion:.2f}, "
        f"doubt {np.degrees(calibration.doubt_rad):.1f}° (1 - confidence)^{calibration.doubt_power:.2f}"
    )
    table = figures_table(title, "confidence", "answers", "good", "within 68 %", "within 95 %")
    edges = (0.0, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0001)
    for low, high in pairwise(edges):
        inside = [each for each in answers if low <= each.confidence < high and each.best is not None]
        lit = [each.answer for each in inside if each.answer is not None]
        if inside:
            squared = squared_distances(calibration, lit) if lit else np.empty(0)
            is_within = [(squared <= within).tolist() for within in (ELLIPSE_68, ELLIPSE_95)]
            shares = [share(flags) for flags in ([each.is_good for each in inside], *is_within)]
            cells = ("-" if each is None else f"{100 * each:.0f} %" for each in shares)
            table.add_row(f"{low:.2f} to {min(high, 1):.2f}", str(len(inside)), *cells)
    return table
