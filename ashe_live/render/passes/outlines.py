"""Smooths the model's outlines in layers that were drawn with one sample a pixel.

Several samples a pixel double the price of a picture on a software rasteriser; this adds a quarter.
"""

import moderngl

from ashe_live.core.camera import Size
from ashe_live.render.gl.framing import Rectangle
from ashe_live.render.gl.programs import Programs
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.passes.surface import Surface

UNTOUCHED = (0.0, 0.0, 0.0, -1.0)  # by which the shader knows the pixels that it has left alone


class Outlines:
    """Of what is drawn into a surface's layers."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._ctx = ctx
        self._programs = programs
        self._rectangles = WholeRectangle(ctx), WholeRectangle(ctx)
        self._found: list[moderngl.Texture] = []
        self._framebuffer: moderngl.Framebuffer | None = None

    def smooth(self, surface: Surface, region: Rectangle) -> None:
        """Within `region`, which holds the model. Leaves another framebuffer bound."""
        framebuffer = self._framebuffer_of(surface.size)
        self._ctx.enable_only(moderngl.NOTHING)
        framebuffer.clear(*UNTOUCHED, viewport=region)
        finding, putting_back = self._rectangles
        surface.bind_layers()
        self._draw(framebuffer, region, finding, self._programs.get("outlines"))
        for texture, name in zip(self._found, ("added_light", "removed"), strict=True):
            texture.use(UNIT_OF[name])
        self._draw(surface.layered, region, putting_back, self._programs.get("outlines", put_back=1))

    def release(self) -> None:
        for rectangle in self._rectangles:
            rectangle.release()
        self._release_found()

    def _draw(
        self,
        target: moderngl.Framebuffer,
        region: Rectangle,
        rectangle: WholeRectangle,
        program: moderngl.Program,
    ) -> None:
        target.scissor = region
        target.use()
        self._ctx.viewport = (0, 0, *target.size)
        rectangle.draw(program)
        target.scissor = None  # type: ignore[assignment]  # moderngl's stub knows no "none"

    def _framebuffer_of(self, size: Size) -> moderngl.Framebuffer:
        if self._framebuffer is None or self._framebuffer.size != size:
            self._release_found()
            self._found = [self._ctx.texture(size, 4, dtype="f2") for _ in range(2)]
            self._framebuffer = self._ctx.framebuffer(self._found)
        return self._framebuffer

    def _release_found(self) -> None:
        if self._framebuffer is not None:
            self._framebuffer.release()
        for texture in self._found:
            texture.release()
        self._framebuffer, self._found = None, []
