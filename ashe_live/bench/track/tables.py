"""The printed tables of `ashe-live bench track`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.console import Console

from ashe_live.bench.tables import cell, figures_table
from ashe_live.bench.track.clips import ClipFigures


@dataclass(frozen=True, slots=True)
class Figure:
    """One line: the figures of the reference and of our tracker, and the bounds for ours."""

    name: str
    unit: str
    reference: float | None
    ours: float | None
    most: float | None
    least: float | None = None

    @property
    def is_met(self) -> bool | None:
        """None without a target."""
        if self.most is None and self.least is None:
            return None
        if self.ours is None:
            return False
        return (self.most is None or self.ours <= self.most) and (self.least is None or self.ours >= self.least)


def print_figures(console: Console, figures: Sequence[Figure]) -> None:
    table = figures_table("tracking, on synthetic frames", "", "OpenCV", "ours", "target", "")
    for figure in figures:
        target = _target(figure)
        verdict = {None: "", True: "met", False: "MISSED"}[figure.is_met]
        name = f"{figure.name} ({figure.unit})" if figure.unit else figure.name
        table.add_row(name, _number(figure.reference), _number(figure.ours), target, verdict)
    console.print(table)


def print_clips(console: Console, clips: Sequence[ClipFigures]) -> None:
    table = figures_table(
        "real clips", "", "frames", "found", "bridged", "largest turn", "jitter, px", "unfiltered, px", "median ms"
    )
    for clip in clips:
        table.add_row(
            clip.name,
            str(clip.frames),
            f"{100 * clip.found_share:.1f} %",
            str(clip.bridged),
            f"{clip.largest_turn_deg:.1f}°",
            f"{clip.jitter_in_motion_px:.3f}",
            f"{clip.unfiltered_jitter_in_motion_px:.3f}",
            f"{clip.median_ms:.1f}",
        )
    console.print(table)


def print_errors(console: Console, used: Mapping[str, float], fitted: Mapping[str, float]) -> None:
    """The figures of CornerErrors: those in use, and those that fit the given pictures best."""
    table = figures_table("errors of corners", "", "in use", "fitted to these pictures")
    for name, value in used.items():
        table.add_row(name, _number(value), _number(fitted[name]))
    console.print(table)


def _target(figure: Figure) -> str:
    if figure.most is not None and figure.least is not None:
        return f"{_number(figure.least)} to {_number(figure.most)}"
    if figure.least is not None:
        return f"≥ {_number(figure.least)}"
    return "" if figure.most is None else f"≤ {_number(figure.most)}"


def _number(value: float | None) -> str:
    return cell(value, ".3g")
