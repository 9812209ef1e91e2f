"""The bench of the cube: its pose beside a flat marker's, and the lights that its shadows tell."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.cube.ambient import ambient_errors
from ashe_live.bench.cube.painter import CubeScene, painted
from ashe_live.bench.cube.scenes import CAMERA, EDGE_M, SETS, CubeSet, looking, sun
from ashe_live.bench.cube.shadow_in_view import is_seen
from ashe_live.bench.metrics import ELLIPSE_95, squared_sigmas
from ashe_live.bench.tables import figures_table
from ashe_live.bench.track.frames import CLEAN_CAMERA
from ashe_live.bench.track.frames import painted as painted_flat
from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Float, Image
from ashe_live.core.contract import Json
from ashe_live.core.transforms import angle_between
from ashe_live.core.types import Frame, Light, LightEstimate
from ashe_live.light.estimators.estimator import make_estimator
from ashe_live.quality import Quality
from ashe_live.tracking.families.layout import Layout, cube_layout
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker

TILTS_DEG = (30, 75, 85)  # of the view, away from straight above: the last is where a flat marker is edge-on
DISTANCE_M = 0.35  # of the camera
FLAT = "aruco:4x4_50:0"
SURE, WRONG_RAD = 0.5, math.radians(15)  # confidence above which, and error beyond which, an answer is a confident lie
# Frames of a marker at rest, and those at the beginning that find and learn it.
FOLLOWED, FIRST = 12, 4


class _Tracked(NamedTuple):
    error_deg: float  # of the rotation, in the first frame
    following_s: float


@dataclass(frozen=True, slots=True)
class CubeBench(Bench):
    """Painted cubes with known truth."""

    quality: Quality
    count: int  # scenes of each set
    seed: int = 0  # of other scenes of the same kinds

    def parts(self) -> Iterator[Json]:
        """Poses first, then lights set by set."""
        yield {"tracking": self._tracking()}
        table = figures_table(
            f"light of a cube of {1000 * EDGE_M:g} mm, {self.count} pictures each, 640x480",
            "set", "answered", "median", "95 %", "largest", "hidden", "95 % of others", "sure and wrong", "in ellipse",
            "count right", "worse light", "even sky", "leaning", "as lamps", "distance", "ms",
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
            looks = [looking(DISTANCE_M, tilt, 20.0 + 37 * number) for number in range(max(3, self.count // 4))]
            of_flat, of_cube = [], []
            for number, T in enumerate(looks):
                rng = np.random.default_rng(number)
                picture = painted_flat(flat.bitmap(300), EDGE_M, CAMERA, [T], CLEAN_CAMERA, rng)
                of_flat.append(self._tracked(flat, picture, T))
                of_cube.append(self._tracked(cube, painted(CubeScene(CAMERA, T, [sun(200, 40)], seed=number)), T))
            both = [(a, b) for a, b in zip(of_flat, of_cube, strict=True) if a is not None and b is not None]
            row: Json = {
                "tilt_deg": tilt,
                "flat_deg": _median([one.error_deg for one in of_flat if one is not None]),
                "cube_deg": _median([one.error_deg for one in of_cube if one is not None]),
                "cost_ratio": _median([b.following_s / a.following_s for a, b in both]),
                "flat_found": sum(one is not None for one in of_flat) / len(looks),
                "cube_found": sum(one is not None for one in of_cube) / len(looks),
            }
            rows.append(row)
            shown = (f"{_shown(row[f'{name}_deg'])}° ({row[f'{name}_found']:.0%} found)" for name in ("flat", "cube"))
            table.add_row(f"{tilt}°", *shown, _shown(row["cost_ratio"]))
        self.console.print(table)
        return rows

    def _tracked(self, target: Marker | Layout, picture: Image, T_cam_marker: Float) -> _Tracked | None:
        """None where it is not found."""
        tracker = self._tracker(target)
        pose = tracker.track(Frame(picture, 0, 0.0)).marker
        if pose is None:
            return None
        return _Tracked(turn_deg(pose.measured_T_cam_marker, T_cam_marker), _following_s(tracker, picture))

    def _lights(self, one: CubeSet) -> Json:
        """Errors of the strongest light, of the true one that is found worst, and of the ambient light."""
        estimator = make_estimator("proxy", self.quality.light)
        first, worse, ambient, counted, spent, answered = [], [], [], [], [], 0
        within, distances, in_view, seen, wrong = [], [], [], [], 0
        for scene in one.scenes(self.count, self.seed):
            seen.append(all(is_seen(scene, light) for light in scene.lights))
            tracked = self._tracker(cube_layout()).track(Frame(painted(scene), 0, 0.0))
            if tracked.marker is None:
                continue
            begin = time.thread_time()
            estimate = estimator.estimate(tracked)
            spent.append(1e3 * (time.thread_time() - begin))
            if not estimate.lights:
                continue
            answered += 1
            wrong += _is_sure_and_wrong(estimate, scene)
            counted.append(len(estimate.lights) == one.lights)
            if one.lights:
                errors = _errors_deg(estimate, scene)
                first.append(errors[0].min())
                in_view += [errors[0].min()] if seen[-1] else []
                worse.append(errors.min(axis=0).max())
                true = scene.lights[int(errors[0].argmin())].point
                light = estimate.lights[0]
                assert light.covariance_rad2 is not None
                squared = squared_sigmas(light.to_light_marker, light.covariance_rad2, true[:3])
                within.append(squared <= ELLIPSE_95)
                if light.inverse_distance > 0:
                    distances.append(abs(_true_over_found_distance(light, true) - 1))
                ambient.append(ambient_errors(scene, estimate.illumination))
        return {
            "set": one.name,
            "answered": answered / self.count,
            "median_deg": _median(first),
            "percentile_95_deg": float(np.percentile(first, 95)) if first else None,
            "largest_deg": max(first, default=None),
            "shadow_hidden": 1 - float(np.mean(seen)),
            "percentile_95_of_others_deg": float(np.percentile(in_view, 95)) if in_view else None,
            "sure_and_wrong": wrong,
            "in_95_percent_ellipse": float(np.mean(within)) if within else None,
            "count_right": float(np.mean(counted)) if counted else None,
            "worse_median_deg": _median(worse),
            "ambient_even": _median([even for even, _ in ambient]),
            "ambient_leaning": _median([leaning for _, leaning in ambient]),
            "stated_as_lamps": len(distances) / len(first) if first else None,
            "distance_relative_error": _median(distances),
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


def _errors_deg(estimate: LightEstimate, scene: CubeScene) -> Float:
    """(answered lights, true lights) angles between them."""
    return np.array(
        [
            [math.degrees(angle_between(light.to_light_marker, true.point[:3])) for true in scene.lights]
            for light in estimate.lights
        ]
    )


def _is_sure_and_wrong(estimate: LightEstimate, scene: CubeScene) -> bool:
    """Whether a light is stated as likelier right than wrong, far from every true one."""
    return any(
        (light.confidence or 0.0) > SURE
        and all(angle_between(light.to_light_marker, true.point[:3]) > WRONG_RAD for true in scene.lights)
        for light in estimate.lights
    )


def _true_over_found_distance(light: Light, true: Float) -> float:
    """1 of what is told rightly; infinite for a sun (4,) that is taken for a lamp."""
    return float(np.linalg.norm(true[:3]) / true[3] * light.inverse_distance) if true[3] > 0 else math.inf


def _median(values: Sequence[float]) -> float | None:
    return float(np.median(values)) if len(values) else None


def _shown(value: object) -> str:
    return "-" if value is None else f"{value:.2f}" if isinstance(value, float) else str(value)
