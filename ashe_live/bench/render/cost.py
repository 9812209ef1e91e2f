"""The cost of a picture: wall time, GPU time, and memory that is not released."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ashe_live.bench.resources_held import resident_mib
from ashe_live.core.camera import Camera, Size
from ashe_live.core.light import Illumination, Light
from ashe_live.core.proxy import grid_triangles
from ashe_live.core.transforms import direction_from_angles, rigid
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.models.mesh import Mesh, Model
from ashe_live.models.placement import PlacedModel, placed_on_marker
from ashe_live.render.gl.offscreen import Context, live_gl_objects
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

WARM_UP_FRAMES = 3
SIDE_M = 0.08


@dataclass(frozen=True, slots=True)
class Cost:
    """Milliseconds per picture."""

    p50: float  # wall time until it is drawn
    p99: float
    gpu_p50: float | None  # by OpenGL's timer queries; None where it has none
    gpu_p99: float | None


def cost_of(ctx: Context, preset: RenderPreset, size: Size, scenes: Sequence[Scene], frames: int) -> Cost:
    """The cost of `frames` pictures of `size`, cycling through the scenes."""
    renderer = SceneRenderer(ctx, preset, size)
    query = ctx.query(time=True)
    wall_ms, gpu_ms = [], []
    for number in range(WARM_UP_FRAMES + frames):
        begun_s = time.perf_counter()
        with query:
            renderer.render(scenes[number % len(scenes)])
        renderer.finish()
        wall_ms.append((time.perf_counter() - begun_s) * 1e3)
        gpu_ms.append(query.elapsed * 1e-6)
    renderer.release()
    p50, p99 = np.percentile(wall_ms[WARM_UP_FRAMES:], (50, 99))
    gpu_p50, gpu_p99 = np.percentile(gpu_ms[WARM_UP_FRAMES:], (50, 99))
    has_timer = gpu_p50 > 0
    return Cost(float(p50), float(p99), float(gpu_p50) if has_timer else None, float(gpu_p99) if has_timer else None)


def costs_by_turns(
    ctx: Context, preset: RenderPreset, size: Size, several: Sequence[Sequence[Scene]], frames: int
) -> list[tuple[float, float]]:
    """Median milliseconds a picture for each of several lists of scenes: wall time and processor time.

    The lists take turns, so that other programs disturb all of them alike. Processor time, which is that of all threads
    of the process, a software rasteriser's included, does not contain what other programs take.
    """
    renderers = [SceneRenderer(ctx, preset, size) for _ in several]
    spent_ms: list[list[tuple[float, float]]] = [[] for _ in several]
    for number in range(WARM_UP_FRAMES + frames):
        for renderer, scenes, spent in zip(renderers, several, spent_ms, strict=True):
            begun_s, busy_s = time.perf_counter(), time.process_time()
            renderer.render(scenes[number % len(scenes)])
            renderer.finish()
            spent.append((1e3 * (time.perf_counter() - begun_s), 1e3 * (time.process_time() - busy_s)))
    for renderer in renderers:
        renderer.release()
    medians = [np.median(spent[WARM_UP_FRAMES:], axis=0) for spent in spent_ms]
    return [(float(wall), float(busy)) for wall, busy in medians]


def orbit(size: Size, model: PlacedModel | None, lights: tuple[Light, ...], views: int = 8) -> list[Scene]:
    """Scenes with a camera that orbits the marker on grey ground, each with a frame of its own, 60 of them a second.

    As in the viewer the light was estimated in one of them, and the video's look is measured a few times a second.
    """
    camera = Camera.from_hfov(size, 55.0)
    picture = np.full((size[1], size[0], 3), 150, dtype=np.uint8)
    corners = np.zeros((4, 2))
    frames = []
    for number in range(views):
        outwards = direction_from_angles(2 * math.pi * number / views, math.radians(40))
        right = np.cross(-outwards, (0, 0, 1)) / math.cos(math.radians(40))
        R = np.array([right, np.cross(-outwards, right), -outwards])
        pose = MarkerPose(rigid(R, -R @ (np.array((0, 0, 0.03)) + 0.4 * outwards)), corners, SIDE_M, 0.0, None)
        frames.append(TrackedFrame(Frame(picture.copy(), number, number / 60), camera, pose))
    illumination = Illumination(lights, seen_in=frames[0])
    return [Scene(tracked, model, illumination) for tracked in frames]


def lights_around(count: int) -> tuple[Light, ...]:
    share = 0.6 / max(count, 1)
    return tuple(
        Light(direction_from_angles(0.3 + 1.3 * number, 0.8), shadow_rgb_ratio=np.full(3, 1 - share))
        for number in range(count)
    )


def lamps_around(count: int) -> tuple[Light, ...]:
    """The same lights, but half a metre away."""
    return tuple(replace(light, inverse_distance=2.0, radius_m=0.01) for light in lights_around(count))


def round_model(triangles: int) -> PlacedModel:
    """A vase of about `triangles` triangles."""
    around = max(3, round(math.sqrt(triangles / 2)))
    rings = max(2, round(triangles / 2 / around) + 1)
    height, angle = np.meshgrid(np.linspace(0, 1, rings), np.arange(around) * (2 * math.pi / around), indexing="ij")
    radius = 0.3 + 0.12 * np.sin(7 * height)
    outwards = np.stack([np.cos(angle), np.sin(angle), -0.84 * np.cos(7 * height)], axis=-1)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    normals = outwards / np.linalg.norm(outwards, axis=-1, keepdims=True)
    vertices = points.reshape(-1, 3).astype(np.float32)
    mesh = Mesh(vertices, normals.reshape(-1, 3).astype(np.float32), grid_triangles(around, rings))
    return placed_on_marker(Model("vase", (mesh,)), SIDE_M)


def sweeps(base: RenderPreset) -> dict[str, list[tuple[float, RenderPreset, int, int]]]:
    """Sweeps by the quantity varied: its value, the preset, the numbers of lights and of triangles."""
    return {
        "triangles": [(count, base, 1, count) for count in (1_000, 10_000, 100_000, 1_000_000)],
        "lights": [(count, base, count, 10_000) for count in range(5)],
        "depth map": [(size, replace(base, shadow_map_size=size), 1, 10_000) for size in (512, 1024, 2048, 4096)],
        "samples": [(count, base.with_samples(count), 1, 10_000) for count in (0, 2, 4, 8)],
    }


def memory_growth(
    ctx: Context,
    preset: RenderPreset,
    models: Sequence[PlacedModel],
    scene: Callable[[int], Scene],
    frames: int,
) -> dict[str, float]:
    """Resident memory (MiB) and live OpenGL objects after a fifth of the frames and at the end.

    The model changes every tenth picture.
    """
    assert frames >= 10
    first = scene(0)
    assert first.tracked is not None
    renderer = SceneRenderer(ctx, preset, first.tracked.frame.size)
    found: dict[str, float] = {}
    for number in range(frames):
        renderer.render(replace(scene(number), model=models[number // 10 % len(models)]))
        renderer.finish()
        if number in (frames // 5, frames - 1):
            when = "end" if number == frames - 1 else "start"
            found[f"{when}_gl_objects"] = live_gl_objects()
            found[f"{when}_mib"] = resident_mib()
    renderer.release()
    return found
