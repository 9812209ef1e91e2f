"""The figures of `ashe-live bench viewer` for a person."""

from rich.console import Console

from ashe_live.bench.tables import figures_table
from ashe_live.core.contract import Json


def print_viewer_figures(console: Console, record: Json) -> None:
    """`record`: the viewer's part of it."""
    unpaced, paced = record["unpaced"], record["paced"]
    width, height = record["size"]
    console.print(f"{record['clip']} at {width}x{height}, quality {record['quality']}, {record['frames']} frames a run")

    for name, start in record["first_picture"].items():
        if start is not None:
            console.print(f"first picture, {name}: {start['wall_s']:.2f} s ({start['cpu_s']:.2f} s of processor time)")
    console.print()

    stages = figures_table("unpaced, ms a frame", "", "median", "p95", "p99", "CPU")
    for name, ms in unpaced["stages_ms"].items():
        label = "(the bare video)" if name == "blit" else name
        stages.add_row(label, *(f"{ms[key]:.2f}" for key in ("p50", "p95", "p99", "mean_cpu")))
    console.print(stages)
    console.print(f"{unpaced['fps']:.0f} fps\n")

    frames = figures_table(f"paced at {paced['rate_hz']:.0f} Hz, ms a frame", "", "median", "p95", "p99")
    for state in ("idle", "estimating", "sharpening"):
        for kind in ("work", "interval"):
            ms = paced[state][f"{kind}_ms"]
            frames.add_row(f"{state}, {kind}", *(f"{ms[key]:.2f}" for key in ("p50", "p95", "p99")))
    console.print(frames)
    for state in ("estimating", "sharpening"):
        ended = len(paced[state]["estimates_ms"])
        ratio = paced[state]["p99_ratio"]
        console.print(f"p99 of the work while {state} is {ratio:.2f} times idle; {ended} estimates ended")
    key_views = record["key_views"]
    console.print(f"key views: {key_views['mean_ms']:.3f} ms a frame to choose them, {key_views['mib']:.1f} MiB")
