"""`ashe-live bench`: speed and accuracy, measured on this machine."""

import argparse

from ashe_live.commands.flags.option_groups import DEFAULT_ESTIMATOR
from ashe_live.errors import ExitStatus
from ashe_live.quality import QUALITIES


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
    }
    benches[options.bench](options)
    return ExitStatus.ANSWERED


def _viewer(options: argparse.Namespace) -> None:
    from ashe_live.bench.viewer.bench import ViewerBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    ViewerBench(shipped_clip(), QUALITIES[options.quality], options.estimator, options.frames, options.size).run(
        options.out, options.overwrite
    )


def _soak(options: argparse.Namespace) -> None:
    from ashe_live.bench.soak.bench import SoakBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    SoakBench(shipped_clip(), QUALITIES[options.quality], options.estimator, options.frames).run(
        options.out, options.overwrite
    )


def _render(options: argparse.Namespace) -> None:
    from ashe_live.bench.render.bench import RenderBench
    from ashe_live.bench.render.budget import BudgetBench
    from ashe_live.capture.clips.known_clip import shipped_clip

    if options.budget is not None:
        BudgetBench(options.budget).run(options.out, options.overwrite)
        return
    RenderBench(shipped_clip(), options.frames, options.pairs).run(options.out, options.overwrite)


def _light(options: argparse.Namespace) -> None:
    from ashe_live.bench.light.bench import QUICK_PRESETS, LightBench

    has_presets = options.estimator == DEFAULT_ESTIMATOR
    bench = LightBench(
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
    bench.run(options.out, options.overwrite)


def _track(options: argparse.Namespace) -> None:
    from ashe_live.bench.track.bench import TrackBench

    bench = TrackBench(
        QUALITIES[options.quality].tracking, options.real, options.photos, options.quick, tuple(options.scenes)
    )
    bench.run(options.out, options.overwrite)


def _cube(options: argparse.Namespace) -> None:
    from ashe_live.bench.cube.bench import CubeBench

    quality = QUALITIES[options.quality]
    CubeBench(quality, options.count, options.seed, options.scenes).run(options.out, options.overwrite)


def _fit_judge(options: argparse.Namespace) -> None:
    from ashe_live.bench.judge.bench import JudgeBench
    from ashe_live.bench.judge.known_bodies import KnownBodiesBench
    from ashe_live.bench.judge.recalibration import RecalibrationBench
    from ashe_live.bench.judge.sheets import SheetsBench

    if options.sheets:  # looks at no explanations, and needs no processes beside its own
        SheetsBench(options.scenes, options.limit, options.every).run(options.out, options.overwrite)
        return
    made = KnownBodiesBench if options.casters else RecalibrationBench if options.confidence else JudgeBench
    made(options.scenes, options.limit, options.every, options.jobs).run(options.out, options.overwrite)


def _fit_lamps(options: argparse.Namespace) -> None:
    from ashe_live.bench.lamps.bench import LampBench

    LampBench(options.scenes, options.limit).run(options.out, options.overwrite)
