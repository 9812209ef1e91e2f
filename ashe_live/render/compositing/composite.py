"""Puts the layers of what was drawn onto the video as the video's own camera would have formed them.

A camera blurs the whole scene and adds its noise to the result. The video has both already, so the scene with a model
in it is the video times the blurred fraction of light that is left of it, plus the blurred light of the model: border
of model and border of shadow are as soft as everything else in the picture.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.types import TrackedFrame
from ashe_live.render.camera.edges import BOX_VARIANCE_PX2, SHARPENING_SIGMA_PX
from ashe_live.render.camera.relief import Relief
from ashe_live.render.camera.video_look import VideoLook
from ashe_live.render.camera.white import OVEREXPOSED
from ashe_live.render.compositing.coarse import KERNEL_SIGMAS, CoarseBlur, CoarseLayers
from ashe_live.render.compositing.ground_means import GroundMeans
from ashe_live.render.compositing.lens import Lens
from ashe_live.render.compositing.silhouette import OutlineReach, SeenOutline
from ashe_live.render.cover.marker_cover import SeenCover
from ashe_live.render.gl.framing import Rectangle, common, grown
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.passes.surface import Surface
from ashe_live.render.passes.video import Video

MAX_REACH = 4  # pixels; a wider blur is cut off there
SMALLEST = 2  # rows and columns together from the middle of a kernel to its farthest pixels, at least


class Blurs(NamedTuple):
    """Variances (px²) and reaches (px) of the composite's blurs, in pixels of the framebuffer."""

    variance: float
    widest: float  # of the blur that unsharp masking subtracts; as `variance` where nothing is sharpened
    reach: int  # of both
    coarse: CoarseBlur  # of the colours

    @property
    def farthest(self) -> int:
        return max(self.reach, self.coarse.reach_px)


@dataclass(frozen=True, slots=True, eq=False)
class Footage:
    """A frame of the video as it is shown, with what is known about it: what the layers are put onto."""

    viewport: Rectangle  # of the framebuffer, where it is
    video: Video
    tracked: TrackedFrame
    look: VideoLook
    relief: Relief | None = None  # of the ground in the real shadow, where it is flatter than in the light
    cover: SeenCover | None = None  # of the marker's sheet, behind the layers where they say that it is seen
    lens: Lens | None = None  # what bends the pinhole camera's layers to the frame
    is_split: bool = False  # the left half of the viewport stays as it is
    shadows_meet: bool = False  # whether a model's shadow may reach one that is in the video
    outline: SeenOutline | None = None  # of the real object, where the layers may have something beside it

    @property
    def blurs(self) -> Blurs:
        return _blurs_of(self._scale, self.look)

    @property
    def outline_reach(self) -> OutlineReach:
        return OutlineReach(self.blurs.variance, self._scale)

    @property
    def _scale(self) -> float:
        return self.viewport[2] / self.tracked.frame.size[0]

    @property
    def uniforms(self) -> dict[str, Any]:
        size, blurs = self.tracked.frame.size, self.blurs
        return {
            "weights": _weights(blurs.variance, blurs.reach),
            "wide_weights": _weights(blurs.widest, blurs.reach),
            "sharpening": self.look.sharpening,
            "paper": self.look.paper_rgb,
            "noise_sigmas": np.array(self.look.noise_sigmas),
            "grain_px": (self.viewport[2] / size[0], self.viewport[3] / size[1]),
        }


class Composite:
    """The last pass of a picture with a model."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._coarse = CoarseLayers(ctx, programs)
        self._means = GroundMeans(ctx, programs)
        self._rectangle = WholeRectangle(ctx)

    def draw(self, surface: Surface, region: Rectangle, onto: Footage, is_cut_out: bool = False) -> None:
        """Onto the video in `surface.colour`, within `region` and its blur's reach.

        The layers beside `region` must be empty for twice that reach. `is_cut_out`: onto nothing, in place of the
        video; straight alpha.
        """
        viewport, frame, bends = onto.viewport, onto.tracked.frame, onto.lens is not None
        blurs = onto.blurs
        choosing, program = self._programs.get("compositing/touched", bends=bends), self._composing(onto, is_cut_out)
        within = grown(region, blurs.farthest, surface.size)
        self._coarse.draw(surface, within, viewport, blurs.coarse, blurs.reach // 2)
        self._coarse.bind()
        surface.bind_layers()
        onto.video.bind()
        where = {"viewport": tuple(map(float, viewport))}
        if onto.lens is not None:
            onto.lens.bind(onto.tracked.camera)
            where["region"] = tuple(map(float, within))
            within = viewport
        within = common(within, viewport)  # black bars beside the video stay black
        set_uniforms(choosing, **where)
        relief = {}
        if onto.relief is not None:
            means = self._means.draw(within, viewport, onto.cover, bends)
            contrast, most, sky = onto.relief
            relief = {"means": means, "contrast_left": contrast, "most_relief": most, "sky_share": sky}
        if onto.is_split:
            within = _right_of(viewport[0] + viewport[2] // 2, within)
        passes = [(choosing, program, within)]
        if onto.outline is not None:
            around = within if bends else common(within, onto.outline.around)
            at_object = self._composing(onto, is_cut_out, at_object=True)
            choosing = self._programs.get("compositing/at_outline", bends=bends)
            onto.outline.bind(choosing, at_object)
            set_uniforms(choosing, **where)
            passes.append((choosing, at_object, around))
        for choosing, program, within in passes:
            set_uniforms(program, **where, **onto.uniforms, **relief, seed=frame.index)
            if onto.cover is not None:
                onto.cover.bind(program)
            with surface.chosen.choosing(surface.choice, within):
                self._rectangle.draw(choosing)
            with surface.chosen.restricted(surface.chosen_colour, within):
                self._rectangle.draw(program)
        surface.colour.use()

    def _composing(self, onto: Footage, is_cut_out: bool, at_object: bool = False) -> moderngl.Program:
        """The program that composes pixels. `at_object`: those at the real object's outline."""
        blurs = onto.blurs
        clips_from, clips_to = OVEREXPOSED
        return self._programs.get(
            "compositing/composite",
            reach=blurs.reach,
            bends=onto.lens is not None,
            wide=blurs.widest > blurs.variance,
            coarse=onto.look.chroma_blur_px > 0,
            overexposed=onto.look.is_overexposed,
            clips_from=clips_from,
            clips_to=clips_to,
            covers=onto.cover is not None,
            relief=onto.relief is not None,
            shadows_meet=onto.shadows_meet,
            cut_out=is_cut_out,
            at_object=at_object,
            outline_reach=onto.outline_reach.reach if at_object else 0,
        )

    def release(self) -> None:
        for held in (self._coarse, self._means, self._rectangle):
            held.release()


def _right_of(column: int, rectangle: Rectangle) -> Rectangle:
    left, bottom, width, height = rectangle
    first = max(left, column)
    return first, bottom, max(0, left + width - first), height


def _blurs_of(scale: float, look: VideoLook) -> Blurs:
    """`scale` pixels of the framebuffer are one of the video, which is a box of as many.

    Shadows are drawn with one sample a pixel, however many the model's edges have, so that all of that box is left to
    do.
    """
    variance = 0.0 if look.blur_sigma_px is None else scale**2 * (look.blur_sigma_px**2 + BOX_VARIANCE_PX2)
    widest = variance + (scale**2 * SHARPENING_SIGMA_PX**2 if look.sharpening > 0 else 0.0)
    coarse = CoarseBlur.of(variance + scale**2 * look.chroma_blur_px**2)
    return Blurs(variance, widest, _reach(widest), coarse)


def _reach(variance: float) -> int:
    return min(MAX_REACH, math.ceil(KERNEL_SIGMAS * math.sqrt(variance) - 1)) if variance > 0 else 0


@lru_cache(maxsize=8)  # a frame's two are the next frame's as a rule: a search of 0.4 ms each
def _weights(variance: float, reach: int) -> Float:
    """(reach + 1,) factors by row and column; over the diamond of pixels that is used, their products sum to 1.

    The Gaussian's variance is raised until that of the kernel, which is cut off and sampled, is the wanted one.
    """
    if variance <= 0 or reach == 0:
        return np.where(np.arange(reach + 1) == 0, 1.0, 0.0)
    at = np.arange(-reach, reach + 1)
    used = np.abs(at)[:, None] + np.abs(at) <= max(reach, SMALLEST)
    low, high = variance / 40, 40.0 * variance
    for _ in range(40):
        raised = math.sqrt(low * high)
        line = np.exp(-(at**2) / (2 * raised))
        line /= math.sqrt(float((line[:, None] * line)[used].sum()))
        kernel = np.where(used, line[:, None] * line, 0.0)
        low, high = (raised, high) if (kernel * at**2).sum() < variance else (low, raised)
    return line[reach:]
