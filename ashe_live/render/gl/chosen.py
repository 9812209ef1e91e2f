"""Pixels that one pass chooses for others: a cheap shader marks those that are worth an expensive one.

A shader saves nothing by deciding itself that a pixel needs no more work: a software rasteriser computes both sides of
a branch, all that comes after a `discard`, and a loop at least once. Fragments that fail the depth test are not shaded
at all, in blocks of four by two pixels.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import moderngl

from ashe_live.core.camera import Size
from ashe_live.render.gl.driver import clear_part, within_scissor
from ashe_live.render.gl.framing import Rectangle

NOT_CHOSEN = 0.0  # a depth in front of which nothing can be drawn; `whole.vert` draws at the middle depth


class ChosenPixels:
    """The choice for framebuffers of `size`, which `framebuffer` makes."""

    def __init__(self, ctx: moderngl.Context, size: Size) -> None:
        self._ctx = ctx
        self._depth = ctx.depth_renderbuffer(size)

    def framebuffer(self, colours: Sequence[moderngl.Texture | moderngl.Renderbuffer]) -> moderngl.Framebuffer:
        """A framebuffer with these colours; without any, only for choosing pixels."""
        return self._ctx.framebuffer(list(colours), self._depth)

    @contextmanager
    def choosing(self, framebuffer: moderngl.Framebuffer, region: Rectangle) -> Iterator[None]:
        """While this is active, pixels that `whole.vert` draws and keeps are chosen; all others of `region` are not."""
        framebuffer.depth_mask = True
        clear_part(framebuffer, region, NOT_CHOSEN)
        with self._drawing(framebuffer, region, ">"):
            yield

    @contextmanager
    def restricted(self, framebuffer: moderngl.Framebuffer, region: Rectangle) -> Iterator[None]:
        """While this is active, `whole.vert` draws only into the pixels of `region` that were chosen."""
        framebuffer.depth_mask = False
        with self._drawing(framebuffer, region, "<="):
            yield

    def release(self) -> None:
        self._depth.release()

    @contextmanager
    def _drawing(self, framebuffer: moderngl.Framebuffer, region: Rectangle, depth_func: str) -> Iterator[None]:
        with within_scissor(framebuffer, region):
            self._ctx.viewport = (0, 0, *framebuffer.size)
            self._ctx.enable_only(moderngl.DEPTH_TEST)
            self._ctx.depth_func = depth_func
            try:
                yield
            finally:
                self._ctx.depth_func = "<"
                self._ctx.enable_only(moderngl.NOTHING)
