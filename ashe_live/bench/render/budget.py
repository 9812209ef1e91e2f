"""How much each cause contributes to the difference from a pair's photos: causes are taken away one after the other.

Light, pose and the sun's size are the true ones in all rows. "True light and shading" replaces what the renderer draws
by the path tracer's own radiance on the model, and its own ratio of light elsewhere: the rest is the camera's.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import cv2
import numpy as np
from rich.progress import track

from ashe_live.bench.bench import Bench
from ashe_live.bench.render.error import mean_where, read_picture, smooth_difference
from ashe_live.bench.render.flip import flip_error
from ashe_live.bench.render.pairs import (
    Pair,
    Regions,
    dilated,
    drawn,
    eroded,
    ground_rgb,
    pictured,
    read_pairs,
    regions,
)
from ashe_live.bench.tables import figures_table
from ashe_live.core.arrays import Float, Image, Mask
from ashe_live.core.camera import Size
from ashe_live.core.contract import Json
from ashe_live.core.light import Illumination
from ashe_live.core.types import Frame, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.quality import FAST
from ashe_live.render.camera.video_look import VideoLook
from ashe_live.render.compositing.composite import Composite, Footage
from ashe_live.render.gl.offscreen import Context, offscreen_context
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.gl.programs import Programs
from ashe_live.render.lights.photometry import Photometry
from ashe_live.render.passes.surface import Surface
from ashe_live.render.passes.video import Video
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene

# The further photos that assets/sources/scenes/photo/renditions.py makes of a pair.
OTHER_PHOTOS = {"noise": "with other noise", "moved_25": "moved by 0.25 px", "moved_50": "moved by 0.5 px"}
COLUMNS = ("FLIP", "on model", "on border", "on paper", "dE ground", "dE paper", "dE model")
MOST_LIGHT = 4.0  # largest ratio of light with the model to without: more is noise of the path tracer in the dark
LEAST_RADIANCE = 1e-4  # of full scale; darker pixels have no ratio


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What the path tracer knows about a pair."""

    bare: Float  # (h, w, 3) linear RGB, exposed, before the lens
    model: Float  # the same with the model
    white_rgb: Float  # (3,) value of white of radiance 1 after exposure
    sky: Float  # (3,) share of the sky in the light on level ground


@dataclass(frozen=True, slots=True)
class BudgetBench(Bench):
    """The budget of the pairs in a folder, in the preset `fast`."""

    NEEDS_OPENGL: ClassVar[bool] = True

    pairs: Path

    def parts(self) -> Iterator[Json]:
        ctx = offscreen_context()
        rows = [
            {"scene": pair.name, "cause": cause, **figures}
            for pair in track(read_pairs(self.pairs), "what keeps pairs from their photos", transient=True)
            for cause, figures in budget(ctx, pair, FAST.render)
        ]
        table = figures_table("what keeps fast from photos of the same with the model: means", "", *COLUMNS)
        for cause in dict.fromkeys(row["cause"] for row in rows):
            own = [row for row in rows if row["cause"] == cause]
            table.add_row(cause, *(_mean_cell(name, [row[name] for row in own]) for name in COLUMNS))
        self.console.print(table)
        yield {"budget": rows}


def _mean_cell(name: str, values: list[float]) -> str:
    """The mean over the scenes that have a value."""
    known = [value for value in values if not np.isnan(value)]
    return f"{np.mean(known):.{1 if name.startswith('dE') else 3}f}" if known else "-"


def budget(ctx: Context, pair: Pair, preset: RenderPreset) -> Iterator[tuple[str, Json]]:
    """The figures of one pair, cause by cause. Raises UserError where it was developed without its truth."""
    truth = read_truth(pair)
    white = truth.white_rgb
    untoned, linear = (rendition(pair, name) for name in ("untoned", "linear"))
    ours = drawn(ctx, pair.scene, preset)

    def lit(of: Pair, slope: Float | None = None) -> Json:
        return figures_of(of, drawn_at(ctx, under(of.scene, truth.sky, slope), preset, white))

    def traced(of: Pair) -> Json:
        return figures_of(of, composed(ctx, of.scene, preset, truth, pair.is_model))

    yield "as photographed", figures_of(pair, ours)
    yield "true white", figures_of(pair, drawn_at(ctx, pair.scene, preset, white))
    yield "true white and sky", lit(pair)
    if pair.sky_slope is not None:
        yield "true white, sky and its lean", lit(pair, pair.sky_slope)
    yield "true light and shading", traced(pair)
    yield "without tone curve and colour: the same", traced(untoned)
    yield "linear camera: true white and sky", lit(linear)
    if pair.sky_slope is not None:
        yield "linear camera: true white, sky and its lean", lit(linear, pair.sky_slope)
    yield "linear camera: true light and shading", traced(linear)
    for name, what in OTHER_PHOTOS.items():
        yield f"the photo {what}", figures_of(pair, read_picture(pair.file(f"model_{name}.jpg")), regions(pair, ours))


def figures_of(pair: Pair, picture: Image, where: Regions | None = None) -> Json:
    """Means of FLIP, and of dE, over regions of a picture (h, w, 3) of the pair; NaN where it has none of a kind.

    `where`: the regions of another picture, for comparison with that one.
    """
    where = regions(pair, picture) if where is None else where
    flip, difference = flip_error(picture, pair.expected), smooth_difference(picture, pair.expected)
    border = dilated(where.shadow) & ~eroded(where.shadow) & where.beside & where.changed
    on_paper = eroded(where.shadow) & pair.is_sheet & where.changed
    values = (
        *(mean_where(flip, each) for each in (where.changed, where.model & where.changed, border, on_paper)),
        mean_where(difference, where.shadow & ~pair.is_sheet),
        mean_where(difference, where.shadow & pair.is_sheet),
        mean_where(difference, where.model),
    )
    return dict(zip(COLUMNS, values, strict=True))


def read_truth(pair: Pair) -> Truth:
    paths = [pair.file(f"{version}_light.tiff") for version in ("bare", "model")]
    bare, model = (cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.exists() else None for path in paths)
    if bare is None or model is None or pair.white_rgb is None or pair.sky is None:
        raise UserError(f"{pair.name} was developed without its truth", "develop the pairs again with scenes.pairs")
    rgb = [np.asarray(each[..., ::-1], np.float64) for each in (bare, model)]
    return Truth(rgb[0], rgb[1], pair.white_rgb, pair.sky)


def rendition(pair: Pair, name: str) -> Pair:
    """The pair as photographed by another camera."""
    bare, expected = (read_picture(pair.file(f"{version}_{name}.jpg")) for version in ("bare", "model"))
    tracked = replace(pair.tracked, frame=Frame(bare, 0, 0.0))
    illumination = replace(pair.scene.illumination, ground_rgb=ground_rgb(bare), seen_in=tracked)
    return replace(pair, scene=replace(pair.scene, tracked=tracked, illumination=illumination), expected=expected)


def under(scene: Scene, sky: Float, slope: Float | None = None) -> Scene:
    """The scene lit by its sun and a sky that gives the share `sky` (3,) of the light on level ground.

    `slope`: (2, 3) by which that sky leans; None for an even one.
    """
    (light,) = scene.illumination.lights
    known = replace(light, shadow_rgb_ratio=None, intensity_rgb_ratio=1 / np.maximum(sky, 1e-3) - 1)
    return replace(scene, illumination=replace(scene.illumination, lights=(known,), sky_slope_rgb=slope))


class InTrueWhite(Photometry):
    """Photometry of a camera whose exposure and white balance are known."""

    def __init__(self, preset: RenderPreset, white_rgb: Float) -> None:
        super().__init__(preset)
        self._white_rgb = white_rgb

    def look(self, tracked: TrackedFrame, of: Illumination) -> VideoLook:
        red, green, blue = self._white_rgb.tolist()
        return replace(super().look(tracked, of), white_rgb=(red, green, blue))


class RendererInTrueWhite(SceneRenderer):
    def __init__(self, ctx: Context, preset: RenderPreset, size: Size, white_rgb: Float) -> None:
        super().__init__(ctx, preset, size)
        self._models_on_video.photometry = InTrueWhite(preset, white_rgb)


def drawn_at(ctx: Context, scene: Scene, preset: RenderPreset, white_rgb: Float) -> Image:
    """The picture (h, w, 3) BGR of a scene at the exposure `white_rgb` (3,)."""
    assert scene.tracked is not None
    return pictured(RendererInTrueWhite(ctx, preset, scene.tracked.frame.size, white_rgb), scene)


def composed(ctx: Context, scene: Scene, preset: RenderPreset, truth: Truth, is_model: Mask) -> Image:
    """The composite (h, w, 3) BGR of layers that are the path tracer's, not the renderer's."""
    tracked = scene.tracked
    assert tracked is not None
    size = tracked.frame.size
    whole = (0, 0, *size)
    ratio = truth.model / np.maximum(truth.bare, LEAST_RADIANCE)
    covered = is_model[..., None].astype(np.float32)
    added = np.concatenate([truth.model * covered, covered], axis=2)
    gone = np.where(covered > 0, 1, 1 - np.minimum(ratio, MOST_LIGHT))
    removed = np.concatenate([gone, covered], axis=2)
    surface, video, programs = Surface(ctx, size, 0), Video(ctx), Programs(ctx)
    composite = Composite(ctx, programs)
    video.show(tracked, whole)
    video.copy_or_draw(surface.colour, whole)
    for layer, values in zip(surface.layers, (added, removed), strict=True):
        layer.write(np.ascontiguousarray(values[::-1], np.float16).tobytes())
    look = InTrueWhite(preset, truth.white_rgb).look(tracked, scene.illumination)
    composite.draw(surface, whole, Footage(whole, video, tracked, look))
    picture = surface.read_bgr()
    # moderngl binds again what was bound before, which must not have been released by then.
    ctx.detect_framebuffer(0).use()
    for held in (composite, video, surface, programs):
        held.release()
    return picture
