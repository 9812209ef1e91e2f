"""Pixels that one pass chooses for others: a cheap shader tells which are worth a dear one.

Within a shader nothing is saved by deciding that a pixel needs no more work: a software rasteriser computes both sides
of a branch, all that comes after a `discard`, and a loop at least once. What fails the test of depth is not shaded at
all, four by two pixels together.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import moderngl

from ashe_live.core.camera import Size
from ashe_live.render.gl.clearing import clear_part
from ashe_live.render.gl.framing import Rectangle

NOT_CHOSEN = 0.0  # a depth in front of which nothing can be drawn; `whole.vert` is in the middle


class ChosenPixels:
    """Of framebuffers of `size` that are made by `framebuffer`."""

    def __init__(self, ctx: moderngl.Context, size: Size) -> None:
        self._ctx = ctx
        self._depth = ctx.depth_renderbuffer(size)

    def framebuffer(self, colours: Sequence[moderngl.Texture | moderngl.Renderbuffer]) -> moderngl.Framebuffer:
        """Of these colours; with none, to choose pixels alone."""
        return self._ctx.framebuffer(list(colours), self._depth)

    @contextmanager
    def choosing(self, framebuffer: moderngl.Framebuffer, region: Rectangle) -> Iterator[None]:
        """Within, what `whole.vert` draws and keeps is chosen; else `region` is empty and nothing in it is."""
        framebuffer.depth_mask = True
        clear_part(framebuffer, region, NOT_CHOSEN)
        with self._drawing(framebuffer, region, ">"):
            yield

    @contextmanager
    def restricted(self, framebuffer: moderngl.Framebuffer, region: Rectangle) -> Iterator[None]:
        """Within, `whole.vert` draws into the pixels of `region` that were chosen."""
        framebuffer.depth_mask = False
        with self._drawing(framebuffer, region, "<="):
            yield

    def release(self) -> None:
        self._depth.release()

    @contextmanager
    def _drawing(self, framebuffer: moderngl.Framebuffer, region: Rectangle, depth_func: str) -> Iterator[None]:
        # moderngl tells OpenGL of a scissor only when the framebuffer is bound after it was set.
        framebuffer.scissor = region
        framebuffer.use()
        self._ctx.viewport = (0, 0, *framebuffer.size)
        self._ctx.enable_only(moderngl.DEPTH_TEST)
        self._ctx.depth_func = depth_func
        try:
            yield
        finally:
            self._ctx.depth_func = "<"
            self._ctx.enable_only(moderngl.NOTHING)
            framebuffer.scissor = None  # type: ignore[assignment]  # moderngl's stub knows no "none"
