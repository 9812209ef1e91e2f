"""Plots of the trade-off between error and time, with its Pareto front."""

from collections.abc import Mapping, Sequence
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ashe_live.core.contract import Json
from ashe_live.errors import UserError
from ashe_live.files.writing import written_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SUFFIXES = (".svg", ".png")
PANEL_INCHES = (6.4, 5.2)
# Distinguishable for the colour-blind (Okabe and Ito).
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8c6d31")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
PRESET_COLOUR = "black"


@dataclass(frozen=True, slots=True)
class TradePoint:
    """One setting: its cost, and its error by each measure."""

    name: str
    series: str  # settings that differ in one number; drawn in one colour, joined by a line
    cost: float
    errors: Mapping[str, float]  # by measure, each of which gets a panel; smaller is better
    is_preset: bool = False


def points_of(recorded: Sequence[Json]) -> list[TradePoint]:
    """The points of a record, in which each is stored by `dataclasses.asdict`."""
    return [TradePoint(**point) for point in recorded]


def check_can_draw() -> None:
    """Imports Matplotlib, which only the benches' plots need. Raises UserError if it is missing."""
    try:
        # On import it reads a matplotlibrc from the current folder, which may be anybody's.
        with chdir(Path(__file__).parent):
            import matplotlib.figure  # noqa: F401
    except ImportError:
        raise UserError("the plots need Matplotlib", "pip install 'ashe-live[bench]', or use --quick") from None


def pareto_front(points: Sequence[TradePoint], measure: str) -> list[TradePoint]:
    """The points that are not dominated in cost and in the error by `measure`, cheapest first."""
    front: list[TradePoint] = []
    for point in sorted(points, key=lambda point: (point.cost, point.errors[measure])):
        if not front or point.errors[measure] < front[-1].errors[measure]:
            front.append(point)
    return front


def draw_trade(
    points: Sequence[TradePoint], title: str, cost_label: str, note: str, stem: Path, overwrite: bool = False
) -> None:
    """Writes `stem`.svg and `stem`.png: a panel for each measure, cost on a logarithmic axis, presets named.

    note: shown at the top (date, machine, versions). Existing files are kept, and others written beside them, unless
    `overwrite`. Raises ValueError without points, UserError without Matplotlib or when a file cannot be written.
    """
    if not points:
        raise ValueError("there is nothing to draw")
    check_can_draw()
    import matplotlib
    from matplotlib.figure import Figure

    measures = list(points[0].errors)
    width, height = PANEL_INCHES
    # The same points give the same files: no random ids, no date.
    with matplotlib.rc_context({"svg.hashsalt": "ashe-live", "svg.fonttype": "none"}):
        figure = Figure(figsize=(width * len(measures), height), layout="constrained")
        axes = figure.subplots(1, len(measures), squeeze=False)[0]
        for ax, measure in zip(axes, measures, strict=True):
            _draw_panel(ax, points, measure, cost_label)
        figure.suptitle(title, x=0.01, horizontalalignment="left")
        figure.text(0.99, 0.98, note, fontsize="x-small", color="dimgray", ha="right", va="top")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize="small")
        for suffix in SUFFIXES:
            metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
            with written_whole(stem.with_suffix(suffix), overwrite, beside=True) as file:
                figure.savefig(file.stream, format=suffix[1:], dpi=120, metadata=metadata)


def _draw_panel(ax: "Axes", points: Sequence[TradePoint], measure: str, cost_label: str) -> None:
    front = pareto_front(points, measure)
    ax.step(
        [point.cost for point in front],
        [point.errors[measure] for point in front],
        where="post",
        color="lightgray",
        linewidth=6,
        label="Pareto front",
        zorder=0,
    )
    others = [point for point in points if not point.is_preset]
    for number, series in enumerate(dict.fromkeys(point.series for point in others)):
        members = [point for point in others if point.series == series]
        ax.plot(
            [point.cost for point in members],
            [point.errors[measure] for point in members],
            color=COLOURS[number % len(COLOURS)],
            marker=MARKERS[(number + number // len(COLOURS)) % len(MARKERS)],
            markersize=5,
            linewidth=0.8,
            label=series,
        )
        for point in members:
            _name(ax, point, measure, COLOURS[number % len(COLOURS)], "x-small")
    presets = [point for point in points if point.is_preset]
    costs, errors = [point.cost for point in presets], [point.errors[measure] for point in presets]
    ax.scatter(costs, errors, marker="*", s=180, color=PRESET_COLOUR, label="presets", zorder=3)
    for point in presets:
        _name(ax, point, measure, PRESET_COLOUR, "medium")
    ax.set(xscale="log", xlabel=cost_label, ylabel=measure)
    ax.set_ylim(bottom=0)
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("{x:g}")
    ax.tick_params(which="minor", labelsize="x-small")
    ax.grid(alpha=0.3, which="both")


def _name(ax: "Axes", point: TradePoint, measure: str, colour: str, size: str) -> None:
    at = (point.cost, point.errors[measure])
    ax.annotate(point.name, at, textcoords="offset points", xytext=(5, 5), fontsize=size, color=colour)
