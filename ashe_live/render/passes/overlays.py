"""Draws pictures on top of everything: the heads-up display and the estimate's inset."""

import moderngl
import numpy as np

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Size
from ashe_live.render.gl.programs import build_program, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle
from ashe_live.render.gl.texture_units import UNIT_OF
from ashe_live.render.scene import Overlay


class OverlayPass:
    """Draws overlays; a picture is uploaded when it is first seen and dropped when it is no longer shown."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "screen/screen")
        self._rectangle = WholeRectangle(ctx)
        # A reference to the picture is kept with its texture, so that its id is not reused.
        self._textures: dict[int, tuple[Image, moderngl.Texture]] = {}

    def draw(self, overlays: tuple[Overlay, ...], size: Size) -> None:
        """Into the current framebuffer of `size`, the first overlay at the bottom."""
        self._drop_all_but({id(overlay.image_rgba) for overlay in overlays})
        if not overlays:
            return
        self._ctx.viewport = (0, 0, *size)
        self._ctx.enable_only(moderngl.BLEND)
        self._ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for overlay in overlays:
            self._texture(overlay).use(UNIT_OF["picture"])
            width, height = overlay.shown_size
            left, right = (2 * x / size[0] - 1 for x in (overlay.left_px, overlay.left_px + width))
            top, bottom = (1 - 2 * y / size[1] for y in (overlay.top_px, overlay.top_px + height))
            set_uniforms(self._program, rectangle=(left, bottom, right, top))
            self._rectangle.draw(self._program)

    def release(self) -> None:
        self._drop_all_but(set())
        self._rectangle.release()
        self._program.release()

    def _texture(self, overlay: Overlay) -> moderngl.Texture:
        image = overlay.image_rgba
        if id(image) not in self._textures:
            height, width = image.shape[:2]
            texture = self._ctx.texture((width, height), 4, np.ascontiguousarray(image[::-1]))
            if overlay.shown_size == (width, height):
                texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._textures[id(image)] = (image, texture)
        return self._textures[id(image)][1]

    def _drop_all_but(self, kept: set[int]) -> None:
        for key in self._textures.keys() - kept:
            self._textures.pop(key)[1].release()
