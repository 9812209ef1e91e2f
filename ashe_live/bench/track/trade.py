"""The tracker's trade-off of error against time: its main parameters, varied one at a time from `balanced`."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.progress import track

from ashe_live.bench.plots import TradePoint
from ashe_live.bench.tables import figures_table
from ashe_live.bench.track.contenders import Answer, Ours, answers
from ashe_live.bench.track.measures import corner_jitter_px, lag_ms, rotation_errors_deg
from ashe_live.bench.track.takes import SMALL, at_rest, roaming, scattered, sliding
from ashe_live.quality import BALANCED, QUALITIES
from ashe_live.tracking.preset import TrackingPreset

ERROR, JITTER, LAG = "median rotation error, 53 px at 45° (degrees)", "jitter at rest (px)", "lag at 3 cm/s (ms)"
COST = "processor time a frame: 9 followed, 1 searched anew (ms)"
SEARCHED_SHARE = 0.1  # of the frames, in what a frame costs
ROAMING, RESTING, SLIDING, SCATTERED = 120, 90, 90, 30  # frames of each take
SETTLED_FRAMES = 40  # at rest, before jitter is measured

B = BALANCED.tracking
VARIATIONS: tuple[tuple[str, str, TrackingPreset], ...] = (
    *(("places on an edge", str(n), replace(B, edge_samples=n)) for n in (8, 16, 32, 64, 128)),
    *(("the same, unrefined pose", str(n), replace(B, edge_samples=n, refines_pose=False)) for n in (8, 16, 32, 64)),
    *(("width searched", f"{n} px", replace(B, detection_width_px=n)) for n in (320, 480, 640)),
    *(("filter's time", f"{s:g} s", replace(B, filter_rest_s=s)) for s in (0.0, 0.1, 0.3, 1.0)),
    *(("filter's gate", f"{n:g} σ", replace(B, filter_gate=n)) for n in (2.0, 3.0, 4.0, 6.0)),
)


def sweep(console: Console) -> list[TradePoint]:
    """Measures every variation and preset on the same frames; presets come last."""
    tried = [*((*one, False) for one in VARIATIONS)]
    tried += [("presets", name, quality.tracking, True) for name, quality in QUALITIES.items()]
    takes = {
        "roaming": roaming("roaming", 53, 45, ROAMING),
        "rest": at_rest("rest", 133, 30, RESTING),
        "slow": sliding("slow", 0.03, SLIDING),
        "searched": scattered("searched", 60, SCATTERED),
    }
    given: dict[str, dict[str, list[Answer]]] = {}
    for name, take in track(takes.items(), "trade", console=console, transient=True):
        cold = name == "searched"
        contenders = {str(n): Ours(take.camera, preset, cold) for n, (_, _, preset, _) in enumerate(tried)}
        given[name] = answers(take, dict(contenders))
    return [
        _point(series, name, {take: own[str(n)] for take, own in given.items()}, is_preset)
        for n, (series, name, _, is_preset) in enumerate(tried)
    ]


def _point(series: str, name: str, given: dict[str, list[Answer]], is_preset: bool) -> TradePoint:
    followed_ms, searched_ms = (
        float(np.median([answer.cpu_ms for answer in given[key]])) for key in ("rest", "searched")
    )
    errors = {
        ERROR: float(np.median(rotation_errors_deg(given["roaming"]))),
        JITTER: corner_jitter_px(given["rest"][SETTLED_FRAMES:], SMALL),
        LAG: lag_ms(given["slow"]),
    }
    cost = (1 - SEARCHED_SHARE) * followed_ms + SEARCHED_SHARE * searched_ms
    return TradePoint(name, series, cost, errors, is_preset)


def print_trade(console: Console, points: Sequence[TradePoint]) -> None:
    """Prints one line per setting."""
    table = figures_table("trade", "varied", "to", "ms", "rotation, °", "jitter, px", "lag at 3 cm/s, ms")
    for point in points:
        errors = (f"{point.errors[measure]:.3g}" for measure in (ERROR, JITTER, LAG))
        table.add_row(point.series, point.name, f"{point.cost:.2f}", *errors)
    console.print(table)
