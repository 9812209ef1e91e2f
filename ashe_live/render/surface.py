"""The renderer's own framebuffer, multisampled only where something is drawn."""

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.framing import Rectangle


class Surface:
    """Colour and depth of `size`; `samples` are as many as the context has, if fewer."""

    def __init__(self, ctx: moderngl.Context, size: Size, samples: int) -> None:
        self.size = size
        self.samples = supported_samples(samples, ctx.max_samples)
        self._ctx = ctx
        self._colour = ctx.renderbuffer(size)
        # Framebuffers without depth, for copies: OpenGL refuses to copy between depth buffers of different kinds.
        self.colour = ctx.framebuffer([self._colour])
        self._many = ctx.renderbuffer(size, samples=self.samples) if self.samples else self._colour
        self._depth = ctx.depth_renderbuffer(size, samples=self.samples)
        self._many_colour = ctx.framebuffer([self._many])
        self._depth_only = ctx.framebuffer(depth_attachment=self._depth)
        self._drawn = ctx.framebuffer([self._many], self._depth)
        self._rgba = np.empty((size[1], size[0], 4), np.uint8)
        self._bgr = np.empty((size[1], size[0], 3), np.uint8)

    @contextmanager
    def drawing(self, region: Rectangle) -> Iterator[bool]:
        """Binds a framebuffer whose `region` has fresh depth, and brings that region to `colour` at the end.

        Yields whether it has several samples a pixel; their colour is then undefined at first.
        """
        self._depth_only.clear(viewport=region)
        # moderngl tells OpenGL of a scissor only when the framebuffer is bound after it was set.
        self._drawn.scissor = region
        self._drawn.use()
        try:
            yield self.samples > 0
        finally:
            if self.samples:
                # Still within the scissor.
                self._ctx.copy_framebuffer(self.colour, self._many_colour)
            self.colour.use()

    def read_bgr(self) -> Image:
        """(h, w, 3) uint8 sRGB in OpenCV's order, top row first; waits for what is being drawn."""
        # Fresh memory costs more than the conversion: only the result is newly allocated.
        self.colour.read_into(self._rgba, components=4)
        cv2.cvtColor(self._rgba, cv2.COLOR_RGBA2BGR, dst=self._bgr)
        return np.asarray(cv2.flip(self._bgr, 0), dtype=np.uint8)

    def release(self) -> None:
        for framebuffer in (self.colour, self._many_colour, self._depth_only, self._drawn):
            framebuffer.release()
        for buffer in {self._colour, self._many, self._depth}:
            buffer.release()


def supported_samples(wanted: int, available: int) -> int:
    """The largest power of two that is neither more than wanted nor more than there are; 0 below two."""
    samples = min(wanted, available)
    return 1 << (samples.bit_length() - 1) if samples >= 2 else 0
