"""Drawing that adds to what a texture holds: one direction of the light around after another."""

import moderngl


def draw_added(ctx: moderngl.Context, framebuffer: moderngl.Framebuffer, rectangle: moderngl.VertexArray) -> None:
    """Adds what the program of `rectangle`, whose four corners it makes itself, gives to all of `framebuffer`."""
    framebuffer.use()
    ctx.enable_only(moderngl.BLEND)
    ctx.blend_func = moderngl.ONE, moderngl.ONE
    rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
