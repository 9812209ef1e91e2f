"""A rectangle of four corners, which the vertex shader of the program that draws it places: as a rule the viewport."""

import moderngl


class WholeRectangle:
    """A vertex array without data for each program that has drawn it, as one belongs to one program."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program) -> None:
        """Draws with the program's vertex shader, which places four vertices by their number."""
        if program not in self._arrays:
            self._arrays[program] = self._ctx.vertex_array(program, [])
        self._arrays[program].render(moderngl.TRIANGLE_STRIP, vertices=4)

    def fill(self, framebuffer: moderngl.Framebuffer, program: moderngl.Program, adds: bool = False) -> None:
        """Draws into all of a framebuffer within its scissor, and leaves it bound. `adds`: to what it holds."""
        framebuffer.use()
        self._ctx.viewport = (0, 0, *framebuffer.size)
        self._ctx.enable_only(moderngl.BLEND if adds else moderngl.NOTHING)
        if adds:
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
        self.draw(program)

    def release(self) -> None:
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
