"""What a known caster gains: the scenes' own boxes, cylinders and spheres, with their sizes given as by `--caster`."""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from ashe_live.bench.cases import GROUND_TRUTH, Case, ground_truth
from ashe_live.bench.light.results import CaseResult, summarise
from ashe_live.bench.metrics import median
from ashe_live.bench.tables import degrees, figures_table, percent
from ashe_live.core.caster import Caster, parsed_caster

SPECIFICATIONS = "specifications.json"  # beside the truth in the generator's own sets
# A box's sides follow from its bounding box and its yaw, except near 45 degrees: the least |cos 2 yaw| for that.
LEAST_TOLD = 0.3


def with_known_casters(cases: Sequence[Case], folders: Sequence[Path]) -> list[tuple[Case, Caster]]:
    """The cases of these folders that have a light and a caster of `caster_specs`, each with that caster."""
    specs: dict[str, dict[str, str]] = defaultdict(dict)  # several folders may have one name, as parts of a set
    for folder in folders:
        specs[folder.resolve().name] |= caster_specs(folder)
    lit = (case for case in cases if case.to_lights_marker is not None and len(case.to_lights_marker))
    return [(case, parsed_caster(specs[case.folder][case.id])) for case in lit if case.id in specs[case.folder]]


def caster_specs(folder: Path) -> dict[str, str]:
    """By the case's id, the main object as `--caster` takes it, where it is a box, a cylinder or a sphere.

    Raises UserError where the folder's files cannot be read or are not a set of scenes.
    """
    is_generated = (folder / SPECIFICATIONS).exists()
    file = SPECIFICATIONS if is_generated else GROUND_TRUTH
    with ground_truth(folder, "scenes", "`scenes` with their objects", file) as content:
        return dict(_as_specified(content) if is_generated else _as_bounded(content))


def print_known_casters(console: Console, free: Sequence[CaseResult], known: Sequence[CaseResult]) -> None:
    """Prints, kind by kind and preset by preset, the answers to the same pictures for any object and the known one."""
    columns = ("pictures", "answered", "median", "of those answered both ways", "p90", "95 % ellipse", "sure and wrong")
    table = figures_table("known casters", ("caster", "preset", "fitted"), *columns)
    kinds = {(result.folder, result.case): str(result.caster) for result in known}
    for kind in (None, *dict.fromkeys(kinds.values())):
        for preset in dict.fromkeys(result.preset for result in known):
            several: list[dict[tuple[str, str], CaseResult]] = [{}, {}]
            for of_kind, results in zip(several, (free, known), strict=True):
                for each in results:
                    key = each.folder, each.case
                    if each.preset == preset and key in kinds and kind in (None, kinds[key]):
                        of_kind[key] = each
            both = [key for key in several[1] if all(of_kind[key].is_answered for of_kind in several)]
            for name, of_kind in zip(("any object", "known"), several, strict=True):
                summary = summarise(list(of_kind.values()))
                paired = median(of_kind[key].error_deg for key in both)
                table.add_row(
                    kind or "all",
                    preset,
                    name,
                    str(summary.attempted),
                    percent(1 - summary.abstained / max(summary.attempted, 1)),
                    *map(degrees, (summary.median_deg, paired, summary.p90_deg)),
                    *map(percent, (summary.within_ellipse_95, summary.bad_share)),
                )
    console.print(table)


def _as_specified(content: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for scene in content["scenes"]:
        spec = next((_of_family(each) for each in scene["objects"] if each["role"] == "caster"), None)
        if spec is not None:
            yield from ((picture["id"], spec) for picture in scene["pictures"])


def _of_family(specified: Mapping[str, Any]) -> str | None:
    """The kind of a generator's family that a person would measure as a box, cylinder or sphere; None for others."""
    family, params = specified["family"], specified["params"]
    if family == "carton":
        return _box(*params["size_m"])
    if family == "book":
        width, depth, thickness = params["size_m"]
        return _box(width, thickness, depth) if params["standing"] else _box(width, depth, thickness)
    if family == "tin":
        return f"cylinder:{params['above_m']}x{params['height_m']}"
    if family == "ball" and params.get("flatten", 1.0) == 1.0:
        return f"sphere:{params['radius_m']}"
    return None


def _as_bounded(content: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for scene in content.get("scenes", []):
        caster = scene.get("caster") or {}
        if caster.get("type") not in ("box", "cylinder", "sphere"):
            continue
        across, along, height = np.subtract(caster["bbox_max_m"], caster["bbox_min_m"]).tolist()
        yaw = math.radians(caster["yaw_deg"])
        if caster["type"] == "cylinder":
            yield scene["id"], f"cylinder:{across / 2:.5f}x{height:.5f}"
        elif caster["type"] == "sphere":
            yield scene["id"], f"sphere:{height / 2:.5f}"
        elif abs(math.cos(2 * yaw)) >= LEAST_TOLD:
            c, s = abs(math.cos(yaw)), abs(math.sin(yaw))
            width, depth = np.linalg.solve([[c, s], [s, c]], [across, along]).tolist()
            yield scene["id"], _box(width, depth, height)


def _box(width_m: float, depth_m: float, height_m: float) -> str:
    return f"box:{width_m:.5f}x{depth_m:.5f}x{height_m:.5f}"
