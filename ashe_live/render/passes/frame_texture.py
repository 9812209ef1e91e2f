"""A frame as a texture of RGBA, bottom row first: converted by the GPU, or by the processor where that draws."""

import cv2
import moderngl
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.gl.driver import is_software
from ashe_live.render.gl.programs import build_program
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF


class FrameTexture:
    """`texture` of `size` and the framebuffer that it belongs to, filled by `write`."""

    def __init__(self, ctx: moderngl.Context, size: Size) -> None:
        self.texture = ctx.texture(size, 4)
        self.texture.repeat_x = self.texture.repeat_y = False
        self.framebuffer = ctx.framebuffer([self.texture])
        fits = 3 * size[0] <= int(ctx.info["GL_MAX_TEXTURE_SIZE"])
        is_by_gpu = fits and not is_software(ctx.info)
        self._converted = _ByGpu(ctx, self.framebuffer) if is_by_gpu else _ByProcessor(self.texture)

    @property
    def size(self) -> Size:
        return self.texture.size

    def write(self, image_bgr: Image) -> None:
        """Fills the texture with (h, w, 3) uint8, top row first. May leave another framebuffer bound."""
        self._converted.write(image_bgr)

    def release(self) -> None:
        self._converted.release()
        self.framebuffer.release()
        self.texture.release()


class _ByGpu:
    """Uploads the frame's bytes as they are: drivers upload three channels slowly, and OpenCV adds a fourth slowly."""

    def __init__(self, ctx: moderngl.Context, target: moderngl.Framebuffer) -> None:
        self._ctx = ctx
        self._target = target
        self._bytes = ctx.texture((3 * target.width, target.height), 1, alignment=1)
        self._bytes.filter = moderngl.NEAREST, moderngl.NEAREST
        self._program = build_program(ctx, "screen/frame")
        self._rectangle = WholeRectangle(ctx)

    def write(self, image_bgr: Image) -> None:
        self._bytes.write(np.ascontiguousarray(image_bgr))
        self._target.use()
        self._ctx.viewport = (0, 0, *self._target.size)
        self._ctx.disable(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._bytes.use(UNIT_OF["picture"])
        self._rectangle.draw(self._program)

    def release(self) -> None:
        for held in (self._rectangle, self._program, self._bytes):
            held.release()


class _ByProcessor:
    """Mesa takes four channels thirty times as fast as three, and new memory costs more than the conversion."""

    def __init__(self, texture: moderngl.Texture) -> None:
        self._texture = texture
        width, height = texture.size
        self._flipped = np.empty((height, width, 3), np.uint8)
        self._rgba = np.empty((height, width, 4), np.uint8)

    def write(self, image_bgr: Image) -> None:
        cv2.flip(image_bgr, 0, dst=self._flipped)
        cv2.cvtColor(self._flipped, cv2.COLOR_BGR2RGBA, dst=self._rgba)
        self._texture.write(self._rgba)

    def release(self) -> None:
        """Nothing of OpenGL's is its own."""
