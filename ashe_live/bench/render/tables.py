"""The printed tables of `ashe-live bench render`."""

from rich.console import Console

from ashe_live.bench.tables import figures_table
from ashe_live.core.contract import Json


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
    for table in (loop, costs, errors):
        console.print(table)
    memory = record["memory"]
    console.print(
        f"{memory['frames']} pictures, a model switch every ten: "
        f"{memory['start_mib']:.1f} to {memory['end_mib']:.1f} MiB, "
        f"{memory['start_gl_objects']:.0f} to {memory['end_gl_objects']:.0f} OpenGL objects"
    )


def _costs(row: Json) -> list[str]:
    return ["-" if row[key] is None else f"{row[key]:.2f}" for key in ("p50", "p99", "gpu_p50", "gpu_p99")]


def _size(size: list[int]) -> str:
    return f"{size[0]}x{size[1]}"
