"""Smooths the model's outlines in layers that were drawn with one sample a pixel.

Several samples a pixel cost nearly four times as much on a software rasteriser (docs/performance.md).
"""

from typing import NamedTuple

import moderngl

from ashe_live.render.gl.framing import Rectangle, corner_pixels, grown
from ashe_live.render.gl.programs import Programs, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.passes.surface import Surface


class OutlineSmoothing:
    """Smooths outlines in a surface's layers."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._rectangle = WholeRectangle(ctx)
        self._surface: Surface | None = None  # the one that the rest is for
        self._found: _Found | None = None

    def smooth(self, surface: Surface, region: Rectangle, viewport: Rectangle) -> None:
        """Within `region`, which holds the model and a pixel around it; `viewport`: of the video.

        Leaves another framebuffer bound.
        """
        found = self._found_of(surface)
        surface.bind_layers()
        find, smooth = self._programs.get("compositing/outlines", find=1), self._programs.get("compositing/outlines")
        for program in (find, smooth):
            set_uniforms(program, **corner_pixels(viewport))
        with surface.chosen.choosing(found.step_framebuffer, grown(region, 2, surface.size)):
            self._rectangle.draw(find)
        found.steps.use(UNIT_OF["outline_steps"])
        with surface.chosen.restricted(found.framebuffer, region):
            self._rectangle.draw(smooth)
        for texture, name in zip(found.layers, ("added_light", "removed"), strict=True):
            texture.use(UNIT_OF[name])
        with surface.chosen.restricted(surface.chosen_layers, region):
            self._rectangle.draw(self._programs.get("compositing/outlines", put_back=1))

    def release(self) -> None:
        self._rectangle.release()
        self._release_found()

    def _found_of(self, surface: Surface) -> "_Found":
        if self._found is None or self._surface is not surface:
            self._release_found()
            steps = self._ctx.texture(surface.size, 4)
            layers = [self._ctx.texture(surface.size, 4, dtype="f2") for _ in range(2)]
            self._found = _Found(steps, surface.chosen.framebuffer([steps]), layers, surface.chosen.framebuffer(layers))
            self._surface = surface
        return self._found

    def _release_found(self) -> None:
        if self._found is not None:
            for framebuffer in (self._found.framebuffer, self._found.step_framebuffer):
                framebuffer.release()
            for texture in (self._found.steps, *self._found.layers):
                texture.release()
        self._found = self._surface = None


class _Found(NamedTuple):
    steps: moderngl.Texture
    step_framebuffer: moderngl.Framebuffer
    layers: list[moderngl.Texture]  # as they will be where there are steps
    framebuffer: moderngl.Framebuffer
