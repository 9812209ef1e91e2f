"""The time from the command to the first picture with the model in it, measured in separate processes."""

import os
import subprocess
import sys
import time
from dataclasses import dataclass

from ashe_live.capture.clips.known_clip import KnownClip

LONGEST_START_S = 120.0


@dataclass(frozen=True, slots=True)
class ViewerStart:
    """The least times of several runs, as other load on the machine only ever adds."""

    wall_s: float  # of the whole command, which ends after that picture
    cpu_s: float  # of all its threads and processes; 0 where the system does not provide it


def time_start(clip: KnownClip, quality: str, runs: int, *options: str) -> ViewerStart | None:
    """Times playing one frame of `clip`, `runs` times; None when that fails, as in a window without a display.

    Without an estimate of the light, which a window does not wait for: it is asked for in a frame that is not played.
    """
    command = [sys.executable, "-m", "ashe_live", "play", str(clip.path), "--frames", "1", "--estimate-at", "1"]
    command += ["--marker", clip.marker_spec, "--marker-size", str(clip.marker_side_m)]
    command += ["--focal-px", str(clip.camera.K[0, 0]), "--quality", quality, *options]
    walls_s, cpus_s = [], []
    for _ in range(runs):
        begun_s, begun_cpu_s = time.perf_counter(), _childrens_cpu_s()
        try:
            outcome = subprocess.run(command, capture_output=True, timeout=LONGEST_START_S)
        except subprocess.TimeoutExpired:
            return None  # the figures before this one are not to be lost
        walls_s.append(time.perf_counter() - begun_s)
        cpus_s.append(_childrens_cpu_s() - begun_cpu_s)
        if outcome.returncode != 0:
            return None
    return ViewerStart(min(walls_s), min(cpus_s))


def _childrens_cpu_s() -> float:
    times = os.times()
    return times.children_user + times.children_system
