"""`ashe-live bench render`: the renderer's frame times, and its differences from a path tracer."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.loops import time_blit, time_unpaced
from ashe_live.bench.machine import measured_with
from ashe_live.bench.plots import SUFFIXES
from ashe_live.bench.render.cost import (
    cost_of,
    costs_by_turns,
    lamps_around,
    lights_around,
    memory_growth,
    orbit,
    round_model,
    sweeps,
)
from ashe_live.bench.render.drawing import COSTS, ERRORS, draw_errors, draw_sweeps
from ashe_live.bench.render.error import picture_error, read_references
from ashe_live.bench.render.forced_choice import forced_choice
from ashe_live.bench.render.pairs import pair_error, read_pairs
from ashe_live.bench.render.tables import print_render_figures
from ashe_live.capture.clips.clip import ClipSource
from ashe_live.capture.clips.known_clip import KnownClip
from ashe_live.core.camera import Size
from ashe_live.core.contract import Json
from ashe_live.core.light import Illumination, Light
from ashe_live.core.types import TrackedFrame
from ashe_live.files.resources import resource
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import placed_on_marker
from ashe_live.quality import BALANCED, FAST, QUALITIES
from ashe_live.render.gl.offscreen import Context, offscreen_context
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.families.markers import parse_marker
from ashe_live.tracking.tracker import MarkerTracker
from ashe_live.viewer.cores import leave_cores_to_renderer

LOOP_SIZES: tuple[Size, ...] = ((640, 480), (1280, 720))
SWEEP_SIZE: Size = (1280, 720)
LARGE_SIZE: Size = (1920, 1080)
MEMORY_FRAMES = 1000  # with changes of the model, during which memory is watched


@dataclass(frozen=True, slots=True)
class RenderBench(Bench):
    """The renderer's bench on `clip`."""

    NEEDS_OPENGL: ClassVar[bool] = True

    clip: KnownClip
    frames: int  # of each loop
    pairs: Path | None = None  # folder of path-traced pairs, which assets/sources/scenes/pairs.py makes

    def parts(self) -> Iterator[Json]:
        leave_cores_to_renderer()
        ctx = offscreen_context()
        figures: Json = {
            "loop": [self._loop(ctx, size) for size in LOOP_SIZES],
            "large": _large(ctx, self.frames),
            "sweeps": _sweeps(ctx, max(5, self.frames // 10)),
            "lamps": _lamps(ctx, self.frames),
            "errors": _errors(ctx, max(5, self.frames // 10)),
            "memory": self._memory(ctx),
            "pairs": [] if self.pairs is None else _pairs(ctx, self.pairs),
        }
        print_render_figures(self.console, figures)
        yield figures

    def plots(self) -> Sequence[str]:
        return [COSTS, *(ERRORS + suffix for suffix in SUFFIXES)]

    def draw(self, record: Json, out: Path, overwrite: bool) -> None:
        draw_errors(record["errors"], measured_with(record), out / ERRORS, overwrite)
        draw_sweeps(record["sweeps"], measured_with(record), out / COSTS, overwrite)

    def _loop(self, ctx: Context, size: Size) -> Json:
        """Times of decoding, tracking and rendering in `fast`, and of drawing the bare video in the same run."""
        clip = self.clip
        assert clip.to_light_marker is not None
        light = Light(clip.to_light_marker)
        model = placed_on_marker(load_model("cube"), clip.marker_side_m)
        renderer = SceneRenderer(ctx, FAST.render, size)
        tracker = MarkerTracker(parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, FAST.tracking)

        def scene(tracked: TrackedFrame) -> Scene:
            return Scene(tracked, model, Illumination((light,)))

        with ClipSource(clip.path) as source:
            times = time_unpaced(source, tracker, renderer, scene, self.frames)
            copied = time_blit(source, tracker, renderer, clip.camera, self.frames)
            renderer.release()
            # With one row more than the picture has, the video is drawn instead of copied.
            renderer = SceneRenderer(ctx, FAST.render, (size[0], size[1] + 1))
            drawn = time_blit(source, tracker, renderer, clip.camera, self.frames)
        renderer.release()
        medians = {stage: float(np.median(ms)) for stage, ms in times.wall_ms.items()}
        return {
            "size": list(size),
            **medians,
            "video_copied": float(np.median(copied.wall_ms["blit"])),
            "video_drawn": float(np.median(drawn.wall_ms["blit"])),
        }

    def _memory(self, ctx: Context) -> Json:
        models = [placed_on_marker(load_model(name), self.clip.marker_side_m) for name in model_names()]
        views = orbit((320, 240), None, lights_around(1))
        growth = memory_growth(ctx, FAST.render, models, lambda number: views[number % len(views)], MEMORY_FRAMES)
        return {"frames": MEMORY_FRAMES, **growth}


def _large(ctx: Context, frames: int) -> Json:
    scenes = orbit(LARGE_SIZE, round_model(100_000), lights_around(1))
    return {
        "size": list(LARGE_SIZE),
        "triangles": 100_000,
        **asdict(cost_of(ctx, BALANCED.render, LARGE_SIZE, scenes, max(5, frames // 5))),
    }


def _sweeps(ctx: Context, frames: int) -> Json:
    found: Json = {}
    for name, settings in sweeps(BALANCED.render).items():
        found[name] = []
        for value, preset, lights, triangles in track(settings, f"cost by {name}", transient=True):
            scenes = orbit(SWEEP_SIZE, round_model(triangles), lights_around(lights))
            found[name].append({"value": value, **asdict(cost_of(ctx, preset, SWEEP_SIZE, scenes, frames))})
    return found


def _lamps(ctx: Context, frames: int) -> Json:
    """What a lamp costs beside a sun, preset by preset."""
    found: Json = {}
    for quality in QUALITIES.values():
        scenes = [orbit(LOOP_SIZES[0], round_model(10_000), lights) for lights in (lights_around(1), lamps_around(1))]
        (sun, sun_cpu), (lamp, lamp_cpu) = costs_by_turns(ctx, quality.render, LOOP_SIZES[0], scenes, frames)
        found[quality.name] = {"sun": sun, "lamp": lamp, "sun_cpu": sun_cpu, "lamp_cpu": lamp_cpu}
    return found


def _errors(ctx: Context, frames: int) -> list[Json]:
    """Errors of the presets and of variations of `balanced`; empty in an installed package, which has no references."""
    try:
        folder = resource("assets", "reference")
    except FileNotFoundError:
        return []
    references = read_references(folder)
    rows = []
    for name, series, preset in track(_settings(), "error against the path tracer", transient=True):
        errors = [picture_error(ctx, reference, preset) for reference in references]
        cost = cost_of(ctx, preset, (480, 360), [reference.scene for reference in references[:1]], frames)
        rows.append(
            {
                "name": name,
                "series": series,
                "ms": cost.p50,
                "scenes": {
                    reference.name: {"kind": reference.kind, **asdict(error)}
                    for reference, error in zip(references, errors, strict=True)
                },
                "shadow_iou_mean": float(np.mean([error.shadow_iou for error in errors])),
                "shadow_iou_least": min(error.shadow_iou for error in errors),
                "shadow_de": float(np.mean([error.shadow_de for error in errors])),
                "model_de": float(np.mean([error.model_de for error in errors])),
            }
        )
    return rows


def _pairs(ctx: Context, folder: Path) -> list[Json]:
    pairs = read_pairs(folder)
    rows = []
    for quality in QUALITIES.values():
        errors = [
            pair_error(ctx, pair, quality.render)
            for pair in track(pairs, f"photos of the same with the model, {quality.name}", transient=True)
        ]
        separability = forced_choice(
            [each.virtual_features for each in errors], [each.real_features for each in errors]
        )
        for pair, error in zip(pairs, errors, strict=True):
            figures = {key: value for key, value in asdict(error).items() if not isinstance(value, np.ndarray)}
            rows.append({"preset": quality.name, "scene": pair.name, **figures, "forced_choice": separability})
    return rows


def _settings() -> list[tuple[str, str, RenderPreset]]:
    base = BALANCED.render
    maps = [(str(size), replace(base, shadow_map_size=size, ground_shadow_size=size // 2)) for size in (128, 256, 512)]
    samples = [(str(count), base.with_samples(count)) for count in (0, 2, 8)]
    taps = [(f"{count}", replace(base, blocker_taps=count, soft_taps=2 * count)) for count in (2, 4, 32)]
    return [
        *((name, "presets", quality.render) for name, quality in QUALITIES.items()),
        *((name, "depth map", preset) for name, preset in maps),
        *((name, "samples a pixel", preset) for name, preset in samples),
        *((name, "penumbra taps", preset) for name, preset in taps),
    ]
