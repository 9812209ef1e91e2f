"""A rectangle of four corners, which the vertex shader of the program that draws it places: as a rule the viewport."""

import moderngl


class WholeRectangle:
    """A vertex array without data, kept for the last program, as it belongs to one program."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._of: tuple[moderngl.Program, moderngl.VertexArray] | None = None

    def draw(self, program: moderngl.Program) -> None:
        """Draws with the program's vertex shader, which places four vertices by their number."""
        if self._of is None or self._of[0] is not program:
            self.release()
            self._of = program, self._ctx.vertex_array(program, [])
        self._of[1].render(moderngl.TRIANGLE_STRIP, vertices=4)

    def fill(self, framebuffer: moderngl.Framebuffer, program: moderngl.Program, adds: bool = False) -> None:
        """Draws into all of a framebuffer within its scissor, and leaves it bound. `adds`: to what it holds."""
        framebuffer.use()
        self._ctx.viewport = (0, 0, *framebuffer.size)
        self._ctx.enable_only(moderngl.BLEND if adds else moderngl.NOTHING)
        if adds:
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
        self.draw(program)

    def release(self) -> None:
        if self._of is not None:
            self._of[1].release()
        self._of = None
