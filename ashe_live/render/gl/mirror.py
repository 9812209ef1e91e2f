"""Mirrors the picture left to right, as people who look into a camera expect."""

import moderngl

from ashe_live.render.gl.canvas import Canvas
from ashe_live.render.gl.programs import build_program, set_uniforms
from ashe_live.render.gl.rectangle import WholeRectangle

FROM_RIGHT_TO_LEFT = (1.0, -1.0, -1.0, 1.0)


class Mirror:
    """Holds a copy of the picture's size while it is in use."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._program = build_program(ctx, "screen/screen")
        self._rectangle = WholeRectangle(ctx)
        self._copy = Canvas(ctx)

    def turn(self, picture: moderngl.Framebuffer) -> None:
        """Mirrors a framebuffer that has colours only, with one sample a pixel."""
        copy = self._copy.of_size(picture.size)
        (texture,) = self._copy.textures
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._ctx.copy_framebuffer(copy, picture)
        self._copy.bind("picture")
        set_uniforms(self._program, rectangle=FROM_RIGHT_TO_LEFT)
        self._rectangle.fill(picture, self._program)

    def release(self) -> None:
        self._copy.release()
        self._rectangle.release()
        self._program.release()
