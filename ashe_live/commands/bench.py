"""`ashe-live bench`: speed and accuracy, measured on this machine."""

import argparse
from typing import TYPE_CHECKING

from ashe_live.commands.flags.option_groups import DEFAULT_ESTIMATOR
from ashe_live.errors import ExitStatus
from ashe_live.quality import QUALITIES

if TYPE_CHECKING:
    from ashe_live.bench.bench import Bench


def run(options: argparse.Namespace) -> int:
    benches = {
        "viewer": _viewer,
        "soak": _soak,
        "render": _render,
        "light": _light,
        "track": _track,
        "cube": _cube,
        "fit-judge": _fit_judge,
        "fit-lamps": _fit_lamps,
        "fit-seconds": _fit_seconds,
    }
    benches[options.bench](options).run(options.out, options.overwrite)
    return ExitStatus.ANSWERED


def _viewer(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.viewer.bench import ViewerBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    return ViewerBench(shipped_clip(), QUALITIES[options.quality], options.estimator, options.frames, options.size)


def _soak(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.soak.bench import SoakBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    return SoakBench(shipped_clip(), QUALITIES[options.quality], options.estimator, options.frames)


def _render(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.render.bench import RenderBench
    from ashe_live.bench.render.budget import BudgetBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    if options.budget is not None:
        return BudgetBench(options.budget)
    return RenderBench(shipped_clip(), options.frames, options.pairs)


def _light(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.light.bench import QUICK_PRESETS, LightBench

    has_presets = options.estimator == DEFAULT_ESTIMATOR
    return LightBench(
        options.scenes,
        options.estimator,
        QUICK_PRESETS if options.quick or not has_presets else tuple(QUALITIES),
        options.quick,
        options.limit,
        options.casters,
        options.empty,
        options.tracked,
        sweeps=has_presets and not options.quick,
    )


def _track(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.track.bench import TrackBench

    preset = QUALITIES[options.quality].tracking
    return TrackBench(preset, options.real, options.photos, options.quick, tuple(options.scenes))


def _cube(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.cube.bench import CubeBench

    return CubeBench(QUALITIES[options.quality], options.count, options.seed, options.scenes)


def _fit_judge(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.judge.bench import JudgeBench
    from ashe_live.bench.judge.known_bodies import KnownBodiesBench
    from ashe_live.bench.judge.recalibration import RecalibrationBench
    from ashe_live.bench.judge.sheets import SheetsBench

    if options.sheets:  # looks at no explanations, and needs no processes beside its own
        return SheetsBench(options.scenes, options.limit, options.every)
    made = KnownBodiesBench if options.casters else RecalibrationBench if options.confidence else JudgeBench
    return made(options.scenes, options.limit, options.every, options.jobs)


def _fit_lamps(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.lamps.bench import LampBench

    return LampBench(options.scenes, options.limit)


def _fit_seconds(options: argparse.Namespace) -> "Bench":
    from ashe_live.bench.second_lights.bench import SecondLightsBench

    return SecondLightsBench(options.scenes, options.limit, options.every)
