"""The plots of `ashe-live bench render`."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ashe_live.bench.plots import TradePoint, draw_trade
from ashe_live.core.contract import Json
from ashe_live.files.writing import written_whole

ERRORS, COSTS = "error", "cost.png"  # the first is a stem


def draw_errors(rows: Sequence[Json], note: str, stem: Path, overwrite: bool) -> None:
    """Plots the record's `errors` into `stem`.svg and .png; writes nothing if there are none."""
    points = [
        TradePoint(
            row["name"],
            row["series"],
            row["ms"],
            {
                "1 - shadow IoU": 1 - row["shadow_iou_mean"],
                "dE in the shadow": row["shadow_de"],
                "dE on the model": row["model_de"],
            },
            row["series"] == "presets",
        )
        for row in rows
    ]
    if points:
        draw_trade(points, "Error against a path tracer", "ms a picture, 480x360", note, stem, overwrite)


def draw_sweeps(sweeps: Mapping[str, Sequence[Json]], note: str, path: Path, overwrite: bool) -> None:
    """Plots the cost of a picture against each quantity varied, from the record's `sweeps`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 3.2), layout="constrained")
    for ax, (name, rows) in zip(figure.subplots(1, len(sweeps)), sweeps.items(), strict=True):
        ax.plot([row["value"] for row in rows], [row["p50"] for row in rows], "o-", color="#0072b2")
        ax.set(
            xlabel=name,
            ylabel="ms a picture",
            ylim=(0, None),
            xscale="log" if name in ("triangles", "depth map") else "linear",
        )
        ax.grid(alpha=0.3)
    figure.supxlabel(note, fontsize="x-small", color="dimgray")
    with written_whole(path, overwrite, beside=True) as file:
        figure.savefig(file.stream, format="png", dpi=120, metadata={"Software": None})
