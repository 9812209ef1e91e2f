"""The renderer's own framebuffer, and the layers of what is drawn, which the composite puts onto the video."""

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.gl.chosen import ChosenPixels
from ashe_live.render.gl.driver import clear_part, within_scissor
from ashe_live.render.gl.framing import Rectangle
from ashe_live.render.gl.texture_units import UNIT_OF


class Surface:
    """Colour, layers and depth of `size`; `samples` are as many as the context has, if fewer.

    The layers hold linear light, so that they can be blurred: `added_light` is the light that the model sends to the
    camera (alpha: the fraction of the pixel that it covers), `removed` the fraction of the video's light that it takes
    away, by covering it or by its shadow. What is drawn blends into both alike, premultiplied. `chosen_colour` and
    `chosen_layers` are picture and finished layers, drawn into where pixels are `chosen`; `choice` is for choosing.
    """

    def __init__(self, ctx: moderngl.Context, size: Size, samples: int) -> None:
        self.size = size
        self.samples = supported_samples(samples, ctx.max_samples)
        self._ctx = ctx
        self._colour = ctx.renderbuffer(size)
        self.colour = ctx.framebuffer([self._colour])
        self.layers = [ctx.texture(size, 4, dtype="f2") for _ in range(2)]
        for layer in self.layers:  # what is at one border of the picture is not blurred into the other
            layer.repeat_x = layer.repeat_y = False
        self.chosen = ChosenPixels(ctx, size)
        self.choice = self.chosen.framebuffer([])
        self.chosen_colour = self.chosen.framebuffer([self._colour])
        self.chosen_layers = self.chosen.framebuffer(self.layers)  # its depth is also that of what is drawn
        # Without depth, for copies: OpenGL refuses to copy between depth buffers of different kinds.
        self._resolved = ctx.framebuffer(self.layers)
        self._held: list[moderngl.Framebuffer | moderngl.Renderbuffer | moderngl.Texture | ChosenPixels] = [
            self.colour,
            self.choice,
            self.chosen_colour,
            self.chosen_layers,
            self._resolved,
            self.chosen,
            self._colour,
            *self.layers,
        ]
        self._many: tuple[moderngl.Framebuffer, moderngl.Framebuffer, moderngl.Framebuffer] | None = None
        if self.samples:
            many = [ctx.renderbuffer(size, samples=self.samples, dtype="f2") for _ in range(2)]
            depth = ctx.depth_renderbuffer(size, samples=self.samples)
            self._many = ctx.framebuffer(many, depth), ctx.framebuffer(many), ctx.framebuffer(depth_attachment=depth)
            self._held += [*self._many, *many, depth]
        self._rgba = np.empty((size[1], size[0], 4), np.uint8)
        self._bgr = np.empty((size[1], size[0], 3), np.uint8)

    @contextmanager
    def drawing(self, region: Rectangle, several_samples: bool = False, over_drawn: bool = False) -> Iterator[None]:
        """Binds the layers, `region` of which is empty and has fresh depth, and has that region ready at the end.

        `several_samples`: with as many a pixel as the surface has. `over_drawn`: these are not empty, but have what was
        drawn with one.
        """
        many = self._many if several_samples else None
        drawn = self.chosen_layers if many is None else many[0]
        drawn.depth_mask = True
        clear_part(many[2] if many is not None and over_drawn else drawn, region)
        with within_scissor(drawn, region):
            if many is not None and over_drawn:
                self._ctx.copy_framebuffer(many[1], self._resolved)
            try:
                yield
            finally:
                if many is not None:
                    self._ctx.copy_framebuffer(self._resolved, many[1])
                self.colour.use()

    def bind_layers(self) -> None:
        """For programs that read them as `added_light` and `removed`."""
        for texture, name in zip(self.layers, ("added_light", "removed"), strict=True):
            texture.use(UNIT_OF[name])

    def read_bgra(self) -> Image:
        """(h, w, 4) uint8 sRGB, straight alpha, as `read_bgr`."""
        self.colour.read_into(self._rgba, components=4)
        return np.asarray(cv2.flip(cv2.cvtColor(self._rgba, cv2.COLOR_RGBA2BGRA), 0), dtype=np.uint8)

    def read_bgr(self) -> Image:
        """(h, w, 3) uint8 sRGB in OpenCV's order, top row first; waits for what is being drawn."""
        # Fresh memory costs more than the conversion: only the result is newly allocated.
        self.colour.read_into(self._rgba, components=4)
        cv2.cvtColor(self._rgba, cv2.COLOR_RGBA2BGR, dst=self._bgr)
        return np.asarray(cv2.flip(self._bgr, 0), dtype=np.uint8)

    def release(self) -> None:
        for held in self._held:
            held.release()


def supported_samples(wanted: int, available: int) -> int:
    """The largest power of two that is neither more than wanted nor more than there are; 0 below two."""
    samples = min(wanted, available)
    return 1 << (samples.bit_length() - 1) if samples >= 2 else 0
