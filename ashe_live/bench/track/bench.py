"""`ashe-live bench track`: the tracker compared with OpenCV's detector, on frames with exactly known poses."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

import cv2
import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import read_cases
from ashe_live.bench.machine import measured_with
from ashe_live.bench.plots import SUFFIXES, draw_trade, points_of
from ashe_live.bench.track.attacks.hard_prints import hard_print_figures
from ashe_live.bench.track.attacks.impostors import impostor_figures
from ashe_live.bench.track.attacks.strips import strip_figures
from ashe_live.bench.track.certainty import certainty_figures, fitted, look_at
from ashe_live.bench.track.clips import ClipFigures, follow_clips
from ashe_live.bench.track.contenders import Answer, Contender, OpencvReference, Ours, answers, found_share
from ashe_live.bench.track.focal import focal_figures
from ashe_live.bench.track.frames import Flaws
from ashe_live.bench.track.measures import (
    corner_jitter_px,
    flipped_share,
    lag_ms,
    lasting_flips,
    normalised_error_squared,
    rotation_errors_deg,
)
from ashe_live.bench.track.tables import Figure, print_clips, print_errors, print_figures
from ashe_live.bench.track.takes import HD, LENS, SMALL, Take, at_rest, roaming, scattered, sliding
from ashe_live.bench.track.trade import COST, SETTLED_FRAMES, print_trade, sweep
from ashe_live.core.contract import Json
from ashe_live.quality import BALANCED
from ashe_live.tracking.edges.corner_errors import FITTED
from ashe_live.tracking.preset import TrackingPreset

TRADE = "trade"
QUICK_SHARE = 6
# Of the attacks: views of each material, and pictures.
STRIP_VIEWS, QUICK_VIEWS = 40, 3
IMPOSTOR_PICTURES, QUICK_PICTURES = 25, 1
SHADOW_RATIOS = 0.5, 0.3, 0.2, 0.12  # in the sun; beside a lamp in a dark room
REFERENCE, UNREFINED, OURS = "OpenCV", "OpenCV, unrefined", "ours"


@dataclass(frozen=True, slots=True)
class TrackBench(Bench):
    """The tracking bench: the synthetic takes, and the real clips of the folder `real`."""

    SCHEMA: ClassVar[int] = 2

    preset: TrackingPreset = BALANCED.tracking
    real: Path | None = None
    photos: Path | None = None  # a folder of others' pictures, without the ids that are asked for
    quick: bool = False  # a few frames of each take, and no sweep of the settings
    scenes: Sequence[Path] = ()  # folders of pictures with known poses: how certain these are, and what fits them

    def parts(self) -> Iterator[Json]:
        with _one_thread():
            yield self._measured()
            if not self.quick:
                points = sweep(self.console)
                print_trade(self.console, points)
                yield {"trade": [asdict(point) for point in points]}

    def plots(self) -> Sequence[str]:
        return () if self.quick else [TRADE + suffix for suffix in SUFFIXES]

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        if "trade" in record:
            points = points_of(record["trade"])
            draw_trade(points, "Tracking: error against time", COST, measured_with(record), out / TRADE, overwrite)

    def _measured(self) -> Json:
        # First, so that an unreadable folder is reported at once.
        clips: list[ClipFigures] = [] if self.real is None else follow_clips(self.real, self.preset)
        seen = [(folder.resolve().name, look_at(read_cases(folder), self.preset)) for folder in self.scenes]
        figures = list(self._figures())
        for name, own in seen:
            figures += certainty_figures(name, own)
        print_figures(self.console, figures)
        fit = None if self.quick else fitted([one for _, own in seen for one in own])
        if fit is not None:
            print_errors(self.console, asdict(FITTED), asdict(fit))
        if clips:
            print_clips(self.console, clips)
        return {
            "quick": self.quick,
            "preset": asdict(self.preset),
            "figures": [{**asdict(figure), "met": figure.is_met} for figure in figures],
            "clips": [asdict(clip) for clip in clips],
            "corner_errors": {"used": asdict(FITTED), "fitted": None if fit is None else asdict(fit)},
        }

    def _frames(self, frames: int) -> int:
        return max(frames // QUICK_SHARE, SETTLED_FRAMES + 10) if self.quick else frames

    def _contend(self, take: Take, cold: bool = False) -> dict[str, list[Answer]]:
        contenders: dict[str, Contender] = {
            REFERENCE: OpencvReference(take.camera),
            UNREFINED: OpencvReference(take.camera, subpixel=False),
            OURS: Ours(take.camera, self.preset, cold),
        }
        return answers(take, contenders)

    def _figures(self) -> Iterator[Figure]:
        yield from self._cost()
        yield from self._errors("133 px at 30°", roaming("133", 133, 30, self._frames(240)), 0.05)
        yield from self._errors("53 px at 45°", roaming("53", 53, 45, self._frames(600)), 0.25, flips=True)
        yield from self._errors("60 px at 3°", roaming("60", 60, 3, self._frames(600)), None, flips=True)
        yield from self._errors(
            "133 px at 30°, strong distortion", roaming("d", 133, 30, self._frames(120), LENS), None
        )
        yield from self._jitter("133 px at 30°", at_rest("133", 133, 30, self._frames(240)))
        yield from self._jitter("53 px at 45°", at_rest("53", 53, 45, self._frames(240)))
        for speed in (0.3, 0.03):
            given = self._contend(sliding("slide", speed, self._frames(150)))
            most = 4.0 if speed == 0.3 else None
            yield Figure(f"lag at {100 * speed:.0f} cm/s", "ms", lag_ms(given[REFERENCE]), lag_ms(given[OURS]), most)
        frames = self._frames(200)
        yield from self._detection("motion blur of 10 px, 133 px", scattered("b133", 133, frames, blur_px=10))
        yield from self._detection("motion blur of 10 px, 80 px", scattered("b80", 80, frames, blur_px=10))
        yield from self._detection("motion blur of 10 px, 53 px", scattered("b53", 53, frames, blur_px=10))
        for ratio in SHADOW_RATIOS:
            for side_px in (133, 30):
                name = f"edge of a shadow of {100 * ratio:.0f} % of the light across it, {side_px} px"
                yield from self._detection(name, scattered(f"s{side_px}", side_px, frames, Flaws(shadow_ratio=ratio)))
        yield from self._detection("20 px", scattered("s20", 20, frames))
        yield from self._detection("12 px", scattered("s12", 12, frames))
        yield from focal_figures(self.preset, self._frames(300))
        yield from strip_figures(self.preset, QUICK_VIEWS if self.quick else STRIP_VIEWS)
        yield from impostor_figures(self.preset, QUICK_PICTURES if self.quick else IMPOSTOR_PICTURES, self.photos)
        yield from hard_print_figures(self.preset, QUICK_VIEWS if self.quick else STRIP_VIEWS)

    def _cost(self) -> Iterator[Figure]:
        for camera, most in ((HD, 0.4), (SMALL, 0.8)):  # of what OpenCV takes
            given = self._contend(roaming("cost", 133, 30, self._frames(240), camera))
            where = f"{camera.size[0]}x{camera.size[1]}, 133 px"
            # The first frames include one-time initialisation.
            wall = {who: [answer.ms for answer in every[5:]] for who, every in given.items()}
            worst = {who: float(np.percentile(ms, 95)) for who, ms in wall.items()}
            yield Figure(f"cost, {where} (95th percentile)", "ms", worst[REFERENCE], worst[OURS], None)
            ms = {who: float(np.median(every)) for who, every in wall.items()}
            yield Figure(f"cost, {where} (median)", "ms", ms[REFERENCE], ms[OURS], most * ms[REFERENCE])
            cpu = {who: float(np.median([answer.cpu_ms for answer in every[5:]])) for who, every in given.items()}
            yield Figure(f"the same in processor time, {where}", "ms", cpu[REFERENCE], cpu[OURS], most * cpu[REFERENCE])

    def _errors(self, name: str, take: Take, most_deg: float | None, flips: bool = False) -> Iterator[Figure]:
        given = self._contend(take)
        deg = {who: float(np.median(rotation_errors_deg(every))) for who, every in given.items()}
        yield Figure(f"median rotation error, {name}", "°", deg[REFERENCE], deg[OURS], most_deg)
        if flips:
            lasting = {who: lasting_flips(every) for who, every in given.items()}
            yield Figure(f"lasting flips, {name}", "", float(lasting[REFERENCE]), float(lasting[OURS]), 0.0)
            share = {who: 100 * flipped_share(every) for who, every in given.items()}
            yield Figure(f"frames flipped, {name}; OpenCV unrefined", "%", share[UNREFINED], share[OURS], 0.0)
        honesty = normalised_error_squared(given[OURS])
        yield Figure(f"squared error over its covariance, {name}", "", None, honesty, None)

    def _jitter(self, name: str, take: Take) -> Iterator[Figure]:
        given = {who: every[SETTLED_FRAMES:] for who, every in self._contend(take).items()}
        raw = corner_jitter_px(given[REFERENCE], take.camera)
        yield Figure(f"jitter at rest, {name}", "px", raw, corner_jitter_px(given[OURS], take.camera), 0.005)
        unfiltered = corner_jitter_px(given[OURS], take.camera, unfiltered=True)
        yield Figure(f"the same unfiltered, {name}", "px", raw, unfiltered, None)

    def _detection(self, name: str, take: Take) -> Iterator[Figure]:
        given = self._contend(take, cold=True)
        share = {who: 100 * found_share(every) for who, every in given.items()}
        yield Figure(f"found, {name}", "%", share[REFERENCE], share[OURS], None, least=share[REFERENCE])


@contextmanager
def _one_thread() -> Iterator[None]:
    """As in the viewer, whose other threads need the cores."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
