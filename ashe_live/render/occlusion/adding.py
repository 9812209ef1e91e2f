"""Drawing that adds to what a texture holds: one direction of the light around after another."""

import moderngl

from ashe_live.render.gl.rectangle import WholeRectangle


def draw_added(
    ctx: moderngl.Context, framebuffer: moderngl.Framebuffer, rectangle: WholeRectangle, program: moderngl.Program
) -> None:
    """Adds what the program gives to all of `framebuffer`."""
    framebuffer.use()
    ctx.enable_only(moderngl.BLEND)
    ctx.blend_func = moderngl.ONE, moderngl.ONE
    rectangle.draw(program)
