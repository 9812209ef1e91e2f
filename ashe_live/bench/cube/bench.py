"""The bench of the cube: its pose compared with a flat marker's, and the lights estimated from its shadows."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ashe_live.bench.bench import Bench
from ashe_live.bench.cube.lights import light_row
from ashe_live.bench.cube.painted_scene import CubeScene
from ashe_live.bench.cube.painter import painted
from ashe_live.bench.cube.pictures import CubePicture, painted_pictures, traced_picture, traced_pictures
from ashe_live.bench.cube.scenes import CAMERA, EDGE_M, SETS, looking, sun
from ashe_live.bench.metrics import median
from ashe_live.bench.tables import figures_table
from ashe_live.bench.track.frames import PrintedMarker
from ashe_live.bench.track.measures import turn_deg
from ashe_live.core.arrays import Float, Image
from ashe_live.core.contract import Json
from ashe_live.core.types import Frame
from ashe_live.quality import Quality
from ashe_live.tracking.families.layout import Layout, cube_layout
from ashe_live.tracking.families.markers import Marker, parse_marker
from ashe_live.tracking.tracker import MarkerTracker

TILTS_DEG = (30, 75, 85)  # of the view, away from straight above: the last is where a flat marker is edge-on
DISTANCE_M = 0.35  # of the camera
FLAT = "aruco:4x4_50:0"
# Frames of a marker at rest, and those at the beginning that find and learn it.
FOLLOWED, FIRST = 12, 4


class _Tracked(NamedTuple):
    error_deg: float  # of the rotation, in the first frame
    following_s: float


@dataclass(frozen=True, slots=True)
class CubeBench(Bench):
    """Cubes with known truth, painted here or path-traced in `scenes`."""

    quality: Quality
    count: int  # scenes of each set
    seed: int = 0  # of other scenes of the same kinds
    scenes: Sequence[Path] = ()  # folders with path-traced ones, which are measured in their place

    def parts(self) -> Iterator[Json]:
        """Poses first, then lights set by set; of path-traced scenes lights alone."""
        if not self.scenes:
            yield {"tracking": self._tracking()}
        rows = [light_row(name, pictures, self.quality) for name, pictures in self._pictures()]
        # Figures below each other, as there are too many for the width of a page.
        table = figures_table("light of a cube", "figure", *(row["set"] for row in rows))
        for figure in rows[0] if rows else ():
            if figure != "set":
                table.add_row(figure.replace("_", " "), *(_shown(row[figure]) for row in rows))
        self.console.print(table)
        yield {"light": rows}

    def _pictures(self) -> Iterator[tuple[str, Iterator[CubePicture]]]:
        """Sets by name."""
        if not self.scenes:
            yield from ((one.name, painted_pictures(one, self.count, self.seed)) for one in SETS)
            return
        for category, entries in traced_pictures(self.scenes).items():
            yield category, map(traced_picture, entries)

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
                picture = PrintedMarker(flat.bitmap(300), EDGE_M, CAMERA).painted([T], rng)
                of_flat.append(self._tracked(flat, picture, T))
                of_cube.append(self._tracked(cube, painted(CubeScene(CAMERA, T, [sun(200, 40)], seed=number)), T))
            both = [(a, b) for a, b in zip(of_flat, of_cube, strict=True) if a is not None and b is not None]
            row: Json = {
                "tilt_deg": tilt,
                "flat_deg": median(one.error_deg for one in of_flat if one is not None),
                "cube_deg": median(one.error_deg for one in of_cube if one is not None),
                "cost_ratio": median(b.following_s / a.following_s for a, b in both),
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
        tracker = MarkerTracker(target, CAMERA, EDGE_M, self.quality.tracking)
        pose = tracker.track(Frame(picture, 0, 0.0)).marker
        if pose is None:
            return None
        return _Tracked(turn_deg(pose.measured_T_cam_marker, T_cam_marker), _following_s(tracker, picture))


def _following_s(tracker: MarkerTracker, image: Image) -> float:
    """Processor time of a frame in which the marker rests."""
    spent = []
    for index in range(1, FOLLOWED + 1):
        begin = time.thread_time()
        tracker.track(Frame(image, index, index / 30))
        spent.append(time.thread_time() - begin)
    return float(np.median(spent[FIRST:]))


def _shown(value: object) -> str:
    return "-" if value is None else f"{value:.2f}" if isinstance(value, float) else str(value)
