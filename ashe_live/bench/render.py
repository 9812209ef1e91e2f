"""`ashe-live bench render`: what pictures cost and how far they are from a path tracer's."""

from dataclasses import asdict, dataclass, replace
from datetime import date
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from ashe_live.bench.loops import time_blit, time_unpaced
from ashe_live.bench.machine import machine_json, versions_json
from ashe_live.bench.plots import SUFFIXES, TradePoint, check_can_draw, draw_trade
from ashe_live.bench.render_cost import cost_of, lights_around, memory_growth, orbit, round_model, sweeps
from ashe_live.bench.render_error import picture_error, read_references
from ashe_live.bench.tables import figures_table
from ashe_live.capture.clip import ClipSource
from ashe_live.capture.known_clip import KnownClip
from ashe_live.core.camera import Size
from ashe_live.core.contract import Json
from ashe_live.core.quality import BALANCED, FAST, QUALITIES, RenderPreset
from ashe_live.core.types import DirectionalLight, Illumination, TrackedFrame
from ashe_live.files.resources import resource
from ashe_live.files.writing import check_folder, write_json, written_whole
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import placed_on_marker
from ashe_live.render.offscreen import Context, offscreen_context
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from ashe_live.tracking.markers import parse_marker
from ashe_live.tracking.tracker import Tracker
from ashe_live.viewer.cores import leave_cores_to_renderer

SCHEMA = 1
RESULTS, ERRORS, COSTS = "render.json", "render-error", "render-cost.png"  # the second is a stem
LOOP_SIZES: tuple[Size, ...] = ((640, 480), (1280, 720))
SWEEP_SIZE: Size = (1280, 720)
LARGE_SIZE: Size = (1920, 1080)


@dataclass(frozen=True, slots=True)
class RenderBench:
    """What is measured."""

    clip: KnownClip
    frames: int  # of each loop
    memory_frames: int
    out: Path | None = None  # folder of render.json and the plots

    def run(self, overwrite: bool = False) -> Json:
        """Measures, prints, and writes to `out`; returns the record.

        Raises UserError for an unwritable `out`, without Matplotlib if it is given, or without OpenGL.
        """
        if self.out is not None:
            check_can_draw()
            check_folder(self.out, (RESULTS, COSTS, *(ERRORS + suffix for suffix in SUFFIXES)), overwrite)
        leave_cores_to_renderer()
        ctx = offscreen_context()
        record = {
            "schema": SCHEMA,
            "machine": {**machine_json(), "gl_renderer": ctx.info["GL_RENDERER"], "gl_version": ctx.info["GL_VERSION"]},
            "versions": versions_json(),
            "loop": [self._loop(ctx, size) for size in LOOP_SIZES],
            "large": _large(ctx, self.frames),
            "sweeps": _sweeps(ctx, max(5, self.frames // 10)),
            "errors": _errors(ctx, max(5, self.frames // 10)),
            "memory": self._memory(ctx),
        }
        print_render_record(record)
        if self.out is not None:
            write_json(self.out / RESULTS, record, overwrite, beside=True)
            _draw(record, self.out, overwrite)
        return record

    def _loop(self, ctx: Context, size: Size) -> Json:
        """Decode, track and render in `fast`, and the bare video in the same run."""
        clip = self.clip
        light = DirectionalLight(clip.to_light_marker)
        model = placed_on_marker(load_model("cube"), clip.marker_side_m)
        renderer = SceneRenderer(ctx, FAST.render, size)
        tracker = Tracker(parse_marker(clip.marker_spec), clip.camera, clip.marker_side_m, FAST.tracking)

        def scene(tracked: TrackedFrame) -> Scene:
            return Scene(tracked, model, Illumination((light,)))

        with ClipSource(clip.path) as source:
            times = time_unpaced(source, tracker, renderer, scene, self.frames)
            copied = time_blit(source, tracker, renderer, clip.camera, self.frames)
            renderer.release()
            # One row more than the picture: it is drawn and not copied.
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
        growth = memory_growth(ctx, FAST.render, models, lambda number: views[number % len(views)], self.memory_frames)
        return {"frames": self.memory_frames, **growth}


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


def _errors(ctx: Context, frames: int) -> list[Json]:
    """By preset, and by what the presets differ in; nothing in an installed package, which has no references."""
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
                "scenes": {reference.name: asdict(error) for reference, error in zip(references, errors, strict=True)},
                "shadow_iou_mean": float(np.mean([error.shadow_iou for error in errors])),
                "shadow_iou_least": min(error.shadow_iou for error in errors),
                "shadow_de": float(np.mean([error.shadow_de for error in errors])),
                "model_de": float(np.mean([error.model_de for error in errors])),
            }
        )
    return rows


def _settings() -> list[tuple[str, str, RenderPreset]]:
    base = BALANCED.render
    maps = [(str(size), replace(base, shadow_map_size=size, ground_shadow_size=size // 2)) for size in (128, 256, 512)]
    samples = [(str(count), replace(base, msaa_samples=count)) for count in (0, 2, 8)]
    taps = [(f"{count}", replace(base, blocker_taps=count, soft_taps=2 * count)) for count in (2, 4, 32)]
    return [
        *((name, "presets", quality.render) for name, quality in QUALITIES.items()),
        *((name, "depth map", preset) for name, preset in maps),
        *((name, "samples a pixel", preset) for name, preset in samples),
        *((name, "penumbra taps", preset) for name, preset in taps),
    ]


def print_render_record(record: Json) -> None:
    console = Console(highlight=False)
    console.print(f"{record['machine']['cpus']} CPU cores, {record['machine']['gl_renderer']}")
    loop = figures_table(
        "fast, one sun, ms a frame", "", "decode", "track", "render", "whole", "video drawn", "render / video"
    )
    for row in record["loop"]:
        values = (row["decode"], row["track"], row["render"], row["whole"], row["video_drawn"])
        loop.add_row(_size(row["size"]), *(f"{ms:.2f}" for ms in values), f"{row['render'] / row['video_drawn']:.1f}")
    large = record["large"]
    costs = figures_table("balanced, ms a picture", "", "median", "p99", "GPU median", "GPU p99")
    costs.add_row(f"{_size(large['size'])}, {large['triangles']} triangles", *_costs(large))
    for name, rows in record["sweeps"].items():
        for row in rows:
            costs.add_row(f"{name} {row['value']:,}", *_costs(row))
    errors = figures_table("against a path tracer", "", "ms", "shadow IoU", "least", "dE in shadow", "dE on model")
    for row in record["errors"]:
        numbers = (row["shadow_iou_mean"], row["shadow_iou_least"])
        colours = (row["shadow_de"], row["model_de"])
        cells = (f"{row['ms']:.1f}", *(f"{n:.3f}" for n in numbers), *(f"{n:.1f}" for n in colours))
        errors.add_row(f"{row['series']}: {row['name']}", *cells)
    for table in (loop, costs, errors):
        console.print(table)
    memory = record["memory"]
    console.print(
        f"{memory['frames']} pictures, a model switch every ten: "
        f"{memory['start_mib']:.1f} to {memory['end_mib']:.1f} MiB, "
        f"{memory['start_gl_objects']:.0f} to {memory['end_gl_objects']:.0f} OpenGL objects"
    )


def _draw(record: Json, out: Path, overwrite: bool) -> None:
    note = f"{date.today()}, {record['machine']['gl_renderer']}, {record['machine']['cpus']} cores"
    points = [
        TradePoint(
            row["name"],
            row["series"],
            row["ms"],
            {
                "1 - shadow IoU": 1 - row["shadow_iou_mean"],
                "dE in the shadow": row["shadow_de"],
                "dE on the model": row["model_de"],
            },
            row["series"] == "presets",
        )
        for row in record["errors"]
    ]
    if points:
        draw_trade(points, "Error against a path tracer", "ms a picture, 480x360", note, out / ERRORS, overwrite)
    _draw_sweeps(record, note, out / COSTS, overwrite)


def _draw_sweeps(record: Json, note: str, path: Path, overwrite: bool) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 3.2), layout="constrained")
    for ax, (name, rows) in zip(figure.subplots(1, len(record["sweeps"])), record["sweeps"].items(), strict=True):
        ax.plot([row["value"] for row in rows], [row["p50"] for row in rows], "o-", color="#0072b2")
        ax.set(
            xlabel=name,
            ylabel="ms a picture",
            ylim=(0, None),
            xscale="log" if name in ("triangles", "depth map") else "linear",
        )
        ax.grid(alpha=0.3)
    figure.supxlabel(note, fontsize="x-small", color="dimgray")
    with written_whole(path, overwrite, beside=True) as file:
        figure.savefig(file.stream, format="png", dpi=120, metadata={"Software": None})


def _costs(row: Json) -> list[str]:
    return ["-" if row[key] is None else f"{row[key]:.2f}" for key in ("p50", "p99", "gpu_p50", "gpu_p99")]


def _size(size: list[int]) -> str:
    return f"{size[0]}x{size[1]}"
