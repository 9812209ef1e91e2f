"""The bench of the cube: its pose beside a flat marker's, and the lights that its shadows tell."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.cube.painter import CubeScene, painted
from ashe_live.bench.cube.scenes import CAMERA, EDGE_M, SETS, CubeSet, looking, sun
from ashe_live.bench.tables import figures_table
from ashe_live.bench.track.frames import CLEAN_CAMERA
from ashe_live.bench.track.frames import painted as painted_flat
from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Image
from ashe_live.core.contract import Json
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, LightEstimate
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.quality import Quality
from ashe_live.tracking.families.layout import Layout, cube_layout
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker

TILTS_DEG = (30, 75, 85)
DISTANCE_M = 0.35
FLAT = "aruco:4x4_50:0"
# Frames of a marker at rest, and those at the beginning that find and learn it.
FOLLOWED, FIRST = 12, 4


@dataclass(frozen=True, slots=True)
class CubeBench(Bench):
    """Painted cubes with known truth."""

    quality: Quality
    count: int  # scenes of each set

    def parts(self) -> Iterator[Json]:
        """Poses first, then lights set by set."""
        yield {"tracking": self._tracking()}
        table = figures_table(
            f"light of a cube of {1000 * EDGE_M:g} mm, {self.count} pictures each, 640x480",
            "set", "answered", "median", "95 %", "largest", "count right", "worse light, median", "ms",
        )  # fmt: skip
        rows = []
        for one in SETS:
            row = self._lights(one)
            rows.append(row)
            table.add_row(*(_shown(value) for value in row.values()))
        self.console.print(table)
        yield {"light": rows}

    def _tracking(self) -> list[Json]:
        table = figures_table(
            "rotation error of a single frame, and the cost of following", "tilt", "flat", "cube", "cost over flat's"
        )
        rows: list[Json] = []
        flat, cube = parse_marker(FLAT), cube_layout()
        for tilt in TILTS_DEG:
            turns = [20.0 + 37 * number for number in range(max(3, self.count // 4))]
            errors: dict[str, list[float]] = {"flat": [], "cube": []}
            costs: list[float] = []
            for number, azimuth in enumerate(turns):
                T = looking(DISTANCE_M, tilt, azimuth)
                rng = np.random.default_rng(number)
                pictures = {
                    "flat": painted_flat(flat.bitmap(300), EDGE_M, CAMERA, [T], CLEAN_CAMERA, rng),
                    "cube": painted(CubeScene(CAMERA, T, [sun(200, 40)], seed=number)),
                }
                spent = {}
                for name, target in (("flat", flat), ("cube", cube)):
                    tracker = self._tracker(target)
                    pose = tracker.track(Frame(pictures[name], 0, 0.0)).marker
                    if pose is not None:
                        errors[name].append(turn_deg(pose.measured_T_cam_marker, T))
                        spent[name] = _following_s(tracker, pictures[name])
                if len(spent) == 2:
                    costs.append(spent["cube"] / spent["flat"])
            row: Json = {
                "tilt_deg": tilt,
                "flat_deg": _median(errors["flat"]),
                "cube_deg": _median(errors["cube"]),
                "cost_ratio": _median(costs),
                "flat_found": len(errors["flat"]) / len(turns),
                "cube_found": len(errors["cube"]) / len(turns),
            }
            rows.append(row)
            shown = (f"{_shown(row[f'{name}_deg'])}° ({row[f'{name}_found']:.0%} found)" for name in ("flat", "cube"))
            table.add_row(f"{tilt}°", *shown, _shown(row["cost_ratio"]))
        self.console.print(table)
        return rows

    def _lights(self, one: CubeSet) -> Json:
        estimator = make_estimator("proxy", self.quality.light)
        first, worse, counted, spent, answered = [], [], [], [], 0
        for scene in one.scenes(self.count):
            tracked = self._tracker(cube_layout()).track(Frame(painted(scene), 0, 0.0))
            if tracked.marker is None:
                continue
            begin = time.thread_time()
            estimate = estimator.estimate(tracked)
            spent.append(1e3 * (time.thread_time() - begin))
            if not estimate.lights:
                continue
            answered += 1
            counted.append(len(estimate.lights) == one.lights)
            if one.lights:
                first.append(min(_errors(estimate, scene)[0]))
                worse.append(max(min(row) for row in np.array(_errors(estimate, scene)).T.tolist()))
        return {
            "set": one.name,
            "answered": answered / self.count,
            "median_deg": _median(first),
            "percentile_95_deg": float(np.percentile(first, 95)) if first else None,
            "largest_deg": max(first, default=None),
            "count_right": float(np.mean(counted)) if counted else None,
            "worse_median_deg": _median(worse),
            "ms": _median(spent),
        }

    def _tracker(self, target: Marker | Layout) -> MarkerTracker:
        return MarkerTracker(target, CAMERA, EDGE_M, self.quality.tracking)


def _following_s(tracker: MarkerTracker, image: Image) -> float:
    """Processor time of a frame in which the marker rests."""
    spent = []
    for index in range(1, FOLLOWED + 1):
        begin = time.thread_time()
        tracker.track(Frame(image, index, index / 30))
        spent.append(time.thread_time() - begin)
    return float(np.median(spent[FIRST:]))


def _errors(estimate: LightEstimate, scene: CubeScene) -> list[list[float]]:
    """Degrees between each answered light and each true one."""
    return [
        [math.degrees(angle_between(light.to_light_marker, true.point[:3])) for true in scene.lights]
        for light in estimate.lights
    ]


def _median(values: Sequence[float]) -> float | None:
    return float(np.median(values)) if len(values) else None


def _shown(value: object) -> str:
    return "-" if value is None else f"{value:.2f}" if isinstance(value, float) else str(value)
