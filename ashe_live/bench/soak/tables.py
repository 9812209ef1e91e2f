"""The printed tables of `ashe-live bench soak`."""

from rich.console import Console

from ashe_live.bench.tables import figures_table
from ashe_live.core.contract import Json

HELD = {
    "rss_mib": "memory, MiB",
    "children_rss_mib": "memory of the light worker, MiB",
    "gl_objects": "OpenGL objects",
    "open_files": "open files",
    "threads": "threads",
}


def print_soak_figures(console: Console, record: Json) -> None:
    """Prints the tables of `record`, the bench's part of it."""
    ages = figures_table(
        f"age of a picture on a display of {record['display_hz']:.0f} Hz, ms",
        "camera", "pictures", "median", "p95", "p99", "beyond the bound: p99", "longest", "within",
    )  # fmt: skip
    for age in record["age"]:
        ms, over = age["age_ms"], age["over_bound_ms"]
        if ms is None:
            continue
        ages.add_row(
            f"{age['camera_hz']:.0f} Hz",
            str(age["pictures"]),
            *(f"{ms[at]:.1f}" for at in ("p50", "p95", "p99")),
            f"{over['p99']:.1f}",
            f"{age['longest_over_bound_ms']:.1f}",
            f"{age['within_bound_share']:.1%}",
        )
    console.print(ages)

    soak = record["soak"]
    console.print(
        f"{soak['frames']} frames in {soak['seconds']:.0f} s, {soak['model_switches']} switches of the model, "
        f"{soak['estimates']} estimates, key views of at most {soak['key_views_mib']:.1f} MiB"
    )
    held = figures_table("held after the warm-up", "", "first", "last", "in 1000 frames", "")
    for name, label in HELD.items():
        series = soak["held"][name]
        if series["is_flat"] is not None:
            held.add_row(
                label,
                f"{series['first']:.1f}",
                f"{series['last']:.1f}",
                f"{series['per_1000_frames']:+.4f}",
                "flat" if series["is_flat"] else "GROWS",
            )
    if held.row_count:
        console.print(held)
    _print_drift(console, soak["drift"])
    console.print(f"left running at the end: {', '.join(soak['left_running']) or 'nothing'}")


def _print_drift(console: Console, drift: Json | None) -> None:
    if drift is None:
        console.print("too few frames to tell a drift or a leak")
        return
    times = figures_table("a frame, median ms", "", "first tenth", "last tenth", "ratio")
    for kind, ms in drift["median_ms"].items():
        first, last = ms["first_tenth"], ms["last_tenth"]
        times.add_row(kind, f"{first:.2f}", f"{last:.2f}", f"{last / first:.3f}")
    console.print(times)
    console.print("no drift" if drift["is_steady"] else "SLOWER at the end than at the start")
