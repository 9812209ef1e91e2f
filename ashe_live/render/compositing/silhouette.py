"""Where the real object is in the picture, by which the composite knows across which outline the video has a border."""

import math
from typing import NamedTuple

import moderngl
import numpy as np

from ashe_live.core.arrays import Float
from ashe_live.core.camera import Size
from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.driver import clear_part
from ashe_live.render.gl.framing import Framing, Rectangle, common, grown
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.passes.real_object import RealObject

OUTLINE_ERROR_PX = 1.5  # pixels of the video, standard deviation of a drawn outline's distance from the object's
MEANS_VARIANCE_PX2 = 0.7  # pixels of the video; means on either side reach farther than the blur of a sharp video does
MOST_REACH = 6  # pixels of the framebuffer
# Pixels of the video from the outline, where what is on either side is looked at: beyond twice the blur, and along the
# outline, where each look is interpolated and they leave no pixel out. The first two are near it.
LOOKS_PX = (
    *((1.5, along) for along in (-0.75, 0.75)),
    *((4.0, along) for along in (-4.0, -2.4, -0.8, 0.8, 2.4, 4.0)),
)


class OutlineReach(NamedTuple):
    """How far about a pixel the composite looks for the real object's outline, in pixels of the framebuffer."""

    variance: float  # of the composite's blur, px²
    scale: float  # pixels of the framebuffer in one of the video

    @property
    def reach(self) -> int:
        return min(MOST_REACH, math.ceil(math.sqrt(self.variance) + 2.5 * self.scale))

    @property
    def looks_px(self) -> Float:
        """(n, 2) from the outline to where the video is looked at, across the outline and along it."""
        return np.asarray(self.scale * np.array(LOOKS_PX) + (2 * math.sqrt(self.variance), 0.0))

    @property
    def margin(self) -> int:
        """Of what is read beside the pixels near which the outline may be."""
        return self.reach + math.ceil(float(self.looks_px.max())) + 1

    @property
    def uniforms(self) -> dict[str, object]:
        at = np.arange(self.reach + 1.0)
        bound = self.variance + (self.scale * OUTLINE_ERROR_PX) ** 2
        return {
            "outline_means": _gaussian(at, max(self.variance, self.scale**2 * MEANS_VARIANCE_PX2)),
            "outline_bounds": _gaussian(at, bound),
            "outline_sigma_px": math.sqrt(bound),
            "looks_px": self.looks_px,
            "border_step_px": self.scale,
        }


class SeenOutline(NamedTuple):
    """The real object's outline in one picture."""

    mask: moderngl.Texture
    around: Rectangle  # the pixels with the outline within `reach`
    reach: OutlineReach

    def bind(self, choosing: moderngl.Program, composing: moderngl.Program) -> None:
        """For the program that chooses pixels, and the one that composes them."""
        self.mask.use(UNIT_OF["silhouette"])
        left, bottom, width, height = self.around
        around = tuple(map(float, (left, bottom, left + width, bottom + height)))
        set_uniforms(choosing, around_object=around, reach_px=float(self.reach.reach))
        set_uniforms(composing, **self.reach.uniforms)


class Silhouette:
    """Draws a mask of the real object in the picture, which programs read as `silhouette`."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._rectangle = WholeRectangle(ctx)
        self._mask, self._with_mean = Canvas(ctx, 1), Canvas(ctx, 2)

    def draw(
        self, real: RealObject, framing: Framing, within: Rectangle, reach: OutlineReach, size: Size
    ) -> SeenOutline | None:
        """Draws the object in `framing`, in which only `within` matters; None where it is elsewhere.

        Leaves another framebuffer bound.
        """
        around = common(grown(framing.region, reach.reach, size), within)
        if min(around[2:]) <= 0:
            return None
        drawn, finished = self._mask.of_size(size), self._with_mean.of_size(size)
        cleared = grown(around, reach.margin + 1, size)
        clear_part(drawn, cleared)
        # moderngl tells OpenGL of a scissor only when the framebuffer is bound after it was set.
        drawn.scissor = cleared
        drawn.use()
        self._ctx.viewport = framing.viewport
        real.draw_silhouette(framing)
        self._mask.bind("silhouette")
        finished.scissor = grown(around, reach.margin, size)
        self._rectangle.fill(finished, self._programs.get("compositing/silhouette"))
        return SeenOutline(self._with_mean.textures[0], around, reach)

    def release(self) -> None:
        for held in (self._mask, self._with_mean, self._rectangle):
            held.release()


def _gaussian(at: Float, variance: float) -> Float:
    return np.asarray(np.exp(-(at**2) / (2 * variance)))
