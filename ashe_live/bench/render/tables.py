"""The printed tables of `ashe-live bench render`."""

import numpy as np
from rich.console import Console
from rich.table import Table

from ashe_live.bench.tables import cell, figures_table
from ashe_live.core.contract import Json
from ashe_live.quality import BALANCED


def print_render_figures(console: Console, record: Json) -> None:
    """Prints the tables of `record`, the bench's part of it."""
    loop = figures_table(
        "fast, one sun, ms a frame", "", "decode", "track", "render", "whole", "video drawn", "render / video"
    )
    for row in record["loop"]:
        values = (row["decode"], row["track"], row["render"], row["whole"], row["video_drawn"])
        loop.add_row(_size(row["size"]), *(f"{ms:.2f}" for ms in values), f"{row['render'] / row['video_drawn']:.1f}")
    large = record["large"]
    costs = figures_table("balanced, ms a picture", "", "median", "p99", "GPU median", "GPU p99")
    costs.add_row(f"{_size(large['size'])}, {large['triangles']} triangles", *_costs(large))
    for name, rows in record["sweeps"].items():
        for row in rows:
            costs.add_row(f"{name} {row['value']:,}", *_costs(row))
    errors = figures_table("against a path tracer", "", "ms", "shadow IoU", "least", "dE in shadow", "dE on model")
    for row in record["errors"]:
        numbers = (row["shadow_iou_mean"], row["shadow_iou_least"])
        colours = (row["shadow_de"], row["model_de"])
        cells = (f"{row['ms']:.1f}", *(f"{n:.3f}" for n in numbers), *(f"{n:.1f}" for n in colours))
        errors.add_row(f"{row['series']}: {row['name']}", *cells)
    columns = ("sun", "lamp", "ratio", "sun, processor", "lamp, processor", "ratio")
    lamps = figures_table("one light, 640x480, ms a picture", "", *columns)
    for name, row in record["lamps"].items():
        pairs_of_ms = ((row["sun"], row["lamp"]), (row["sun_cpu"], row["lamp_cpu"]))
        lamps.add_row(name, *(f"{ms:.2f}" for sun, lamp in pairs_of_ms for ms in (sun, lamp, lamp / sun)))
    pairs = [pairs_table(record["pairs"])] if record["pairs"] else []
    for table in (loop, costs, lamps, errors, scene_table(record["errors"]), *pairs):
        console.print(table)
    memory = record["memory"]
    console.print(
        f"{memory['frames']} pictures, a model switch every ten: "
        f"{memory['start_mib']:.1f} to {memory['end_mib']:.1f} MiB, "
        f"{memory['start_gl_objects']:.0f} to {memory['end_gl_objects']:.0f} OpenGL objects"
    )


def scene_table(rows: list[Json]) -> Table:
    """The preset `balanced`, scene by scene, and the means by kind of light."""
    table = figures_table("balanced, by scene", "", "shadow IoU", "dE in shadow", "dE on model", "ground, worst of 5")
    scenes: Json = next((row["scenes"] for row in rows if row["name"] == BALANCED.name), {})
    for kind in ("directional", "lamp"):
        of_kind = {name: error for name, error in scenes.items() if error["kind"] == kind}
        for name, error in of_kind.items():
            table.add_row(name, *_error_cells([error]))
        if of_kind:
            table.add_row(f"mean, {kind}", *_error_cells(list(of_kind.values())))
    return table


def _error_cells(errors: list[Json]) -> list[str]:
    iou, shadow, model, ground = (
        sum(error[key] for error in errors) / len(errors) for key in ("shadow_iou", "shadow_de", "model_de", "ground")
    )
    return [f"{iou:.3f}", f"{shadow:.1f}", f"{model:.1f}", f"{100 * ground:.1f} %"]


def _costs(row: Json) -> list[str]:
    return [cell(row[key], ".2f") for key in ("p50", "p99", "gpu_p50", "gpu_p99")]


def _size(size: list[int]) -> str:
    return f"{size[0]}x{size[1]}"


def pairs_table(rows: list[Json]) -> Table:
    """A row a preset; medians of borders and relief, means of the others, of the scenes in which each is measured."""
    columns = ("FLIP", "border", "dE ground", "dE paper", "dE model", "dE hidden", "relief, of hidden", "seam px")
    table = figures_table("against photos of the same with the model", "", *columns, "classified")
    for preset in dict.fromkeys(row["preset"] for row in rows):
        own = [row for row in rows if row["preset"] == preset]
        means = [
            float(np.nanmean([row[key] for row in own])) for key in ("ground_de", "paper_de", "model_de", "hidden_de")
        ]
        flip = float(np.nanmean([row["flip"] for row in own]))
        seams = str(sum(row["seam_px"] for row in own))
        reliefs = ("relief_ratio", "hidden_relief_ratio")
        border = float(np.nanmedian([row["border_ratio"] for row in own]))
        table.add_row(
            f"{preset}, {len(own)} scenes",
            f"{flip:.3f}",
            f"{border:.2f}",
            *(f"{de:.1f}" for de in means),
            ", ".join(f"{np.nanmedian([row[key] for row in own]):.2f}" for key in reliefs),
            seams,
            f"{100 * own[0]['forced_choice']:.0f} %",
        )
    return table
