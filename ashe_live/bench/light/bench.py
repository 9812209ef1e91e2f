"""`ashe-live bench light`: the estimators' errors, calibration and times on pictures and clips with a known light."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import ClassVar

from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.cases import Case, over_empty_tables, read_cases
from ashe_live.bench.light.clips import ClipResult, estimate_clip, frames_of, read_clips
from ashe_live.bench.light.known_casters import print_known_casters, with_known_casters
from ashe_live.bench.light.preset_tables import print_preset
from ashe_live.bench.light.results import CaseResult, case_result, grouped, stage_times, summarise, timed_estimate
from ashe_live.bench.light.set_tables import (
    print_clips,
    print_lamp_takes,
    print_lamps,
    print_places,
    print_risk,
    print_takes,
)
from ashe_live.bench.light.takes import Take, TakeResult, read_takes, take_results
from ashe_live.bench.light.trade import COST, print_trade, sweep
from ashe_live.bench.light.truth import error_on_true_labels_deg, mask_overlaps
from ashe_live.bench.machine import measured_with
from ashe_live.bench.plots import SUFFIXES, draw_trade, points_of
from ashe_live.core.caster import Caster
from ashe_live.core.contract import Json
from ashe_live.core.types import TrackedFrame
from ashe_live.errors import UserError
from ashe_live.light.estimators.estimator import Estimator, make_estimator
from ashe_live.light.estimators.preset import ProxyPreset
from ashe_live.quality import LIGHT_PRESETS, QUALITIES

QUICK_PRESETS = ("balanced",)
QUICK_EVERY, QUICK_CLIP_FRAMES = 5, 4  # with --quick: every fifth scene, and so many frames of a clip
TRADE, SWEEP_EVERY = "trade", 3  # the plot's name, and of how many scenes it takes one
# Presets by estimator for the runs from true labels, which exist for `proxy` only.
FROM_LABELS = {"proxy": LIGHT_PRESETS}


@dataclass(frozen=True, slots=True)
class LightBench(Bench):
    """The bench of `presets` of `estimator` on the folders `scenes`, which are pooled into one set."""

    SCHEMA: ClassVar[int] = 5

    scenes: Sequence[Path]
    estimator: str = "proxy"
    presets: Sequence[str] = tuple(QUALITIES)
    quick: bool = False  # a few scenes of each category, a few frames of each clip
    limit: int | None = None  # number of scenes of each folder, the first ones; None: all
    casters: bool = False  # also with the objects' shapes and sizes given, where they are boxes, cylinders or spheres
    empty: Path | None = None  # a folder of the same pictures without the object, their clean plates
    tracked: bool = False  # takes by the tracker's own poses, and a focal length that is not quite right
    sweeps: bool = False  # also measures and draws error against time, on some scenes of each category

    def parts(self) -> Iterator[Json]:
        estimators = {preset: make_estimator(self.estimator, LIGHT_PRESETS[preset]) for preset in self.presets}
        yield self._measured(estimators)
        if self.sweeps:
            points = sweep(thinned(self.cases(), SWEEP_EVERY), self.takes()[::SWEEP_EVERY], estimators, self.console)
            if points:
                print_trade(self.console, points)
                yield {"trade": [asdict(point) for point in points]}

    def plots(self) -> Sequence[str]:
        return [TRADE + suffix for suffix in SUFFIXES] if self.sweeps else ()

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        if "trade" in record:
            points = points_of(record["trade"])
            draw_trade(points, "Light estimation: error against time", COST, _note(record), out / TRADE, overwrite)

    def _measured(self, estimators: Mapping[str, Estimator]) -> Json:
        known_cases = self._known_cases()
        results = self._results(estimators)
        clips = self._clip_results(estimators)
        takes = self._take_results(estimators)
        presets = {preset: self._printed_preset(preset, results, clips) for preset in estimators}
        if results:
            print_risk(self.console, results)
            print_lamps(self.console, results)
            print_places(self.console, results)
        if clips:
            print_clips(self.console, clips)
        if takes:
            print_takes(self.console, takes)
            print_lamp_takes(self.console, takes)
        known = self._known_caster_results(known_cases)
        if known:
            print_known_casters(self.console, results, known)
        return {
            "scenes": [folder.resolve().name for folder in self.scenes],
            "quick": self.quick,
            "limit": self.limit,
            "tracked": self.tracked,
            "over_empty_tables": self.empty is not None,
            "estimator": self.estimator,
            "presets": presets,
            "cases": [asdict(result) for result in results],
            "takes": [asdict(result) for result in takes],
            "known_casters": [asdict(result) for result in known],
        }

    def _printed_preset(self, preset: str, results: Sequence[CaseResult], clips: Sequence[ClipResult]) -> Json:
        """One preset's share of what was measured, whose tables it prints."""
        of_preset = [result for result in results if result.preset == preset]
        summaries = {group: summarise(members) for group, members in grouped(of_preset).items()}
        stages = stage_times(of_preset)
        if of_preset:
            print_preset(self.console, f"{self.estimator}, {preset}", summaries, stages, of_preset)
        return {
            "summaries": {group: asdict(summary) for group, summary in summaries.items()},
            "stages_ms": stages,
            "clips": [asdict(clip) for clip in clips if clip.preset == preset],
        }

    def cases(self) -> list[Case]:
        """The cases with a known light; with `quick`, every fifth of each category."""
        cases = [case for folder in self.scenes for case in _known(read_cases(folder))[: self.limit]]
        cases = cases if self.empty is None else over_empty_tables(cases, self.empty)
        return thinned(cases, QUICK_EVERY) if self.quick else cases

    def takes(self) -> list[Take]:
        """The takes with a known light; with `quick`, every fifth."""
        takes = [take for folder in self.scenes for take in read_takes(folder)[: self.limit]]
        return [replace(take, is_tracked=self.tracked) for take in takes[:: QUICK_EVERY if self.quick else 1]]

    def _results(self, estimators: Mapping[str, Estimator]) -> list[CaseResult]:
        """All presets on each case in turn, so that other load on the machine affects them equally."""
        results = []
        cases = self.cases()
        if cases:  # one-time initialisation is not to be timed
            for estimator in estimators.values():
                estimator.estimate(cases[0].tracked())
        for index, case in enumerate(track(cases, "scenes", console=self.console, transient=True)):
            tracked = case.tracked(index)
            for preset, estimator in estimators.items():
                for_labels = FROM_LABELS.get(self.estimator, {}).get(preset)
                results.append(attempt(estimator, preset, case, tracked, for_labels))
        return results

    def _known_cases(self) -> list[tuple[Case, Caster]]:
        """The cases that are also run with their caster given; raises UserError if the estimator has no use for it."""
        if not self.casters:
            return []
        if self.estimator not in FROM_LABELS:
            raise UserError(f"the estimator {self.estimator} makes no use of known casters", "leave out --casters")
        return with_known_casters(self.cases(), self.scenes)

    def _known_caster_results(self, cases: Sequence[tuple[Case, Caster]]) -> list[CaseResult]:
        """All presets on each case, with its caster given."""
        results = []
        for index, (case, caster) in enumerate(track(cases, "known casters", console=self.console, transient=True)):
            tracked = case.tracked(index)
            for preset in self.presets:
                estimator = make_estimator(self.estimator, LIGHT_PRESETS[preset].assuming(caster=caster))
                results.append(replace(attempt(estimator, preset, case, tracked, None), caster=caster.kind))
        return results

    def _clip_results(self, estimators: Mapping[str, Estimator]) -> list[ClipResult]:
        limit = QUICK_CLIP_FRAMES if self.quick else self.limit
        results = []
        clips = [clip for folder in self.scenes for clip in read_clips(folder)]
        for clip in track(clips, "clips", console=self.console, transient=True):
            frames = frames_of(clip, limit)
            results += [estimate_clip(estimator, preset, clip, frames) for preset, estimator in estimators.items()]
        return results

    def _take_results(self, estimators: Mapping[str, Estimator]) -> list[TakeResult]:
        """All presets and numbers of views on each take in turn."""
        results: list[TakeResult] = []
        for take in track(self.takes(), "takes", console=self.console, transient=True):
            results += take_results(take, estimators)
        return results


def attempt(
    estimator: Estimator, preset: str, case: Case, tracked: TrackedFrame, for_labels: ProxyPreset | None
) -> CaseResult:
    """The timed estimate of `tracked`, the picture of `case`, compared with the case's truth.

    for_labels: the preset for the run from true labels; None for none.
    """
    estimate, cpu_ms = timed_estimate(estimator, tracked)
    alone = None if for_labels is None else error_on_true_labels_deg(case, tracked, for_labels)
    return case_result(preset, case, estimate, cpu_ms, mask_overlaps(estimate, case), alone)


def thinned(cases: Sequence[Case], every: int) -> list[Case]:
    """The first case of each category, and every `every`th after it."""
    seen: Counter[str] = Counter()
    kept = []
    for case in cases:
        if seen[case.category] % every == 0:
            kept.append(case)
        seen[case.category] += 1
    return kept


def _note(record: Json) -> str:
    return f"{measured_with(record)}; every {SWEEP_EVERY}rd scene of {', '.join(record['scenes'])}"


def _known(cases: Sequence[Case]) -> list[Case]:
    return [case for case in cases if case.to_lights_marker is not None]
