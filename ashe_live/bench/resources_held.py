"""The resources that a process holds as it runs, their growth, and what is left running at the end."""

import math
import multiprocessing
import os
import threading
import time
from pathlib import Path

import numpy as np

from ashe_live.core.contract import Json
from ashe_live.render.gl.offscreen import live_gl_objects

PROC = Path("/proc")
# Growth over the whole run, relative to the amount held, that is still flat: an allocator's fluctuations stay below it.
TOLERATED_GROWTH = 0.02
# Enough on a busy machine; a thread that hangs takes longer.
TIME_TO_END_S = 10.0


def resident_mib(process: int | str = "self") -> float:
    """Resident memory, a software rasteriser's textures included; NaN if unavailable or the process has ended."""
    try:
        pages = (PROC / str(process) / "statm").read_text().split()[1]
    except OSError:
        return math.nan
    return int(pages) * os.sysconf("SC_PAGE_SIZE") / 2**20


def held_now() -> dict[str, float]:
    """The resources of this process, and the memory of its children, by name; NaN where not available."""
    return {
        "rss_mib": resident_mib(),
        "children_rss_mib": sum(resident_mib(child.pid or "none") for child in multiprocessing.active_children()),
        "gl_objects": live_gl_objects(),
        "open_files": _entries(PROC / "self" / "fd"),
        "threads": _entries(PROC / "self" / "task"),
    }


class Held:
    """Samples of the resources held, with the number of frames shown until each."""

    def __init__(self) -> None:
        self._frames: list[int] = []
        self._samples: list[dict[str, float]] = []

    def sample(self, frame: int) -> None:
        self._frames.append(frame)
        self._samples.append(held_now())

    def to_json(self, warm_up: int) -> Json:
        """The samples, and their growth after frame `warm_up`; null where the system does not provide a value."""
        by_name = {name: [sample[name] for sample in self._samples] for name in self._samples[0]}
        return {
            "frames": self._frames,
            **{
                name: {
                    "samples": [value if math.isfinite(value) else None for value in values],
                    **growth(self._frames, values, warm_up),
                }
                for name, values in by_name.items()
            },
        }


def growth(frames: list[int], values: list[float], warm_up: int) -> Json:
    """From frame `warm_up` on: the first and last values, the slope per 1000 frames, and whether it counts as flat.

    The slope is the median over all pairs of samples (Theil-Sen estimator), robust against single jumps. All are None
    with fewer than three samples.
    """
    x, y = np.array(frames, float), np.array(values, float)
    used = (x >= warm_up) & np.isfinite(y)
    x, y = x[used], y[used]
    if len(x) < 3:
        return {"first": None, "last": None, "per_1000_frames": None, "is_flat": None}
    earlier, later = np.triu_indices(len(x), 1)
    slope = float(np.median((y[later] - y[earlier]) / (x[later] - x[earlier])))
    is_flat = slope * (x[-1] - x[0]) <= TOLERATED_GROWTH * float(np.median(y))
    return {"first": float(y[0]), "last": float(y[-1]), "per_1000_frames": slope * 1000, "is_flat": bool(is_flat)}


def left_running(before: set[threading.Thread]) -> list[str]:
    """Names of threads not in `before` and of child processes that have not ended after TIME_TO_END_S."""
    deadline_s = time.monotonic() + TIME_TO_END_S
    left = [thread for thread in threading.enumerate() if thread not in before]
    for thread in left:
        thread.join(max(0.0, deadline_s - time.monotonic()))
    for child in multiprocessing.active_children():
        child.join(max(0.0, deadline_s - time.monotonic()))
    return [
        *(thread.name for thread in left if thread.is_alive()),
        *(child.name for child in multiprocessing.active_children()),
    ]


def _entries(folder: Path) -> float:
    return len(os.listdir(folder)) if folder.is_dir() else math.nan  # noqa: PTH208 - names are enough
