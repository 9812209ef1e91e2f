"""A long session of the viewer: simulated keys, the times of its pictures, and the resources that it holds."""

import sys
import threading
import time

import numpy as np

from ashe_live.bench.resources_held import Held
from ashe_live.bench.soak.offscreen_window import OffscreenWindow, ShownPicture
from ashe_live.core.arrays import Float
from ashe_live.core.contract import Json
from ashe_live.core.light import LightEstimate
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.models.catalogue import model_names
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.hands.requests import Command, Request
from ashe_live.viewer.session import Session

SWITCH_EVERY, ESTIMATE_EVERY = 100, 300  # frames between two models, and between two estimates
SAMPLES = 200  # of memory and open handles, over the run
PROGRESS_LINES = 40
DRIFT_TOLERATED = 1.1  # of the last frames' times over the first ones'


class SoakTracker(MarkerTracker):
    """A tracker that times itself and can be paused between two frames."""

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]  # they are MarkerTracker's
        self.at_rest = threading.Lock()
        self.last_ms = (0.0, 0.0)  # wall and CPU time

    def track(self, frame: Frame) -> TrackedFrame:
        with self.at_rest:
            begun_s, begun_cpu_s = time.monotonic(), time.thread_time()
            tracked = super().track(frame)
            self.last_ms = (time.monotonic() - begun_s) * 1e3, (time.thread_time() - begun_cpu_s) * 1e3
        return tracked


class SoakRun:
    """Switches models and requests estimates; `add` must be called for every picture."""

    def __init__(self, window: OffscreenWindow, session: Session, tracker: SoakTracker, frames: int) -> None:
        self._window = window
        self._session = session
        self._tracker = tracker
        self._sample_every = max(1, frames // SAMPLES)
        # Written at once, so that pages that are first touched later do not look like a leak.
        self._times_ms = np.full((frames, len(TIMES)), np.nan)
        self._held = Held()
        self._most_view_bytes = 0
        self._count = 0
        self._shown: TrackedFrame | None = None
        self._estimates = 0
        self._estimate: LightEstimate | None = None
        self._begun_s = time.monotonic()

    def add(self, picture: ShownPicture) -> None:
        if self._session.estimate is not self._estimate:
            self._estimate = self._session.estimate
            self._estimates += 1
        if self._session.tracked is self._shown or self._count == len(self._times_ms):
            return
        self._shown = self._session.tracked
        drawn_ms = (picture.shown_s - picture.begun_s) * 1e3, picture.cpu_s * 1e3
        self._times_ms[self._count] = (*drawn_ms, *self._tracker.last_ms)
        self._count += 1
        if self._count % SWITCH_EVERY == 0:
            self._window.requests.append(Request(Command.NEXT_MODEL))
        if self._count % ESTIMATE_EVERY == 0:
            self._window.requests.append(Request(Command.ESTIMATE))
        self._most_view_bytes = max(self._most_view_bytes, self._session.watch.key_views.nbytes)
        if self._count % self._sample_every == 0:
            with self._tracker.at_rest:
                self._held.sample(self._count)
        if self._count % max(1, len(self._times_ms) // PROGRESS_LINES) == 0:
            print(f"{self._count} frames in {time.monotonic() - self._begun_s:.0f} s", file=sys.stderr, flush=True)

    def to_json(self) -> Json:
        # By then every model and its shaders are loaded; twice, as an estimate changes how they are drawn.
        round_frames = SWITCH_EVERY * len(model_names())
        return {
            "frames": self._count,
            "seconds": time.monotonic() - self._begun_s,
            "model_switches": self._count // SWITCH_EVERY,
            "estimates": self._estimates,
            "key_views_mib": self._most_view_bytes / 2**20,
            "drift": drift_json(self._times_ms[: self._count], round_frames),
            "held": self._held.to_json(max(2 * round_frames, self._count // 10)),
        }


TIMES = ("drawn", "drawn, processor", "tracked", "tracked, processor")


def drift_json(times_ms: Float, round_frames: int) -> Json | None:
    """Medians of the columns TIMES (n, 4) over the second tenth of the frames, the first being warm-up, and the last.

    Wall times also grow by other load on the machine, CPU times of a thread hardly do: only if both have grown has the
    program become slower. None if a tenth is shorter than a whole round through the models.
    """
    tenth = len(times_ms) // 10
    if tenth < round_frames:
        return None
    first, last = (np.median(part, axis=0) for part in (times_ms[tenth : 2 * tenth], times_ms[-tenth:]))
    drawn, drawn_cpu, tracked, tracked_cpu = last / first
    return {
        "median_ms": {
            name: {"first_tenth": float(first[at]), "last_tenth": float(last[at])} for at, name in enumerate(TIMES)
        },
        "is_steady": bool(max(min(drawn, drawn_cpu), min(tracked, tracked_cpu)) <= DRIFT_TOLERATED),
    }
